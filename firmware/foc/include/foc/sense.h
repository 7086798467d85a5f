/* SPDX-License-Identifier: Apache-2.0 */
/*
 * sense.h: from converter codes to phase currents.
 *
 * Three low-side shunts, sampled together in the low-side interval. The leg with the longest
 * high-side time leaves its amplifier the shortest time to settle, so its current is taken as minus
 * the sum of the other two. The sum of all three readings is kept for the monitor.
 */
#ifndef FOC_SENSE_H
#define FOC_SENSE_H

#include <stdbool.h>
#include <stdint.h>

#include "core/frames.h"
#include "core/q15.h"

enum {
    SENSE_PHASES = 3,
    SENSE_CODE_MID = 2048,
    SENSE_CODE_MAX = 4095,
    SENSE_TWO_INV_SQRT3_LESS_ONE_Q17 = 20277, /* round(131072 (2 / sqrt 3 - 1)) */
    SENSE_CALIBRATION_LOG2 = 10 /* samples averaged for the offsets: 51 ms at 20 kHz */
};

typedef struct {
    int32_t offset_q4[SENSE_PHASES]; /* zero-current code * 16 */
    uint32_t sum[SENSE_PHASES];
    uint16_t samples; /* of a calibration that is under way */
    bool calibrated;
} sense_state_t;

typedef struct {
    ab_t i; /* Q15, 1.0 = current base, positive into the motor; |alpha| <= 1, |beta| <= 1.155 */
    int32_t sum_pu; /* i_a + i_b + i_c as read, Q15 */
} sense_out_t;

void sense_init(sense_state_t *state);

/*
 * codes: right-aligned 12 bit. on_q16: high-side on-times of the legs around this sample (the set
 * that becomes active with it), timer counts with 16 fraction bits. On a tie the earlier phase is
 * reconstructed.
 *
 * Clarke in the same breath: alpha = a, beta = (b - c)/sqrt 3. Minus the sum of the other two is a
 * phase less the sum of all three, so the sum goes where the reconstructed phase stands. 1/sqrt 3
 * is written 1/2 + 0.077, which keeps two more bits of it in 32.
 */
Q_TARGET_INLINE sense_out_t sense_step(const sense_state_t *state,
                                       const uint16_t codes[SENSE_PHASES],
                                       const int32_t on_q16[SENSE_PHASES])
{
    const int32_t a = codes[0] * 16 - state->offset_q4[0];
    const int32_t b = codes[1] * 16 - state->offset_q4[1];
    const int32_t c = codes[2] * 16 - state->offset_q4[2];
    const int32_t sum = a + b + c;
    int32_t alpha = a;
    int32_t b_less_c = b - c;
    if (on_q16[0] >= on_q16[1] && on_q16[0] >= on_q16[2]) {
        alpha -= sum;
    } else if (on_q16[1] >= on_q16[2]) {
        b_less_c -= sum;
    } else {
        b_less_c += sum;
    }
    const int32_t difference = q_saturate17(b_less_c);
    const int32_t doubled_beta =
        difference + ((difference * SENSE_TWO_INV_SQRT3_LESS_ONE_Q17) >> 17);
    const sense_out_t out = {
        .i = {.alpha = q_saturate16(alpha), .beta = (doubled_beta + 1) >> 1},
        .sum_pu = sum,
    };
    return out;
}

/*
 * Does a phase current stand at an end of what its converter can tell, codes 0 and 4095? i_pu: the
 * currents of a period, worked back to phases from its dq vector; half a code is allowed for the
 * roundings on that way. A converter that was not used may well stand at its end, and is not seen
 * here: its current comes from the other two. For the slow reach.
 */
bool sense_at_end(const int32_t offset_q4[SENSE_PHASES], abc_t i_pu);

/* One sample of the offset calibration; only with the bridge off and the motor's current at zero.
 * After 2^SENSE_CALIBRATION_LOG2 samples the offsets are replaced and state->calibrated becomes
 * true. */
void sense_calibrate_step(sense_state_t *state, const uint16_t codes[SENSE_PHASES]);

/* Start a new calibration; the offsets of the last one stay in use until it is done. */
void sense_calibrate_restart(sense_state_t *state);

#endif

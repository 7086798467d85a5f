/* SPDX-License-Identifier: Apache-2.0 */
/*
 * sense.h: converter codes to alpha-beta current, once per PWM period.
 *
 * Three low-side shunts, sampled together in the low-side interval. The leg with the longest
 * high-side time leaves its amplifier the shortest settling time, so its current is reconstructed
 * as minus the sum of the other two. The sum of all three readings is kept for the monitor.
 */
#ifndef FOC_SENSE_H
#define FOC_SENSE_H

#include <stdbool.h>
#include <stdint.h>

#include "core/frames.h"
#include "core/q15.h"
#include "core/sqrt3.h"
#include "foc/state.h"

enum {
    SENSE_CODE_MAX = 4095,
    SENSE_TWO_INV_SQRT3_LESS_ONE_Q17 = SQRT3_OVER(3, 18) - (1 << 17),
    SENSE_CALIBRATION_LOG2 = 10 /* samples averaged for the offsets: 51 ms at 20 kHz */
};

typedef struct {
    ab16_t i;       /* Q15 of the current base, positive into the motor; saturated to 16 bits */
    int32_t sum_pu; /* i_a + i_b + i_c as read, Q15 */
} sense_out_t;

/* The stored offsets are in use until a calibration is complete. */
void sense_init(sense_state_t *state, const config_drive_t *config);

/*
 * codes: 12 bit. on_q16: high-side on-times during this sample; on a tie the earlier phase is
 * reconstructed. Includes Clarke: alpha = a, beta = (b - c)/sqrt 3. A reconstructed phase is its
 * reading minus the sum of the three. 1/sqrt 3 is split into 1/2 + 0.077 for two more bits.
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
    if (on_q16[0] >= on_q16[1]) {
        if (on_q16[0] >= on_q16[2]) {
            alpha -= sum;
        } else {
            b_less_c += sum;
        }
    } else if (on_q16[1] >= on_q16[2]) {
        b_less_c -= sum;
    } else {
        b_less_c += sum;
    }
    const int32_t difference = q_saturate17(b_less_c);
    const int32_t doubled_beta =
        q_mac_q17(difference + 1, difference, SENSE_TWO_INV_SQRT3_LESS_ONE_Q17);
    const int32_t beta = q_saturate16(doubled_beta >> 1);
    const sense_out_t out = {
        .i = {.v = q_pair(q_saturate16(alpha), beta)},
        .sum_pu = sum,
    };
    return out;
}

/* The three readings, Q15. */
static inline abc_t sense_phases(const sense_state_t *state, const uint16_t codes[SENSE_PHASES])
{
    const abc_t out = {.a = codes[0] * 16 - state->offset_q4[0],
                       .b = codes[1] * 16 - state->offset_q4[1],
                       .c = codes[2] * 16 - state->offset_q4[2]};
    return out;
}

/* As sense_step(), the current of `phase` (0 .. 2) reconstructed from the other two whatever the
 * on-times are. */
ab16_t sense_without(const sense_state_t *state, const uint16_t codes[SENSE_PHASES], uint8_t phase);

/*
 * ADC saturation: a phase current at an end of its converter's range, code 0 or 4095. i_pu: phase
 * currents recomputed from the dq vector of a period; half a code is allowed for rounding. The
 * converter of the reconstructed phase is not checked. Slow loop.
 */
bool sense_adc_saturated(const int32_t offset_q4[SENSE_PHASES], abc_t i_pu);

/* One sample of the offset calibration; only with the bridge off and zero motor current. After
 * 2^SENSE_CALIBRATION_LOG2 samples the offsets are replaced and state->calibrated becomes true. */
void sense_calibrate_step(sense_state_t *state, const uint16_t codes[SENSE_PHASES]);

/* Start a new calibration; the previous offsets stay in use until it is complete. */
void sense_calibrate_restart(sense_state_t *state);

#endif

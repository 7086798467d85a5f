/* SPDX-License-Identifier: Apache-2.0 */
#include "torque/foldback.h"

#include <stdbool.h>

#include "core/q15.h"
#include "core/scaled.h"

/* Gain of the loop, and the offset that lets the limit rise from zero (DERIVATIONS.md, Fold-back).
 */
enum {
    STEPS_LOG2 = 3,
    LITTLE_q24 = SCALED_ONE / 64,
    FLOWING_MOST = 8,
    UNUSED_SHARE = 4, /* a current below a quarter of the limit leaves it unused */
    UNUSED_FACTOR = 8 /* times 2^STEPS_LOG2 steps: 64 ms */
};

int32_t foldback_step(foldback_state_t *state, const foldback_t *foldback, int32_t inside_mV,
                      int32_t flowing_mA)
{
    const int32_t most_mA = q_max(foldback->most_mA, 1);
    const int32_t flowing_q24 = scaled_ratio(q_limit(flowing_mA, FLOWING_MOST * most_mA), most_mA);
    const int32_t within_mV = q_limit(inside_mV, 4 * foldback->span_mV);
    /* Distance from the line of the voltage with the whole limit flowing, as a share of the range.
     */
    const int32_t unused_mV = scaled_multiply(foldback->rise_mV, state->allowed_q24 - flowing_q24);
    const int32_t line_mV = scaled_multiply(foldback->width_mV, state->allowed_q24);
    const int32_t error_mV = within_mV - unused_mV - line_mV;
    int32_t from_q24 = state->allowed_q24;
    if (inside_mV < 0) { /* lowers it only with an error below zero: else more flows than that */
        from_q24 = q_min(from_q24, q_max(flowing_q24, 0) + LITTLE_q24);
    }
    /* A limit that no current uses moves no voltage: it falls at a gain that does not fall with it.
     */
    const int32_t whole_mV = UNUSED_FACTOR * (foldback->width_mV + foldback->rise_mV);
    const bool unused = error_mV < 0 && flowing_q24 < state->allowed_q24 / UNUSED_SHARE &&
                        scaled_multiply(whole_mV, from_q24 + LITTLE_q24) < foldback->span_mV;
    if (error_mV < 0 || from_q24 < SCALED_ONE) {
        const int32_t gain_q24 = unused ? SCALED_ONE : from_q24 + LITTLE_q24;
        const int32_t error_q24 =
            scaled_ratio(error_mV, q_divisor(unused ? whole_mV : foldback->span_mV));
        const int32_t change_q24 = scaled_multiply(gain_q24, error_q24) >> STEPS_LOG2;
        state->allowed_q24 = q_clamp(from_q24 + change_q24, 0, SCALED_ONE);
    }
    return inside_mV <= -foldback->width_mV
               ? 0
               : scaled_multiply(foldback->most_mA, state->allowed_q24);
}

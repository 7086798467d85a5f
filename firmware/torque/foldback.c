/* SPDX-License-Identifier: Apache-2.0 */
#include "torque/foldback.h"

#include "core/q15.h"
#include "core/scaled.h"

/* Mathematics: the loop's gain, and what lets it leave zero (README, Fold-back). */
enum { STEPS_LOG2 = 3, LEAVE_ZERO_LOG2 = 6, FRACTION_LOG2 = FOLDBACK_FRACTION_LOG2 };

int32_t foldback_step(foldback_state_t *state, const foldback_t *foldback, int32_t inside_mV,
                      int32_t flowing_mA)
{
    const int32_t most_q6 = q_max(foldback->most_mA, 0) * (1 << FRACTION_LOG2);
    const int32_t within_mV = q_limit(inside_mV, 4 * foldback->span_mV);
    const int32_t allowed_q6 = q_clamp(state->allowed_q6_mA, 0, most_q6);
    /* Distance of the voltage from the line, as a share of the range. */
    const int32_t line_mV =
        most_q6 > 0 ? scaled_multiply(foldback->width_mV, scaled_ratio(allowed_q6, most_q6)) : 0;
    const int32_t error = scaled_ratio(within_mV - line_mV, foldback->span_mV);
    const int32_t little_q6 = most_q6 >> LEAVE_ZERO_LOG2;
    const int32_t flowing_q6 = q_min(flowing_mA, foldback->most_mA) * (1 << FRACTION_LOG2);
    const int32_t from_q6 = error < 0 ? q_min(allowed_q6, flowing_q6 + little_q6) : allowed_q6;
    const int32_t moving_q6 = from_q6 + little_q6;
    const int64_t change_q6 = ((int64_t)moving_q6 * error) >> (24 + STEPS_LOG2);
    state->allowed_q6_mA = q_clamp(q_saturate64(from_q6 + change_q6), 0, most_q6);
    return inside_mV <= -foldback->width_mV ? 0 : state->allowed_q6_mA >> FRACTION_LOG2;
}

/* SPDX-License-Identifier: Apache-2.0 */
#include "monitor/monitor_current.h"

#include "core/q15.h"

enum {
    ZERO_CURRENT_PU = 24, /* Q15: one and a half codes of a 12-bit converter */
    LEAST_STEPS = 3 /* at any reference: a mean may be zero while a current changes its sign */
};

/* Length of the vector, from 3 % less to 7 % more. */
static int32_t length(dq_t i)
{
    const int32_t d = q_abs(q_saturate16(i.d));
    const int32_t q = q_abs(q_saturate16(i.q));
    return q_max(d, q) + q_min(d, q) * 3 / 8;
}

bool monitor_current_step(monitor_current_state_t *state, const config_t *config,
                          const measured_t *now, dq_t reference_pu)
{
    const int32_t most_pu = config->monitor.current_missing_pu_q15;
    const int32_t length_pu = length(reference_pu);
    if (!measured_switching(now) || length(now->sampled_pu) > ZERO_CURRENT_PU) {
        state->missing_pu = 0;
    } else if (!now->report->voltage_limited && length_pu > 2 * ZERO_CURRENT_PU) {
        const int32_t added_pu = q_min(length_pu, most_pu / LEAST_STEPS + 1);
        state->missing_pu = q_min(state->missing_pu + added_pu, most_pu);
    }
    return state->missing_pu >= most_pu;
}

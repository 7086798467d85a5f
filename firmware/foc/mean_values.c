/* SPDX-License-Identifier: Apache-2.0 */
#include "foc/mean_values.h"

void mean_values_init(mean_values_state_t *state, int32_t v_dc_pu)
{
    const mean_values_state_t zero = {.sequence = 0};
    *state = zero;
    state->latest.v_dc_pu = v_dc_pu;
}

/* The difference of two wrapping sums, as long as it is below 2^31. */
static int32_t mean(uint32_t now, uint32_t before, int32_t steps)
{
    const uint32_t rise = now - before;
    return (rise <= INT32_MAX ? (int32_t)rise : -(int32_t)(UINT32_MAX - rise) - 1) / steps;
}

mean_values_t mean_values_step(mean_values_state_t *state, const fast_report_t *report)
{
    const int32_t steps = (uint16_t)(report->sequence - state->sequence);
    if (steps > 0) {
        const foc_sums_t *now = &report->sums;
        const foc_sums_t *before = &state->sums;
        const mean_values_t values = {
            .i_pu = {.d = mean(now->i_d_pu, before->i_d_pu, steps),
                     .q = mean(now->i_q_pu, before->i_q_pu, steps)},
            .power_pu = mean(now->power_pu, before->power_pu, steps),
            .v_dc_pu = mean(now->v_dc_pu, before->v_dc_pu, steps),
        };
        state->latest = values;
        state->sums = *now;
        state->sequence = report->sequence;
    }
    return state->latest;
}

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
    const uint32_t d = (uint32_t)q_abs(q_saturate16(i.d));
    const uint32_t q = (uint32_t)q_abs(q_saturate16(i.q));
    return (int32_t)(d > q ? d + q * 3U / 8U : q + d * 3U / 8U);
}

/* At rest: they show what they showed in the step before. */
static bool unmoved(const monitor_current_state_t *state, dq_t shown_pu)
{
    const dq_t change_pu = {.d = q_subtract(shown_pu.d, state->shown_pu.d),
                            .q = q_subtract(shown_pu.q, state->shown_pu.q)};
    return length(change_pu) <= ZERO_CURRENT_PU;
}

static int32_t added_pu(dq_t reference_pu, dq_t shown_pu, int32_t most_pu)
{
    const dq_t error_pu = {.d = q_subtract(reference_pu.d, shown_pu.d),
                           .q = q_subtract(reference_pu.q, shown_pu.q)};
    const int32_t length_pu = length(error_pu);
    return length_pu > 2 * ZERO_CURRENT_PU ? q_min(length_pu, most_pu / LEAST_STEPS + 1) : 0;
}

bool monitor_current_step(monitor_current_state_t *state, const config_t *config,
                          const measured_t *now, dq_t reference_pu)
{
    const int32_t most_pu = config->monitor.current_missing_pu_q15;
    const uint16_t theta_turn = now->report->sample.theta_turn;
    const bool rests = theta_turn == state->theta_turn;
    const bool none = length(now->sampled_pu) <= ZERO_CURRENT_PU;
    state->theta_turn = theta_turn;
    if (!measured_switching(now) || !(none || rests)) {
        state->missing_pu = 0;
    } else {
        const dq_t no_current = {0, 0};
        const dq_t shown_pu = none ? no_current : now->sampled_pu;
        if (!none && !unmoved(state, shown_pu)) {
            state->missing_pu = 0;
        } else if (!now->report->voltage_limited) {
            state->missing_pu =
                q_min(state->missing_pu + added_pu(reference_pu, shown_pu, most_pu), most_pu);
        }
        state->shown_pu = shown_pu;
    }
    return state->missing_pu >= most_pu;
}

/* SPDX-License-Identifier: Apache-2.0 */
#include "torque/demand.h"

#include "core/q15.h"
#include "core/ramp.h"

enum { SLOW_STEPS_PER_S = 1000, LARGEST_DEMAND_mNm = 100000000 };

void demand_init(demand_state_t *state)
{
    state->drive_mNm = 0;
    state->brake_mNm = 0;
}

int32_t demand_rate_mNm_per_step(const config_t *config)
{
    return q_max(config->brake.torque_rate_mNm_s / SLOW_STEPS_PER_S, 1);
}

demand_t demand_step(demand_state_t *state, const config_t *config, int32_t drive_mNm,
                     int32_t brake_mNm, uint32_t age_ms)
{
    const bool timed_out = age_ms > (uint32_t)config->brake.demand_timeout_ms;
    if (timed_out) {
        const int32_t step = demand_rate_mNm_per_step(config);
        state->drive_mNm = ramp_step(state->drive_mNm, 0, step);
        state->brake_mNm = ramp_step(state->brake_mNm, 0, step);
    } else {
        state->brake_mNm = q_clamp(brake_mNm, 0, LARGEST_DEMAND_mNm);
        state->drive_mNm = q_clamp(drive_mNm, -LARGEST_DEMAND_mNm, LARGEST_DEMAND_mNm);
    }
    const demand_t out = {
        .drive_mNm = state->brake_mNm > 0 ? 0 : state->drive_mNm,
        .brake_mNm = state->brake_mNm,
        .timed_out = timed_out,
    };
    return out;
}

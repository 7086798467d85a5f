/* SPDX-License-Identifier: Apache-2.0 */
#include "monitor/monitor_temperature.h"

#include "core/q15.h"
#include "monitor/monitor.h"

enum { MOVED_SHARE = 4 };

void monitor_temperature_init(monitor_temperature_state_t *state)
{
    const monitor_temperature_state_t zero = {.started = false};
    *state = zero;
}

bool monitor_temperature_outside(const config_t *config, int32_t measured_cC)
{
    return measured_cC > config->monitor.highest_temperature_cC ||
           measured_cC < config->monitor.lowest_temperature_cC;
}

static void watch_movement(monitor_temperature_state_t *state, const config_t *config,
                           const monitor_temperature_input_t *in)
{
    const int32_t rise_cC = config->monitor.stuck_rise_cC;
    if (!state->started || q_abs(in->measured_cC - state->kept_cC) > rise_cC / MOVED_SHARE) {
        state->started = true;
        state->kept_cC = in->measured_cC;
        state->kept_estimate_cC = in->slowest_cC;
        state->stuck = false;
    } else if (in->estimated && rise_cC > 0 &&
               q_abs(in->slowest_cC - state->kept_estimate_cC) > rise_cC) {
        state->stuck = true;
        state->offset_q16 = 0;
    }
}

static void follow(monitor_temperature_state_t *state, const monitor_temperature_input_t *in)
{
    const int32_t apart_cC =
        q_limit(in->measured_cC - in->estimate_cC, MONITOR_TEMPERATURE_OFFSET_MOST_cC);
    state->offset_q16 +=
        (apart_cC * (1 << 16) - state->offset_q16) >> MONITOR_TEMPERATURE_OFFSET_LOG2;
}

monitor_temperature_output_t monitor_temperature_step(monitor_temperature_state_t *state,
                                                      const config_t *config,
                                                      const monitor_temperature_input_t *in)
{
    monitor_temperature_output_t out = {.used_cC = in->measured_cC};
    if (in->limit_cC >= MONITOR_TEMPERATURE_OFF_cC) {
        return out;
    }
    const bool outside = monitor_temperature_outside(config, in->measured_cC);
    state->outside_steps = (uint16_t)(outside ? q_min(state->outside_steps + 1, UINT16_MAX) : 0);
    if (!outside) {
        watch_movement(state, config, in);
    }
    if (state->outside_steps >= config->monitor.sensor_fault_time_ms || state->stuck) {
        state->heal_steps = MONITOR_TEMPERATURE_HEAL_STEPS;
    } else if (!outside && state->heal_steps > 0) {
        state->heal_steps--;
    }
    out.broken = state->heal_steps > 0;
    const int32_t estimate_cC = in->estimate_cC + (state->offset_q16 >> 16);
    if (outside) {
        out.used_cC = in->estimated ? estimate_cC : MONITOR_TEMPERATURE_BROKEN_cC;
    } else if (state->stuck) {
        out.used_cC = q_max(in->measured_cC, estimate_cC);
    } else if (in->estimated) {
        follow(state, in);
    }
    return out;
}

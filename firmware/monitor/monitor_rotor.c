/* SPDX-License-Identifier: Apache-2.0 */
#include "monitor/monitor_rotor.h"

#include "core/q15.h"

/* Geometry: the observer's error is below 10 degrees, a hall sensor's below 5. */
enum {
    OPPOSED_TURN = 10923, /* 60 degrees */
    SLIPPED_TURN = 2913,  /* 16 degrees */
    AGREED_TURN = 2185,   /* 12 degrees */
    OPPOSED_STEPS = 2,
    SLIPPED_STEPS = 12,
    CONFIRM_STEPS = 2,
    LOSE_STEPS = 2
};

static uint8_t counted(uint8_t steps, bool condition)
{
    return condition ? (uint8_t)q_min(steps + 1, UINT8_MAX) : (uint8_t)0;
}

/* Torque is permitted down to 15/16 of the speed from which it is. */
static bool fast_enough(const monitor_rotor_state_t *state, const config_t *config,
                        int32_t speed_mrad_s)
{
    const int32_t from_mrad_s = config->rotor.observer_speed_mrad_s;
    return q_abs(speed_mrad_s) >= (state->confirmed ? from_mrad_s - from_mrad_s / 16 : from_mrad_s);
}

static void confirm(monitor_rotor_state_t *state, const config_t *config,
                    const monitor_rotor_input_t *in)
{
    const bool plausible =
        in->switching && in->acquired && in->flux_q14 >= 4 * q_abs(in->across_q14) &&
        in->flux_q14 >= in->expected_q14 / 2 && in->flux_q14 <= in->expected_q14 * 4;
    state->plausible = counted(state->plausible, plausible);
    state->implausible = counted(state->implausible, !plausible);
    const bool consistent =
        state->confirmed ? state->implausible < LOSE_STEPS : state->plausible >= CONFIRM_STEPS;
    state->confirmed =
        in->switching && consistent && fast_enough(state, config, in->observer_mrad_s);
}

/* A sensor that is wrong agrees with the observer in passing: it has to for a long time. */
static void compare(monitor_rotor_state_t *state, const config_t *config,
                    const monitor_rotor_input_t *in)
{
    if (!state->confirmed || !in->sensor_valid) {
        state->opposed_steps = 0;
        state->slipped = 0;
        state->agreed_steps = 0;
        return;
    }
    const int32_t size_turn = q_abs(in->difference_turn);
    state->opposed_steps = counted(state->opposed_steps, size_turn >= OPPOSED_TURN);
    if (size_turn >= SLIPPED_TURN) {
        state->slipped = (uint8_t)q_min(state->slipped + 1, SLIPPED_STEPS);
    } else if (state->slipped > 0) {
        state->slipped--;
    }
    state->agreed_steps = size_turn < AGREED_TURN ? q_min(state->agreed_steps + 1,
                                                          config->monitor.rotor_warning_time_ms)
                                                  : 0;
    if (state->opposed_steps >= OPPOSED_STEPS || state->slipped >= SLIPPED_STEPS) {
        state->sensor_wrong = true;
    } else if (state->agreed_steps >= config->monitor.rotor_warning_time_ms) {
        state->sensor_wrong = false;
    }
}

monitor_rotor_output_t monitor_rotor_step(monitor_rotor_state_t *state, const config_t *config,
                                          const monitor_rotor_input_t *in)
{
    if (config->rotor.observer_takeover == 0) {
        const monitor_rotor_output_t sensor_alone = {.valid = in->sensor_valid};
        return sensor_alone;
    }
    confirm(state, config, in);
    compare(state, config, in);
    state->sensor_wrong = state->sensor_wrong && !in->cleared;
    const bool sensor = in->sensor_valid && !state->sensor_wrong;
    state->observer_used = !sensor && (state->observer_used || state->confirmed || !in->switching);
    const monitor_rotor_output_t out = {
        .valid = sensor || (state->observer_used && state->confirmed),
        .observer_used = state->observer_used,
        .sensor_wrong = state->sensor_wrong,
    };
    return out;
}

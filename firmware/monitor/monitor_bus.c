/* SPDX-License-Identifier: Apache-2.0 */
#include "monitor/monitor_bus.h"

#include "core/q15.h"

static void begin_window(monitor_bus_state_t *state, int32_t reading_mV)
{
    state->lowest_mV[0] = reading_mV;
    state->highest_mV[0] = reading_mV;
    state->steps = 0;
}

static void add_reading(monitor_bus_state_t *state, int32_t reading_mV)
{
    if (state->steps >= MONITOR_BUS_WINDOW_STEPS) {
        state->lowest_mV[1] = state->lowest_mV[0];
        state->highest_mV[1] = state->highest_mV[0];
        state->windows = 1;
        begin_window(state, reading_mV);
    }
    state->lowest_mV[0] = q_min(state->lowest_mV[0], reading_mV);
    state->highest_mV[0] = q_max(state->highest_mV[0], reading_mV);
    state->steps++;
}

static bool contradicts(const monitor_bus_state_t *state, int32_t battery_mV)
{
    const int32_t lowest_mV = q_min(state->lowest_mV[0], state->lowest_mV[1]);
    const int32_t highest_mV = q_max(state->highest_mV[0], state->highest_mV[1]);
    const int32_t tolerance_mV = battery_mV / MONITOR_BUS_TOLERANCE_SHARE;
    return battery_mV > highest_mV + tolerance_mV || battery_mV < lowest_mV - tolerance_mV;
}

bool monitor_bus_step(monitor_bus_state_t *state, int32_t reading_mV, int32_t battery_mV)
{
    const int32_t within_mV = q_clamp(reading_mV, 0, MONITOR_BUS_MOST_mV);
    if (battery_mV <= 0 || (state->steps == 0 && state->windows == 0)) {
        const monitor_bus_state_t fresh = {.wrong = false};
        *state = fresh;
        begin_window(state, within_mV);
        state->steps = battery_mV > 0 ? 1 : 0;
        return false;
    }
    add_reading(state, within_mV);
    if (state->windows == 0) {
        return false;
    }
    if (contradicts(state, q_min(battery_mV, MONITOR_BUS_MOST_mV))) {
        state->level = (uint16_t)q_min(state->level + 1, MONITOR_BUS_QUALIFY_STEPS);
    } else if (state->level > 0) {
        state->level--;
    }
    if (state->level >= MONITOR_BUS_QUALIFY_STEPS) {
        state->wrong = true;
    } else if (state->level == 0) {
        state->wrong = false;
    }
    return state->wrong;
}

bool monitor_bus_swings(monitor_swing_state_t *state, const config_battery_t *battery,
                        int32_t reading_mV, bool watched)
{
    const int32_t within_mV = q_clamp(reading_mV, 0, MONITOR_BUS_MOST_mV);
    const int32_t most_mV = battery->max_voltage_mV * MONITOR_BUS_JUMP_Q7 / 128;
    const int32_t moved_mV = q_min(q_abs(within_mV - state->last_mV), most_mV);
    const int32_t swing_mV = state->swing_mV - (state->swing_mV >> MONITOR_BUS_SWING_LOG2);
    state->swing_mV = !watched ? 0 : state->watching ? swing_mV + moved_mV : 0;
    state->last_mV = within_mV;
    state->watching = watched;
    /* mA uOhm = 1e-6 mV; an eighth more */
    const int32_t amperes_mA = battery->max_charge_current_mA + battery->max_discharge_current_mA;
    const int64_t full_swing = (int64_t)amperes_mA * battery->resistance_uOhm;
    return full_swing > 0 && state->swing_mV >= 2 * most_mV &&
           (int64_t)state->swing_mV * 888889 > full_swing;
}

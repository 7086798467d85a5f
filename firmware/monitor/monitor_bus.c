/* SPDX-License-Identifier: Apache-2.0 */
#include "monitor/monitor_bus.h"

#include "core/q15.h"

static bool contradicts(const monitor_window_t *window, int32_t battery_mV)
{
    const int32_t tolerance_mV = battery_mV / MONITOR_BUS_TOLERANCE_SHARE;
    return battery_mV > monitor_window_highest(window) + tolerance_mV ||
           battery_mV < monitor_window_lowest(window) - tolerance_mV;
}

bool monitor_bus_step(monitor_window_t *window, int32_t reading_mV, int32_t battery_mV)
{
    if (battery_mV <= 0) {
        monitor_window_restart(window);
        return false;
    }
    return monitor_window_add(window, q_clamp(reading_mV, 0, MONITOR_BUS_MOST_mV)) &&
           monitor_window_judge(window,
                                contradicts(window, q_min(battery_mV, MONITOR_BUS_MOST_mV)));
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

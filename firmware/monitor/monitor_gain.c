/* SPDX-License-Identifier: Apache-2.0 */
#include "monitor/monitor_gain.h"

#include "core/q15.h"

/* mA * mV = uW = mN m * mrad/s. What is judged is driving (least > 0) or braking altogether. */
static bool contradicts(const monitor_window_t *window, const config_t *config, int32_t battery_mA,
                        int64_t bus_mV)
{
    const int64_t rated_uW =
        (int64_t)config->motor.rated_torque_mNm * config->motor.max_speed_mrad_s;
    const int32_t lowest_mA = monitor_window_lowest(window);
    const int32_t highest_mA = monitor_window_highest(window);
    const bool drives = lowest_mA > 0;
    const int32_t least_mA = drives ? lowest_mA : -highest_mA;
    const int32_t tolerance_mA = (drives ? highest_mA : -lowest_mA) / MONITOR_GAIN_TOLERANCE_SHARE;
    const int32_t above_mA = battery_mA - highest_mA - tolerance_mA;
    return least_mA * bus_mV >= rated_uW / MONITOR_GAIN_LEAST_SHARE &&
           (battery_mA < lowest_mA - tolerance_mA ||
            above_mA * bus_mV > rated_uW / MONITOR_GAIN_EXTRA_SHARE);
}

bool monitor_gain_step(monitor_window_t *window, const config_t *config, const measured_t *now)
{
    if (!now->battery->current_given || measured_battery_open(now) ||
        config->battery.driven_wheels != 1 || !measured_switching(now)) {
        monitor_window_restart(window);
        return false;
    }
    const int32_t battery_mA = q_limit(now->battery->current_mA, MONITOR_WINDOW_MOST);
    return monitor_window_add(window, q_limit(now->bus_current_mA, MONITOR_WINDOW_MOST)) &&
           monitor_window_judge(window,
                                contradicts(window, config, battery_mA, now->bus_voltage_mV));
}

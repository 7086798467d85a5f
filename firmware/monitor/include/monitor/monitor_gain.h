/* SPDX-License-Identifier: Apache-2.0 */
/*
 * monitor_gain.h: a common gain error of all current sensors, by the battery's measured current.
 * Slow loop, 1 kHz.
 *
 * Sensors that all show g times the current make a bus current 3/2 u i/v_dc of g times the true
 * one, whatever angle and bus sensor say. It is compared where one motor is on the battery and its
 * power is at least 1/MONITOR_GAIN_LEAST_SHARE of rated torque times largest speed. README, Gain
 * of all current sensors.
 */
#ifndef MONITOR_MONITOR_GAIN_H
#define MONITOR_MONITOR_GAIN_H

#include <stdbool.h>
#include <stdint.h>

#include "config/config.h"
#include "monitor/monitor_window.h"

#define MONITOR_GAIN_NOT_GIVEN INT32_MIN

enum {
    MONITOR_GAIN_LEAST_SHARE = 16,
    MONITOR_GAIN_TOLERANCE_SHARE = 8, /* of the current: sensors of motor and battery */
    MONITOR_GAIN_EXTRA_SHARE = 64     /* of that power: losses of the bridge, other loads */
};

typedef struct {
    int32_t bus_current_mA;     /* by the current loop, positive out of the battery */
    int32_t battery_current_mA; /* of the latest message, likewise; MONITOR_GAIN_NOT_GIVEN: none */
    int32_t bus_voltage_mV;
    bool switching;
} monitor_gain_input_t;

/* True while the gain is wrong (qualified). Currents beyond MONITOR_WINDOW_MOST count as that. */
bool monitor_gain_step(monitor_window_t *window, const config_t *config,
                       const monitor_gain_input_t *in);

#endif

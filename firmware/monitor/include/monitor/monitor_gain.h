/* SPDX-License-Identifier: Apache-2.0 */
/*
 * monitor_gain.h: a common gain error of all current sensors, by the battery's measured current.
 * Slow loop, 1 kHz.
 *
 * Sensors that all show g times the current make a bus current 3/2 u i/v_dc of g times the true
 * one, whatever angle and bus sensor say. It is compared where one motor is on the battery and its
 * power is at least 1/MONITOR_GAIN_LEAST_SHARE of rated torque times largest speed. DERIVATIONS.md,
 * Gain of all current sensors.
 */
#ifndef MONITOR_MONITOR_GAIN_H
#define MONITOR_MONITOR_GAIN_H

#include <stdbool.h>
#include <stdint.h>

#include "config/config.h"
#include "core/measured.h"
#include "monitor/monitor_window.h"

enum {
    MONITOR_GAIN_LEAST_SHARE = 16,
    MONITOR_GAIN_TOLERANCE_SHARE = 8, /* of the current: sensors of motor and battery */
    MONITOR_GAIN_EXTRA_SHARE = 64     /* of that power: losses of the bridge, other loads */
};

/* True while the gain is wrong (qualified and healed by monitor_window_judge()); never without PWM,
 * without the current in the message, with an open contactor or with several driven wheels, which
 * forget the window. Currents are positive out of the battery; beyond MONITOR_WINDOW_MOST they
 * count as that. */
bool monitor_gain_step(monitor_window_t *window, const config_t *config, const measured_t *now);

#endif

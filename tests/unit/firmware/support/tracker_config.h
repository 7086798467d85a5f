/* SPDX-License-Identifier: Apache-2.0 */
/* tracker_config.h: an absolute angle at 20 kHz, tracked by a critically damped loop of 50 Hz. */
#ifndef TRACKER_CONFIG_H
#define TRACKER_CONFIG_H

#include <math.h>

#include "config/config.h"

extern const config_t CONFIG_LU2013;

static const double PI = 3.14159265358979323846;

static inline config_t tracker_config(void)
{
    config_t config = CONFIG_LU2013;
    config.rotor.sensor = CONFIG_ROTOR_ANGLE;
    config.drive.pwm_frequency_Hz = 20000;
    /* 2 w T and (w T)^2 */
    const double w_T = 2.0 * PI * 50.0 / 20000.0;
    config.rotor.pll_bandwidth_Hz = 50;
    config.rotor.pll_proportional_q16 = (int32_t)lround(2.0 * w_T * 65536.0);
    config.rotor.pll_integral_q24 = (int32_t)lround(w_T * w_T * 16777216.0);
    return config;
}

#endif

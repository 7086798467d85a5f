/* SPDX-License-Identifier: Apache-2.0 */
/*
 * observer_config.h: a motor and drive for which the EMF observer's constants are round numbers:
 * L_q I_base = 8 mWb, and 2 psi + 5/4 of that are 32 768 uWb, so that 1 LSB of Q15 is 1 uWb.
 */
#ifndef OBSERVER_CONFIG_H
#define OBSERVER_CONFIG_H

#include "config/config.h"

extern const config_t CONFIG_LU2013;

/* 2^24 periods are 1 024 s. */
static inline config_t observer_config(void)
{
    config_t config = CONFIG_LU2013;
    config.motor.q_inductance_nH = 80000;
    config.drive.current_full_scale_mA = 100000;
    config.motor.flux_linkage_nWb = 11384000;
    config.drive.pwm_frequency_Hz = 16384;
    config.motor.pole_pairs = 10;
    config.rotor.observer_speed_mrad_s = 20000;
    return config;
}

#endif

/* SPDX-License-Identifier: Apache-2.0 */
/*
 * foc_rig.h: the fast loop on the paper's vehicle with an absolute angle and without dead time,
 * its setpoint and its codes.
 */
#ifndef FOC_RIG_H
#define FOC_RIG_H

#include <string.h>

#include "foc/foc.h"
#include "foc/tuning.h"
#include "unity.h"

extern const config_t CONFIG_LU2013;

enum { PERIOD_COUNTS = 4200 };

static config_t config;
static foc_state_t foc;
static fast_setpoint_t setpoint;
static fast_report_t report;
static const foc_period_t *const period = &foc.period;
static foc_input_t in;
static uint16_t *const codes = in.phase_current_code;

static inline void restart(void)
{
    foc_init(&foc, &config);
    const int32_t highest_pu =
        q_scale(config.battery.max_voltage_mV, 32768, config.drive.voltage_full_scale_mV);
    const fast_setpoint_t at_rest = {
        .tuning = current_tuning(&config, foc_modulation_limit_q15(&foc), highest_pu, 0,
                                 config.motor.reference_temperature_cC),
        .dead_time_slope = dead_time_slope_at(&config, highest_pu),
    };
    setpoint = at_rest;
    foc_report(&foc, &report);
}

static inline void rig_up(void)
{
    config = CONFIG_LU2013;
    config.drive.pwm_period_counts = PERIOD_COUNTS;
    config.drive.pwm_frequency_Hz = 20000;
    config.drive.dead_time_ns = 0;
    config.rotor.sensor = CONFIG_ROTOR_ANGLE;
    codes[0] = codes[1] = codes[2] = 2048;
    in.bus_voltage_code = 3513; /* 53 V of 61.8 V */
    in.rotor_angle_turn = 0;
    in.hall_state = 5;
    restart();
}

/* The slow loop numbers its setpoints. */
static inline void step(bool run)
{
    static fast_setpoint_t previous;
    if (memcmp(&previous.tuning, &setpoint.tuning, sizeof(previous.tuning)) != 0 ||
        memcmp(&previous.i_reference_pu, &setpoint.i_reference_pu,
               sizeof(previous.i_reference_pu)) != 0) {
        setpoint.sequence++;
        previous = setpoint;
    }
    if (run) {
        foc_step(&foc, &config, &setpoint, &in);
    } else {
        foc_idle_step(&foc, &config, &setpoint, &in);
    }
    foc_report(&foc, &report);
}

#endif

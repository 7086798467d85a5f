/* SPDX-License-Identifier: Apache-2.0 */
/*
 * foc_rig.h: the fast loop on the paper's vehicle with an absolute angle and without dead time,
 * its setpoint and its codes.
 */
#ifndef FOC_RIG_H
#define FOC_RIG_H

#include <string.h>

#include "config/bases.h"
#include "controller/operating_point.h"
#include "foc/foc.h"
#include "tuning.h"
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

static inline void read_report(void)
{
    foc_report_copy(&foc, &report);
    foc_report_complete(&report);
}

static inline void restart(void)
{
    foc_init(&foc, &config, BASES_MODEL_TIMER_Hz);
    const fast_setpoint_t at_rest = {.sequence = 0};
    setpoint = at_rest;
    operating_point_initial_setpoint(&config, BASES_MODEL_TIMER_Hz, &setpoint);
    read_report();
}

static inline void rig_up(void)
{
    config = CONFIG_LU2013;
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
    read_report();
}

#endif

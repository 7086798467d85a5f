/* SPDX-License-Identifier: Apache-2.0 */
/*
 * foc_rig.h: the fast reach on the paper's vehicle with an absolute angle and without dead time,
 * its command and its codes.
 */
#ifndef FOC_RIG_H
#define FOC_RIG_H

#include <string.h>

#include "foc/foc.h"
#include "unity.h"

extern const config_t CONFIG_LU2013;

enum { PERIOD_COUNTS = 4200 };

static config_t config;
static foc_state_t foc;
static foc_command_t command;
static foc_report_t report;
static foc_input_t in;
static uint16_t *const codes = in.phase_current_code;

static inline void restart(void)
{
    foc_init(&foc, &config);
    command = foc_initial_command(&foc, &config);
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
    memset(&report, 0, sizeof(report));
    for (int x = 0; x < 3; x++) {
        report.offset_q4[x] = 2048 * 16;
    }
    restart();
}

/* A slow reach numbers its commands. */
static inline void step(bool run)
{
    static foc_command_t told;
    if (memcmp(&told.tuning, &command.tuning, sizeof(told.tuning)) != 0 ||
        memcmp(&told.i_reference_pu, &command.i_reference_pu, sizeof(told.i_reference_pu)) != 0) {
        command.number++;
        told = command;
    }
    foc_step(&foc, &config, &command, run, false, &in, &report);
}

#endif

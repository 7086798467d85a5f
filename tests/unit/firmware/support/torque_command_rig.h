/* SPDX-License-Identifier: Apache-2.0 */
/*
 * torque_command_rig.h: the torque command of the paper's vehicle at a rate of 400 mN m a step,
 * from one step to the next. Included once in a program.
 */
#ifndef TORQUE_COMMAND_RIG_H
#define TORQUE_COMMAND_RIG_H

#include "paper_vehicle.h"
#include "torque/torque_command.h"
#include "unity.h"

enum { FORWARD = 30000, BACKWARD = -30000, RATE = 400, SETTLED = 200 };

/* What torque_command_step() reads of its records. */
typedef struct {
    torque_enable_t torque_enable;
    int32_t speed_mrad_s;
    int32_t voltage_use_q15;
    int32_t drive_torque_mNm; /* demanded, signed */
    bool drive_withdrawn;
    int32_t electric_mNm;  /* braking magnitude, demanded of the motor */
    int32_t uncovered_mNm; /* of the braking demand, beyond the hydraulic torque */
    int32_t rise_mNm;      /* of the hydraulic torque in this step */
    bool bridge_open;
    bool angle_valid;
} torque_command_case_t;

static config_t config;
static torque_command_state_t state;
static torque_limits_t limits;
static torque_command_case_t in;
static int32_t last_command_mNm;

/* Without torque. */
static inline void command_begins(void)
{
    torque_command_init(&state);
    last_command_mNm = 0;
}

/* Driving up to 40 N m, braking up to 25 N m, all of it enabled, and no demand. */
static inline void rig_up(void)
{
    static const torque_command_case_t NONE = {
        .torque_enable = {.drive_q15 = Q15_ONE, .brake_q15 = Q15_ONE, .reason = REASON_NONE}};
    torque_limits_state_t limits_state;
    config = paper_vehicle();
    config.brake.torque_rate_mNm_s = 1000 * RATE;
    in = NONE;
    command_begins();
    torque_limits_init(&limits_state, &limits);
    limits.driving[TORQUE_LINE_MAX_TORQUE] = limit_init(40000, REASON_MAX_TORQUE);
    limits.braking[TORQUE_LINE_MAX_TORQUE] = limit_init(25000, REASON_CHARGE_CURRENT);
}

static inline torque_command_out_t command_step(void)
{
    const fast_report_t report = {.voltage_use_q15 = in.voltage_use_q15};
    const measured_t now = {
        .report = &report, .speed_mrad_s = in.speed_mrad_s, .angle_valid = in.angle_valid};
    const demand_t demand = {.drive_torque_mNm = in.drive_torque_mNm,
                             .drive_withdrawn = in.drive_withdrawn};
    const motor_braking_t braking = {.electric_mNm = in.electric_mNm,
                                     .uncovered_mNm = in.uncovered_mNm,
                                     .rise_mNm = in.rise_mNm};
    const torque_command_out_t out =
        torque_command_step(&state, &config, &limits, &now, last_command_mNm, &in.torque_enable,
                            &demand, &braking, in.bridge_open);
    last_command_mNm = out.command_mNm;
    return out;
}

#endif

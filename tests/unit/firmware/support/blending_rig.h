/* SPDX-License-Identifier: Apache-2.0 */
/*
 * blending_rig.h: brake blending of the paper's vehicle with round numbers: a torque limit of
 * 50 N m, a loss optimum of 24 N m, a hydraulic brake without delay. Included once in a program.
 */
#ifndef BLENDING_RIG_H
#define BLENDING_RIG_H

#include "paper_vehicle.h"
#include "random_values.h"
#include "torque/brake_blending.h"
#include "unity.h"

enum { FAST_mrad_s = 30000 }; /* well above the blend-out speeds, 2.618 and 0.838 rad/s */
enum { ONE_q15 = 32768 };

static config_t config;
static brake_blending_state_t state;
static torque_limits_t limits;
static torque_limits_state_t limits_state;
static bool abs_active;
static uint8_t abs_share_percent;
static struct {
    limit_t regenerating; /* braking torque without the lines of a strategy */
    limit_t optimal;      /* braking torque at the loss optimum */
} capability;
static brake_blending_input_t in;

static inline void rig_up(void)
{
    config = paper_vehicle();
    config.brake.strategy = CONFIG_STRATEGY_SERIES_OPTIMAL;
    config.brake.parallel_electric_share_q15 = 6554; /* 0.2 */
    config.brake.electric_rated_torque_mNm = 40000;
    config.brake.max_hydraulic_torque_mNm = 300000;
    config.brake.shortfall_band_mNm = 2000;
    config.brake.blend_out_start_mrad_s = 2618;
    config.brake.blend_out_end_mrad_s = 838;
    config.brake.hydraulic_dead_time_ms = 0; /* the hydraulic brake follows its command at once */
    config.brake.hydraulic_time_constant_ms = 0;
    config.brake.hydraulic_rate_mNm_s = 2000000000;
    config.brake.bridging_time_ms = 0;
    brake_blending_init(&state, &config);
    config.motor.max_torque_mNm = 50000;
    torque_limits_init(&limits_state, &limits);
    abs_active = false;
    abs_share_percent = 0;
    capability.regenerating = limit_init(50000, REASON_MAX_TORQUE);
    capability.optimal = limit_init(24000, REASON_LOSS_OPTIMUM);
    in.demand_mNm = 0;
    in.speed_mrad_s = FAST_mrad_s;
    in.motor_command_mNm = 0;
    in.motor_growth_mNm = 1000000; /* the motor's torque rate is unlimited */
    in.motor_achieved_mNm = 0;
    in.torque_enable.drive_q15 = Q15_ONE;
    in.torque_enable.brake_q15 = Q15_ONE;
    in.torque_enable.reason = REASON_NONE;
}

/* The lines as torque_limits_step() writes them, with `capability` for the lines that depend on
 * the motor. */
static inline void write_limits(void)
{
    limit_t *line = limits.braking;
    line[TORQUE_LINE_MAX_TORQUE] = capability.regenerating;
    const int32_t demand_mNm = in.demand_mNm > 0 ? in.demand_mNm : 0;
    torque_limits_strategy(line, &config, in.speed_mrad_s, capability.optimal.torque_mNm,
                           demand_mNm);
    line[TORQUE_LINE_LOSS_OPTIMUM].reason = capability.optimal.reason;
    const int64_t enabled_mNm = (int64_t)config.motor.max_torque_mNm * in.torque_enable.brake_q15;
    line[TORQUE_LINE_ENABLE] = limit_init(
        in.torque_enable.brake_q15 < Q15_ONE ? (int32_t)(enabled_mNm / 32768) : INT32_MAX,
        in.torque_enable.reason);
    const torque_limits_input_t anti_lock = {.brake_demand_mNm = demand_mNm,
                                             .abs_active = abs_active,
                                             .abs_share_percent = abs_share_percent};
    line[TORQUE_LINE_ABS] = torque_limits_anti_lock(&limits_state, &config, &anti_lock);
}

static inline brake_blending_out_t step(void)
{
    write_limits();
    return brake_blending_step(&state, &config, &limits, &in);
}

static inline void assert_split(int32_t electric_mNm, int32_t hydraulic_mNm, reason_t reason,
                                brake_blending_out_t out)
{
    TEST_ASSERT_EQUAL_INT32(electric_mNm, out.electric_mNm);
    TEST_ASSERT_EQUAL_INT32(hydraulic_mNm, out.hydraulic_mNm);
    TEST_ASSERT_EQUAL_INT(reason, out.reason);
}

/* The motor's torque is its command, against the present direction of rotation. */
static inline void motor_follows(int32_t electric_mNm)
{
    in.motor_command_mNm = in.speed_mrad_s >= 0 ? -electric_mNm : electric_mNm;
    in.motor_achieved_mNm = in.motor_command_mNm;
}

/* Any strategy, limits, demand and speed; in one of twenty cases with the anti-lock system active,
 * in one of five with a partial torque enable. */
static inline void random_conditions(random_t *random)
{
    config.brake.strategy = random_between(random, 0, 2);
    config.brake.max_hydraulic_torque_mNm = 1000000;
    capability.regenerating = limit_init(random_between(random, 0, 60000), REASON_MAX_POWER);
    capability.optimal = capability.regenerating;
    limit_tighten(&capability.optimal, random_between(random, 0, 80000), REASON_LOSS_OPTIMUM);
    in.demand_mNm = random_between(random, 0, 300000);
    in.speed_mrad_s = random_between(random, -70000, 70000);
    abs_active = random_chance(random, 0.05);
    in.torque_enable.brake_q15 =
        (int16_t)(random_chance(random, 0.2) ? random_between(random, 0, Q15_ONE) : Q15_ONE);
    in.torque_enable.reason = REASON_TORQUE_ENABLE;
}

/* A brake whose torque does not move within a step. */
static inline void slow_brake(int32_t torque_mNm)
{
    config.brake.hydraulic_dead_time_ms = 40;
    config.brake.hydraulic_time_constant_ms = 60;
    config.brake.hydraulic_rate_mNm_s = 100;
    state.hydraulic.torque_q6_mNm = torque_mNm * 64 + 32;
    state.hydraulic.early_q6_mNm = torque_mNm * 64 + 32;
    state.hydraulic.late_q6_mNm = torque_mNm * 64 + 32;
}

/* Reports of a torque, in use, and an interval of gains. */
static inline void measured(int32_t report_mNm, int32_t least_q15, int32_t gain_q15,
                            int32_t most_q15)
{
    config.brake.hydraulic_timeout_ms = 50;
    config.brake.hydraulic_gain_band_q15 = 16384;
    config.brake.hydraulic_tolerance_mNm = 20000000;
    state.feedback.seen = true;
    state.feedback.good = true;
    state.feedback.heal_ms = 0;
    state.feedback.report_mNm = report_mNm;
    state.feedback.least_q15 = least_q15;
    state.feedback.gain_q15 = gain_q15;
    state.feedback.most_q15 = most_q15;
    in.hydraulic.torque_mNm = report_mNm;
    in.hydraulic.age_ms = 1000; /* that of the last step stands */
    in.hydraulic.valid = true;
}

#endif

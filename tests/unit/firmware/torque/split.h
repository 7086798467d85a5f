/* SPDX-License-Identifier: Apache-2.0 */
/*
 * split.h: the paper's vehicle before its brake blending, with round numbers: a motor that gives
 * what it is asked for and may give 50 N m, of which 24 are the best, a hydraulic brake that is
 * where it is told to be. Included once in a program.
 */
#ifndef TEST_TORQUE_SPLIT_H
#define TEST_TORQUE_SPLIT_H

#include "paper_vehicle.h"
#include "torque/brake_blending.h"
#include "unity.h"

enum { FAST_mrad_s = 30000 }; /* well above the blend-out speeds, 2.618 and 0.838 rad/s */

static config_t config;
static brake_blending_state_t state;
static torque_limits_t limits;
static torque_limits_state_t limits_state;
static bool abs_active;
static struct {
    limit_t regenerating; /* what bounds the motor whatever the strategy */
    limit_t optimal;      /* what returns the most */
} capability;
static brake_blending_input_t in;

static inline void before_blending(void)
{
    config = paper_vehicle();
    config.brake.strategy = CONFIG_STRATEGY_SERIES_OPTIMAL;
    config.brake.parallel_electric_share_q15 = 6554; /* 0.2 */
    config.brake.electric_rated_torque_mNm = 40000;
    config.brake.max_hydraulic_torque_mNm = 300000;
    config.brake.shortfall_band_mNm = 2000;
    config.brake.blend_out_start_mrad_s = 2618;
    config.brake.blend_out_end_mrad_s = 838;
    config.brake.hydraulic_dead_time_ms =
        0; /* the split itself: the hydraulic brake is where it is told to be */
    config.brake.hydraulic_time_constant_ms = 0;
    config.brake.hydraulic_rate_mNm_s = 2000000000;
    brake_blending_init(&state);
    config.motor.max_torque_mNm = 50000;
    torque_limits_init(&limits_state, &limits);
    abs_active = false;
    capability.regenerating = limit_init(50000, REASON_MAX_TORQUE);
    capability.optimal = limit_init(24000, REASON_LOSS_OPTIMUM);
    in.demand_mNm = 0;
    in.speed_mrad_s = FAST_mrad_s;
    in.motor_command_mNm = 0;
    in.motor_growth_mNm = 1000000; /* as far as it is asked for, soon enough */
    in.motor_achieved_mNm = 0;
    in.torque_enable.bridge = BRIDGE_PWM;
    in.torque_enable.drive_q15 = Q15_ONE;
    in.torque_enable.brake_q15 = Q15_ONE;
    in.torque_enable.reason = REASON_NONE;
}

/* The lines as torque_limits_step() makes them, with the two bounds above for what depends on the
 * motor. */
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
    line[TORQUE_LINE_ABS] = torque_limits_anti_lock(&limits_state, abs_active);
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

/* The motor does what it is asked for, braking at the present direction of rotation. */
static inline void motor_follows(int32_t electric_mNm)
{
    in.motor_command_mNm = in.speed_mrad_s >= 0 ? -electric_mNm : electric_mNm;
    in.motor_achieved_mNm = in.motor_command_mNm;
}

#endif

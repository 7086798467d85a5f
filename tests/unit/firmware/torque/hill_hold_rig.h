/* SPDX-License-Identifier: Apache-2.0 */
/* hill_hold_rig.h: a hold of 30 N m, and what its step sees of demand, wheel and road. */
#ifndef TEST_HILL_HOLD_RIG_H
#define TEST_HILL_HOLD_RIG_H

#include "core/q15.h"
#include "paper_vehicle.h"
#include "torque/hill_hold.h"
#include "unity.h"

enum { HOLD = 30000, RELEASE = 1000, CREEP = 100, BACK = -1000, SLOW = 3000 };

static config_t config;
static hill_hold_state_t state;
static demand_t demand;
static brake_blending_out_t split;
static int32_t motor_mNm, road_mNm, speed_mrad_s;
static bool standstill, seen, may_drive;

static inline void rig_start(void)
{
    const demand_t none = {.engaged = DRIVE_DIRECTION_FORWARD};
    const brake_blending_out_t level = {.slower_mrad_s = 0};
    config = paper_vehicle();
    config.motor.max_torque_mNm = 40000; /* three quarters of it: the torque that releases */
    config.brake.torque_rate_mNm_s = 400000;
    config.driver.hold_torque_mNm = HOLD;
    config.driver.hold_release_ms = RELEASE;
    config.driver.direction_change_mrad_s = SLOW;
    config.monitor.standstill_mrad_s = 300;
    demand = none;
    split = level;
    road_mNm = 0;
    motor_mNm = 0;
    speed_mrad_s = 0;
    standstill = false;
    seen = true;
    may_drive = true;
    hill_hold_init(&state);
}

static inline int32_t step(void)
{
    const hill_hold_wheel_t wheel = {
        .speed_mrad_s = speed_mrad_s,
        .standstill = standstill,
        .road_mNm = road_mNm,
        .command_mNm = motor_mNm,
        .seen = seen,
        .may_drive = may_drive,
    };
    return hill_hold_step(&state, &config, &demand, &split, &wheel);
}

static inline void hold(void)
{
    standstill = true;
    demand.brake_torque_mNm = 10000;
    TEST_ASSERT_EQUAL_INT32(HOLD, step());
    demand.brake_torque_mNm = 0;
    TEST_ASSERT_EQUAL_INT32(HOLD, step());
}

static inline int32_t drive(int32_t drive_mNm, int32_t command_mNm)
{
    demand.drive_torque_mNm = drive_mNm;
    motor_mNm = command_mNm;
    return step();
}

#endif

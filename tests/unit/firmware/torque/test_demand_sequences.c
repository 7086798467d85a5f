/* SPDX-License-Identifier: Apache-2.0 */
/* Properties of the whole slow loop in random sequences of demands, ages, directions and flags, and
 * its return after a lost demand. */

#include <math.h>

#include "random_values.h"
#include "torque_rig.h"
#include "unity.h"

void setUp(void)
{
    torque_rig_reset();
}

void tearDown(void) {}

static void draw_demand(random_t *random)
{
    if (in.demand_age_ms == 0 && random_chance(random, 0.03)) {
        in.drive_torque_mNm = random_between(random, -60000, 60000);
        in.brake_torque_mNm = random_chance(random, 0.6) ? 0 : random_between(random, 0, 150000);
        in.direction = (drive_direction_t)random_between(random, 0, 2);
        in.abs_active = random_chance(random, 0.1);
    }
    const bool begins = random_chance(random, 0.002);
    in.demand_age_ms =
        begins || (in.demand_age_ms > 0 && random_chance(random, 0.998)) ? in.demand_age_ms + 1 : 0;
    /* Through standstill, and to and fro around it. */
    const int32_t step_mrad_s = random_chance(random, 0.01) ? 20000 : 100;
    in.speed_mrad_s += random_between(random, -step_mrad_s, step_mrad_s);
    in.speed_mrad_s = q_limit(in.speed_mrad_s, 40000);
    in.standstill = q_abs(in.speed_mrad_s) < 300 && random_chance(random, 0.5);
}

static int32_t along_mNm(int32_t torque_mNm)
{
    return in.speed_mrad_s >= 0 ? torque_mNm : -torque_mNm;
}

void test_no_driving_torque_while_braking_or_lost_and_no_change_of_sign_in_any_sequence(void)
{
    random_t random = random_seeded(12);
    config.driver.hold_torque_mNm = 60000;
    int32_t before_mNm = 0;
    int braked = 0;
    int lost = 0;
    for (int n = 0; n < 300000; n++) {
        draw_demand(&random);
        const torque_output_t out = step();
        const bool is_lost = in.demand_age_ms > (uint32_t)config.brake.demand_timeout_ms;
        const bool brakes = in.brake_torque_mNm > 0;
        const int32_t sign = drive_direction_sign(out.engaged);
        braked += brakes && out.command_mNm != 0 ? 1 : 0;
        lost += is_lost ? 1 : 0;
        /* At a speed of zero, which may be a stuck hall line, what braked falls at the rate. */
        const bool falls = in.speed_mrad_s == 0 && q_abs(out.command_mNm) < q_abs(before_mNm);
        if (brakes || is_lost || sign == 0) {
            TEST_ASSERT_TRUE(falls || along_mNm(out.command_mNm) <= 0);
        }
        if (is_lost) { /* an old demand makes no torque grow that is there already */
            TEST_ASSERT_TRUE(brakes || in.drive_torque_mNm * sign < 0 ||
                             q_abs(out.command_mNm) <= q_abs(before_mNm));
        }
        /* Braking torque passes zero only on the way to a driving demand of its own sign. */
        if (along_mNm(before_mNm) > 0 && in.drive_torque_mNm == 0) {
            TEST_ASSERT_GREATER_OR_EQUAL_INT32(0, along_mNm(out.command_mNm));
        }
        const int32_t drive_mNm =
            !brakes && in.drive_torque_mNm * sign > 0 ? in.drive_torque_mNm : 0;
        if (!brakes && !is_lost && out.command_mNm != drive_mNm) {
            TEST_ASSERT_TRUE(out.reason != REASON_NONE || in.drive_torque_mNm * sign < 0);
        }
        TEST_ASSERT_TRUE(in.abs_active == false || along_mNm(out.command_mNm) >= 0);
        before_mNm = out.command_mNm;
    }
    TEST_ASSERT_GREATER_THAN_INT(10000, braked);
    TEST_ASSERT_GREATER_THAN_INT(10000, lost);
}

/* The path that takes over makes 20 N m (1 - exp(-t/60 ms)) after its dead time. A motor that left
 * at a torque rate of 80 N m/s would brake 5.0 N m beside it. */
void test_motor_and_the_path_that_takes_over_make_the_lost_demand_together(void)
{
    config.brake.torque_rate_mNm_s = 80000;
    const int32_t lag_ms = config.brake.hydraulic_time_constant_ms;
    in.brake_torque_mNm = 20000;
    torque_output_t out = step();
    for (int n = 0; n < 1000; n++) {
        out = step();
    }
    TEST_ASSERT_INT32_WITHIN(10, -20000, out.command_mNm);
    in.demand_age_ms = 1000;
    for (int n = 0; n < config.driver.lost_hold_ms + config.brake.hydraulic_dead_time_ms; n++) {
        out = step();
        TEST_ASSERT_INT32_WITHIN(10, -20000, out.command_mNm);
    }
    for (int n = 1; n < 500; n++) {
        out = step();
        const double taken_mNm = 20000.0 * (1.0 - exp(-n / (double)lag_ms));
        TEST_ASSERT_DOUBLE_WITHIN(250.0, 20000.0, taken_mNm - out.command_mNm);
    }
}

/* The brake system made all of it meanwhile; exp(-1) of that is left a time constant after its dead
 * time. */
void test_motor_returns_after_a_loss_only_as_the_brake_system_leaves_its_own_path(void)
{
    in.brake_torque_mNm = 20000;
    run(200);
    in.demand_age_ms = 1000;
    run(config.driver.lost_hold_ms + 1000);
    in.demand_age_ms = 0;
    const torque_output_t waiting = run(config.brake.hydraulic_dead_time_ms);
    TEST_ASSERT_INT32_WITHIN(100, 0, waiting.command_mNm);
    TEST_ASSERT_EQUAL_INT32(0, waiting.hydraulic_mNm);
    const torque_output_t later = run(config.brake.hydraulic_time_constant_ms);
    TEST_ASSERT_DOUBLE_WITHIN(400.0, (exp(-1.0) - 1.0) * 20000.0, later.command_mNm);
    TEST_ASSERT_EQUAL_INT32(-20000, run(600).command_mNm);
}

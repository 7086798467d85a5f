/* SPDX-License-Identifier: Apache-2.0 */
/* Torque while the battery's charge contradicts the current sensors: less of it by the motor, the
 * rest of a braking demand by the hydraulic brake. */
#include "torque_rig.h"
#include "unity.h"

enum { QUARTER_Q15 = 8192, FOUR_TENTHS_Q15 = 13107 };

static hydraulic_model_t brake; /* the vehicle's, with dead time and lag */

void setUp(void)
{
    torque_rig_reset();
    hydraulic_model_init(&brake);
}

void tearDown(void) {}

static torque_output_t step_vehicle(void)
{
    const torque_output_t out = step();
    hydraulic_model_step(&brake, &config, out.hydraulic_mNm);
    return out;
}

static torque_output_t run_vehicle(int milliseconds)
{
    torque_output_t out = {.command_mNm = 0};
    for (int ms = 0; ms < milliseconds; ms++) {
        out = step_vehicle();
    }
    return out;
}

static int32_t sum_mNm(const torque_output_t *out)
{
    return hydraulic_model_torque_mNm(&brake) - out->command_mNm;
}

void test_driving_torque_is_less_by_the_share_that_is_not_seen(void)
{
    for (int32_t way = -1; way <= 1; way += 2) {
        setUp();
        in.speed_mrad_s *= way;
        in.direction = way > 0 ? DRIVE_DIRECTION_FORWARD : DRIVE_DIRECTION_REVERSE;
        in.drive_torque_mNm = way * 20000;
        in.current_missing_q15 = QUARTER_Q15;
        const torque_output_t out = run(200);
        TEST_ASSERT_INT32_WITHIN(1, way * 15000, out.command_mNm);
        TEST_ASSERT_EQUAL_INT(REASON_CURRENT_GAIN, out.reason);
    }
}

void test_driving_torque_beyond_the_limits_is_less_than_them_by_the_share(void)
{
    in.drive_torque_mNm = 100000;
    in.current_missing_q15 = QUARTER_Q15;
    const torque_output_t out = run(200);
    TEST_ASSERT_EQUAL_INT32(config.motor.max_torque_mNm - config.motor.max_torque_mNm / 4,
                            out.command_mNm);
    TEST_ASSERT_EQUAL_INT(REASON_CURRENT_GAIN, out.reason);
}

/* 30 N m: 18 of the motor, 12 of the hydraulic brake. What comes late of that the motor makes. */
void test_braking_goes_to_the_hydraulic_brake_without_a_gap(void)
{
    for (int32_t way = -1; way <= 1; way += 2) {
        setUp();
        in.speed_mrad_s *= way;
        in.brake_torque_mNm = 30000;
        (void)run_vehicle(300);
        in.current_missing_q15 = FOUR_TENTHS_Q15;
        torque_output_t out = {.command_mNm = 0};
        for (int ms = 0; ms < 1000; ms++) {
            out = step_vehicle();
            out.command_mNm *= way;
            TEST_ASSERT_INT32_WITHIN(300, 30000, sum_mNm(&out));
        }
        TEST_ASSERT_INT32_WITHIN(300, -18000, out.command_mNm);
        TEST_ASSERT_INT32_WITHIN(300, 12000, out.hydraulic_mNm);
        TEST_ASSERT_EQUAL_INT(REASON_CURRENT_GAIN, out.reason);
        in.current_missing_q15 = 0; /* and back */
        for (int ms = 0; ms < 1000; ms++) {
            out = step_vehicle();
            out.command_mNm *= way;
            TEST_ASSERT_INT32_WITHIN(300, 30000, sum_mNm(&out));
        }
        TEST_ASSERT_INT32_WITHIN(300, -30000, out.command_mNm);
    }
}

/* At the torque rate of 400 N m/s 20 N m take 50 ms, whoever makes them. */
void test_a_demand_that_begins_is_made_as_fast_as_with_good_sensors(void)
{
    int32_t sums_mNm[200];
    for (int wrong = 0; wrong <= 1; wrong++) {
        setUp();
        in.current_missing_q15 = wrong * FOUR_TENTHS_Q15;
        in.brake_torque_mNm = 20000;
        for (int ms = 0; ms < 200; ms++) {
            const torque_output_t out = step_vehicle();
            if (wrong == 0) {
                sums_mNm[ms] = sum_mNm(&out);
            } else {
                TEST_ASSERT_GREATER_OR_EQUAL_INT32(sums_mNm[ms] - 300, sum_mNm(&out));
                TEST_ASSERT_LESS_OR_EQUAL_INT32(20300, sum_mNm(&out));
            }
        }
    }
}

void test_a_motor_without_another_brake_keeps_its_torque(void)
{
    for (int part = 0; part < 3; part++) {
        setUp();
        config.driver.no_other_brake = part == 1 ? 1 : 0;
        config.brake.max_hydraulic_torque_mNm =
            part == 2 ? 0 : config.brake.max_hydraulic_torque_mNm;
        torque_rig_start();
        in.current_missing_q15 = FOUR_TENTHS_Q15;
        in.brake_torque_mNm = 30000;
        torque_output_t out = run_vehicle(1000);
        TEST_ASSERT_INT32_WITHIN(300, part == 0 ? -18000 : -30000, out.command_mNm);
        in.brake_torque_mNm = 0;
        in.drive_torque_mNm = 20000;
        out = run(500);
        TEST_ASSERT_INT32_WITHIN(2, part == 0 ? 12000 : 20000, out.command_mNm);
        TEST_ASSERT_INT32_WITHIN(1, part == 0 ? 24000 : FEASIBLE_UNBOUNDED,
                                 state.table.driving[TORQUE_LINE_CURRENT_GAIN].torque_mNm);
    }
}

/* A hydraulic brake of 10 N m: the motor makes the other 20 of 30, within its limits. */
void test_what_a_small_hydraulic_brake_cannot_make_the_motor_makes(void)
{
    config.brake.max_hydraulic_torque_mNm = 10000;
    torque_rig_start();
    in.current_missing_q15 = FOUR_TENTHS_Q15;
    in.brake_torque_mNm = 30000;
    const torque_output_t out = run_vehicle(1000);
    TEST_ASSERT_INT32_WITHIN(300, -20000, out.command_mNm);
    TEST_ASSERT_INT32_WITHIN(300, 30000, sum_mNm(&out));
}

/* What returns the most energy is a current as well. */
void test_loss_optimum_is_less_by_the_share(void)
{
    in.speed_mrad_s = mrad_s_of_rpm(50.0);
    in.brake_torque_mNm = 60000;
    const int32_t whole_mNm = -run_vehicle(500).command_mNm;
    in.current_missing_q15 = QUARTER_Q15;
    const torque_output_t out = run_vehicle(1500);
    TEST_ASSERT_INT32_WITHIN(20, whole_mNm - whole_mNm / 4, -out.command_mNm);
    TEST_ASSERT_INT32_WITHIN(300, 60000, sum_mNm(&out));
}

/* A reason of the demand itself comes first. */
void test_reason_of_a_withdrawn_driving_torque_stays(void)
{
    in.drive_torque_mNm = 20000;
    in.brake_torque_mNm = 5000;
    in.current_missing_q15 = QUARTER_Q15;
    const torque_output_t out = run_vehicle(500);
    TEST_ASSERT_TRUE(out.reason == REASON_BRAKE_PRIORITY || out.reason == REASON_CURRENT_GAIN);
    TEST_ASSERT_INT32_WITHIN(100, -3750, out.command_mNm);
}

/* SPDX-License-Identifier: Apache-2.0 */
#include "core/q15.h"
#include "random_values.h"
#include "torque/lift_off.h"
#include "unity.h"

static torque_limits_t limits;

void setUp(void)
{
    torque_limits_state_t state;
    torque_limits_init(&state, &limits);
    limits.braking[TORQUE_LINE_MAX_TORQUE] = limit_init(40000, REASON_MAX_TORQUE);
}

void tearDown(void) {}

static void assert_split(int32_t motor_mNm, int32_t hydraulic_mNm, reason_t reason, lift_off_t out)
{
    TEST_ASSERT_EQUAL_INT32(motor_mNm, out.motor_mNm);
    TEST_ASSERT_EQUAL_INT32(hydraulic_mNm, out.hydraulic_mNm);
    TEST_ASSERT_EQUAL_INT(reason, out.reason);
}

void test_motor_takes_all_of_it_within_its_limits(void)
{
    assert_split(20000, 0, REASON_NONE, lift_off_split(&limits, 20000, 0, 0));
    assert_split(0, 0, REASON_NONE, lift_off_split(&limits, 0, 30000, 0));
}

void test_the_least_demand_is_one(void)
{
    assert_split(1, 0, REASON_NONE, lift_off_split(&limits, 1, 0, 0));
    assert_split(0, 0, REASON_NONE, lift_off_split(&limits, -1, 0, 0));
}

void test_brake_pedal_comes_first(void)
{
    assert_split(10000, 0, REASON_MAX_TORQUE, lift_off_split(&limits, 20000, 30000, 0));
    assert_split(0, 0, REASON_MAX_TORQUE, lift_off_split(&limits, 20000, 40000, 0));
}

void test_lines_of_the_braking_strategy_do_not_bound_it(void)
{
    limits.braking[TORQUE_LINE_LOSS_OPTIMUM] = limit_init(1000, REASON_LOSS_OPTIMUM);
    limits.braking[TORQUE_LINE_ELECTRIC_RATED] = limit_init(1000, REASON_ELECTRIC_RATED);
    limits.braking[TORQUE_LINE_ELECTRIC_SHARE] = limit_init(1000, REASON_ELECTRIC_SHARE);
    assert_split(20000, 0, REASON_NONE, lift_off_split(&limits, 20000, 0, 0));
}

void test_every_other_line_bounds_it_alone(void)
{
    for (torque_line_t line = 0; line < TORQUE_LINE_CURRENT_GAIN; line++) {
        setUp();
        limits.braking[line] = limit_init(1000, REASON_VOLTAGE);
        assert_split(1000, 0, REASON_VOLTAGE, lift_off_split(&limits, 20000, 0, 0));
    }
}

void test_charge_limit_and_anti_lock_take_it_away_without_the_hydraulic_brake(void)
{
    limits.braking[TORQUE_LINE_RETURNED] = limit_init(5000, REASON_CHARGE_CURRENT);
    assert_split(5000, 0, REASON_CHARGE_CURRENT, lift_off_split(&limits, 20000, 0, 0));
    limits.braking[TORQUE_LINE_ABS] = limit_init(0, REASON_ABS);
    assert_split(0, 0, REASON_ABS, lift_off_split(&limits, 20000, 0, 0));
}

void test_what_a_gain_of_the_current_sensors_takes_goes_to_the_hydraulic_brake(void)
{
    limits.braking[TORQUE_LINE_CURRENT_GAIN] = limit_init(12000, REASON_CURRENT_GAIN);
    assert_split(12000, 8000, REASON_CURRENT_GAIN, lift_off_split(&limits, 20000, 0, 0));
    assert_split(2000, 20000, REASON_CURRENT_GAIN, lift_off_split(&limits, 22000, 10000, 0));
}

void test_what_the_blend_out_takes_goes_to_the_hydraulic_brake(void)
{
    limits.braking[TORQUE_LINE_BLEND_OUT] = limit_init(12000, REASON_BLEND_OUT);
    assert_split(12000, 8000, REASON_BLEND_OUT, lift_off_split(&limits, 20000, 0, 0));
    assert_split(2000, 18000, REASON_BLEND_OUT, lift_off_split(&limits, 20000, 10000, 0));
    limits.braking[TORQUE_LINE_BLEND_OUT] = limit_init(0, REASON_BLEND_OUT);
    assert_split(0, 20000, REASON_BLEND_OUT, lift_off_split(&limits, 20000, 0, 0));
    limits.braking[TORQUE_LINE_RETURNED] = limit_init(5000, REASON_CHARGE_CURRENT);
    assert_split(0, 5000, REASON_BLEND_OUT, lift_off_split(&limits, 20000, 0, 0));
}

/* P = A (i^2 - 2 i_opt i), zero at no current and at twice that of the optimum; the torque is a
 * straight line over i. So with C = 2 and T_opt = 9 N m the battery pays from 16 N m on. */
void test_the_battery_does_not_pay_for_it(void)
{
    limits.optimum_mNm = 9000;
    assert_split(16000, 4000, REASON_LOSS_OPTIMUM, lift_off_split(&limits, 20000, 0, 2000));
    assert_split(16000, 0, REASON_NONE, lift_off_split(&limits, 16000, 0, 2000));
    limits.braking[TORQUE_LINE_BLEND_OUT] = limit_init(12000, REASON_BLEND_OUT);
    assert_split(12000, 8000, REASON_BLEND_OUT, lift_off_split(&limits, 20000, 0, 2000));
}

void test_where_every_torque_costs_energy_it_is_what_coasting_does(void)
{
    limits.optimum_mNm = 500;
    assert_split(2000, 18000, REASON_LOSS_OPTIMUM, lift_off_split(&limits, 20000, 0, 2000));
}

void test_parts_are_magnitudes_and_never_more_than_the_demand(void)
{
    random_t random = random_seeded(5);
    for (int n = 0; n < 100000; n++) {
        for (torque_line_t line = 0; line < TORQUE_LINE_COUNT; line++) {
            limits.braking[line] = limit_init(random_wild(&random), REASON_VOLTAGE);
        }
        const int32_t demand_mNm = random_between(&random, 0, 100000000);
        const lift_off_t out =
            lift_off_split(&limits, demand_mNm, random_between(&random, 0, 100000000),
                           random_between(&random, 0, 100000000));
        TEST_ASSERT_GREATER_OR_EQUAL_INT32(0, out.motor_mNm);
        TEST_ASSERT_GREATER_OR_EQUAL_INT32(0, out.hydraulic_mNm);
        TEST_ASSERT_LESS_OR_EQUAL_INT32(demand_mNm, out.motor_mNm + out.hydraulic_mNm);
        TEST_ASSERT_TRUE(out.motor_mNm == demand_mNm || out.reason != REASON_NONE);
    }
}

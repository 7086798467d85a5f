/* SPDX-License-Identifier: Apache-2.0 */
/* Hydraulic brake: dead time, first-order lag, rate and saturation. */
#include "plant/hydraulic_brake.h"

#include <math.h>

#include "unity.h"

static const double STEP_S = 50e-6;
enum { STEPS_PER_MS = 20 };
static hydraulic_brake_params_t params;
static hydraulic_brake_state_t brake;

void setUp(void)
{
    const hydraulic_brake_params_t usual = {.hydraulic_dead_time_s = 0.04,
                                            .hydraulic_time_constant_s = 0.06,
                                            .hydraulic_rate_nm_per_s = 1e6,
                                            .max_hydraulic_torque_nm = 300.0};
    params = usual;
    brake = hydraulic_brake_init(&params, STEP_S);
}

void tearDown(void) {}

static void run_ms(int ms, double command_nm)
{
    for (int k = 0; k < ms; k++) {
        hydraulic_brake_command(&params, &brake, command_nm);
        for (int n = 0; n < STEPS_PER_MS; n++) {
            hydraulic_brake_step(&brake);
        }
    }
}

void test_torque_is_unchanged_during_the_dead_time(void)
{
    run_ms(40, 100.0);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, brake.torque_nm);
    run_ms(1, 100.0);
    TEST_ASSERT_TRUE(brake.torque_nm > 0.0);
}

void test_after_the_dead_time_the_torque_follows_as_a_first_order_lag(void)
{
    run_ms(40 + 60, 100.0); /* one time constant */
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 100.0 * (1.0 - exp(-1.0)), brake.torque_nm);
    run_ms(600, 100.0);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 100.0, brake.torque_nm);
    run_ms(40 + 60, 0.0);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 100.0 * exp(-1.0), brake.torque_nm);
}

void test_the_rate_bounds_both_directions(void)
{
    params.hydraulic_rate_nm_per_s = 500.0;
    brake = hydraulic_brake_init(&params, STEP_S);
    run_ms(40 + 100, 300.0); /* the lag alone would give more */
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 50.0, brake.torque_nm);
    run_ms(400, 300.0);
    const double before_nm = brake.torque_nm;
    run_ms(40, 0.0); /* commands of the dead time still act */
    const double at_release_nm = brake.torque_nm;
    TEST_ASSERT_TRUE(at_release_nm >= before_nm);
    run_ms(100, 0.0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, at_release_nm - 50.0, brake.torque_nm);
}

void test_brake_torque_stays_between_zero_and_its_maximum(void)
{
    run_ms(3000, 1e9);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 300.0, brake.torque_nm);
    run_ms(3000, -50.0);
    TEST_ASSERT_TRUE(brake.torque_nm >= 0.0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.0, brake.torque_nm);
}

void test_torque_equals_the_command_without_dead_time_and_lag(void)
{
    params.hydraulic_dead_time_s = 0.0;
    params.hydraulic_time_constant_s = 0.0;
    params.hydraulic_rate_nm_per_s = 1e7;
    brake = hydraulic_brake_init(&params, STEP_S);
    hydraulic_brake_command(&params, &brake, 120.0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 120.0, hydraulic_brake_step(&brake));
}

void test_below_the_knee_the_rise_is_limited_to_the_knee_rate_and_the_fall_is_not(void)
{
    params.hydraulic_dead_time_s = 0.0;
    params.hydraulic_time_constant_s = 0.0;
    params.hydraulic_rate_nm_per_s = 1000.0;
    params.knee_torque_nm = 20.0;
    params.knee_rate_nm_per_s = 200.0;
    brake = hydraulic_brake_init(&params, STEP_S);
    run_ms(50, 300.0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 10.0, brake.torque_nm);
    run_ms(50 + 100, 300.0); /* 20 N m after 100 ms, then 1000 N m/s; a step may contain the knee */
    TEST_ASSERT_DOUBLE_WITHIN(0.06, 120.0, brake.torque_nm);
    run_ms(110, 0.0);
    TEST_ASSERT_DOUBLE_WITHIN(0.06, 10.0, brake.torque_nm);
}

void test_lost_friction_scales_the_torque_and_not_the_pressure_dynamics(void)
{
    run_ms(2000, 100.0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 100.0, hydraulic_brake_step(&brake));
    params.torque_loss = 0.2;
    hydraulic_brake_refresh(&params, &brake, 0.5, STEP_S);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 100.0 * 0.8 * 0.5, hydraulic_brake_step(&brake));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 100.0, brake.torque_nm);
    params.torque_loss = 1.0;
    hydraulic_brake_refresh(&params, &brake, 0.0, STEP_S);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, hydraulic_brake_step(&brake));
}

/* Torque after ten milliseconds with the valve, from 100 N m with 200 N m commanded. */
static double through_valve(hydraulic_valve_t valve, double command_nm)
{
    hydraulic_brake_params_t quick = params;
    quick.hydraulic_dead_time_s = 0.0;
    quick.hydraulic_time_constant_s = 0.0;
    quick.hydraulic_rate_nm_per_s = 1e5;
    quick.knee_torque_nm = 0.0;
    quick.torque_loss = 0.0;
    brake = hydraulic_brake_init(&quick, STEP_S);
    hydraulic_brake_command(&quick, &brake, 100.0);
    for (int k = 0; k < 200; k++) {
        hydraulic_brake_step(&brake);
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 100.0, brake.torque_nm);
    hydraulic_brake_command(&quick, &brake, command_nm);
    hydraulic_brake_valve(&brake, valve, 300.0, 2000.0, STEP_S);
    for (int k = 0; k < 200; k++) {
        hydraulic_brake_step(&brake);
    }
    return brake.torque_nm;
}

void test_anti_lock_valve_limits_pressure_build_up_and_never_a_falling_command(void)
{
    const double passed_s = 200.0 * STEP_S;
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 200.0, through_valve(HYDRAULIC_VALVE_OPEN, 200.0));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 100.0 + 300.0 * passed_s,
                              through_valve(HYDRAULIC_VALVE_BUILD, 200.0));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 100.0, through_valve(HYDRAULIC_VALVE_HOLD, 200.0));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, fmax(100.0 - 2000.0 * passed_s, 0.0),
                              through_valve(HYDRAULIC_VALVE_DUMP, 200.0));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 30.0, through_valve(HYDRAULIC_VALVE_HOLD, 30.0));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 30.0, through_valve(HYDRAULIC_VALVE_BUILD, 30.0));
}

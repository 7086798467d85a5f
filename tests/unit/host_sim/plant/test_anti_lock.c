/* SPDX-License-Identifier: Apache-2.0 */
/* The anti-lock system alone: reference speed, valves, flag, and a failed speed sensor. */
#include "plant/anti_lock.h"

#include <math.h>
#include <stddef.h>

#include "unity.h"

static const double STEP_S = 1e-3;
static anti_lock_params_t params;
static anti_lock_t state;
static double rim[4];
static bool below_command[4];
static anti_lock_input_t in;

void setUp(void)
{
    const anti_lock_params_t usual = {.active = 1.0,
                                      .slip_hold = 0.06,
                                      .slip_dump = 0.12,
                                      .rim_deceleration_m_per_s2 = 15.0,
                                      .build_rate_nm_per_s = 500.0,
                                      .dump_rate_nm_per_s = 800.0,
                                      .margin_m_per_s2 = 0.1,
                                      .lowest_speed_m_per_s = 1.5,
                                      .release_s = 0.2};
    const anti_lock_t fresh = {.at_work = false};
    const anti_lock_input_t brakes = {.rim_m_per_s = rim,
                                      .below_command = below_command,
                                      .wheels = 4,
                                      .acceleration_m_per_s2 = 0.0,
                                      .brakes = true};
    params = usual;
    state = fresh;
    in = brakes;
    for (int k = 0; k < 4; k++) {
        rim[k] = 10.0;
        below_command[k] = false;
        state.wheel[k].rim_m_per_s = 10.0;
    }
}

void tearDown(void) {}

static void run(double duration_s)
{
    for (int k = 0; k < (int)lround(duration_s / STEP_S); k++) {
        anti_lock_step(&params, &state, &in, STEP_S);
    }
}

/* Changes the speed of a wheel slowly, so that only the slip threshold acts. */
static void bring(int wheel, double to_m_per_s)
{
    const double from = rim[wheel];
    for (int k = 1; k <= 500; k++) {
        rim[wheel] = from + (to_m_per_s - from) * k / 500.0;
        run(STEP_S);
    }
}

void test_valves_are_open_for_rolling_wheels(void)
{
    run(1.0);
    for (int k = 0; k < 4; k++) {
        TEST_ASSERT_EQUAL_INT(HYDRAULIC_VALVE_OPEN, state.wheel[k].valve);
    }
    TEST_ASSERT_FALSE(state.at_work);
    TEST_ASSERT_EQUAL_DOUBLE(10.0, state.reference_m_per_s);
}

void test_slip_thresholds_act_on_each_wheel_by_itself(void)
{
    bring(2, 9.2); /* 8 % */
    TEST_ASSERT_EQUAL_INT(HYDRAULIC_VALVE_HOLD, state.wheel[2].valve);
    TEST_ASSERT_FALSE(state.at_work);
    bring(2, 8.5); /* 15 % */
    TEST_ASSERT_EQUAL_INT(HYDRAULIC_VALVE_DUMP, state.wheel[2].valve);
    TEST_ASSERT_TRUE(state.at_work);
    /* While the flag is set the torque of the other wheels rises at the anti-lock rate only. */
    TEST_ASSERT_EQUAL_INT(HYDRAULIC_VALVE_BUILD, state.wheel[0].valve);
    TEST_ASSERT_EQUAL_INT(HYDRAULIC_VALVE_BUILD, state.wheel[3].valve);
}

void test_pressure_of_an_accelerating_wheel_is_held(void)
{
    bring(1, 8.0);
    TEST_ASSERT_EQUAL_INT(HYDRAULIC_VALVE_DUMP, state.wheel[1].valve);
    for (int k = 0; k < 50; k++) {
        rim[1] += 10.0 * STEP_S;
        run(STEP_S);
    }
    TEST_ASSERT_TRUE(rim[1] < 0.88 * 10.0);
    TEST_ASSERT_EQUAL_INT(HYDRAULIC_VALVE_HOLD, state.wheel[1].valve);
}

void test_pressure_is_held_at_high_rim_deceleration_before_the_slip_threshold(void)
{
    for (int k = 0; k < 15; k++) {
        rim[0] -= 30.0 * STEP_S; /* 0.45 m/s: 4.5 % */
        run(STEP_S);
    }
    TEST_ASSERT_EQUAL_INT(HYDRAULIC_VALVE_HOLD, state.wheel[0].valve);
}

void test_reference_speed_does_not_collapse_when_all_wheels_lock(void)
{
    in.acceleration_m_per_s2 = -1.0;
    run(0.01);
    for (int k = 0; k < 4; k++) {
        rim[k] = 4.0;
    }
    run(0.5);
    /* 10 m/s less 1.1 m/s^2 for half a second */
    TEST_ASSERT_DOUBLE_WITHIN(0.02, 10.0 - 0.55, state.reference_m_per_s);
    for (int k = 0; k < 4; k++) {
        TEST_ASSERT_EQUAL_INT(HYDRAULIC_VALVE_DUMP, state.wheel[k].valve);
    }
}

void test_wheel_spin_does_not_activate_anti_lock(void)
{
    in.brakes = false;
    bring(0, 20.0);
    TEST_ASSERT_EQUAL_DOUBLE(10.0, state.reference_m_per_s);
    TEST_ASSERT_EQUAL_INT(HYDRAULIC_VALVE_OPEN, state.wheel[1].valve);
    TEST_ASSERT_FALSE(state.at_work);
}

void test_flag_is_cleared_after_every_brake_has_followed_its_command_for_release_s(void)
{
    bring(2, 8.5);
    rim[2] = 10.0;
    below_command[2] = true;
    run(1.0);
    TEST_ASSERT_TRUE(state.at_work);
    below_command[2] = false;
    run(0.19);
    TEST_ASSERT_TRUE(state.at_work);
    run(0.02);
    TEST_ASSERT_FALSE(state.at_work);
    TEST_ASSERT_EQUAL_INT(HYDRAULIC_VALVE_OPEN, state.wheel[0].valve);
}

void test_flag_is_cleared_when_the_driver_stops_braking(void)
{
    bring(2, 8.5);
    TEST_ASSERT_TRUE(state.at_work);
    in.brakes = false;
    run(STEP_S);
    TEST_ASSERT_FALSE(state.at_work);
    TEST_ASSERT_EQUAL_INT(HYDRAULIC_VALVE_OPEN, state.wheel[2].valve);
}

void test_valves_are_open_below_lowest_speed(void)
{
    for (int k = 0; k < 4; k++) {
        bring(k, 1.4);
    }
    state.reference_m_per_s = 1.4;
    rim[3] = 0.0;
    run(0.3);
    TEST_ASSERT_EQUAL_INT(HYDRAULIC_VALVE_OPEN, state.wheel[3].valve);
}

void test_wheel_sensor_at_zero_for_too_long_switches_anti_lock_off(void)
{
    rim[1] = 0.0;
    run(1.9);
    TEST_ASSERT_FALSE(state.failed);
    TEST_ASSERT_EQUAL_INT(HYDRAULIC_VALVE_DUMP, state.wheel[1].valve);
    run(0.2);
    TEST_ASSERT_TRUE(state.failed);
    TEST_ASSERT_FALSE(state.at_work);
    TEST_ASSERT_EQUAL_INT(HYDRAULIC_VALVE_OPEN,
                          state.wheel[1].valve); /* that wheel must brake again */
    rim[1] = 10.0;
    rim[0] = 5.0;
    run(0.5);
    TEST_ASSERT_EQUAL_INT(HYDRAULIC_VALVE_OPEN, state.wheel[0].valve);
}

void test_valves_stay_open_with_anti_lock_off(void)
{
    params.active = 0.0;
    bring(0, 2.0);
    TEST_ASSERT_EQUAL_INT(HYDRAULIC_VALVE_OPEN, state.wheel[0].valve);
    TEST_ASSERT_FALSE(state.at_work);
}

void test_impossible_thresholds_are_refused_with_their_key(void)
{
    TEST_ASSERT_NULL(anti_lock_objection(&params));
    params.slip_dump = 0.05;
    TEST_ASSERT_NOT_NULL(anti_lock_objection(&params));
    params.active = 0.0;
    TEST_ASSERT_NULL(anti_lock_objection(&params));
}

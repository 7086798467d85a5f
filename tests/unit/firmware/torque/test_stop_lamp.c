/* SPDX-License-Identifier: Apache-2.0 */
#include <math.h>

#include "paper_vehicle.h"
#include "torque/stop_lamp.h"
#include "unity.h"

static config_t config;
static stop_lamp_state_t state;
static double speed_mrad_s;

void setUp(void)
{
    config = paper_vehicle(); /* wheel radius 0.25 m */
    stop_lamp_init(&state);
    speed_mrad_s = 60000.0; /* 15 m/s */
}

void tearDown(void) {}

/* Decelerate uniformly for a time, no braking demanded; whether the lamp is lit in the end. */
static bool decelerate(double m_s2, int milliseconds, double sign)
{
    bool lit = state.lit;
    for (int n = 0; n < milliseconds; n++) {
        speed_mrad_s -= m_s2 / (config.vehicle.wheel_radius_um * 1e-6);
        lit = stop_lamp_step(&state, &config, (int32_t)lround(sign * speed_mrad_s), 0);
    }
    return lit;
}

void test_any_braking_demand_lights_the_lamp_at_once(void)
{
    TEST_ASSERT_FALSE(stop_lamp_step(&state, &config, 0, 0));
    TEST_ASSERT_TRUE(stop_lamp_step(&state, &config, 0, 1));
    TEST_ASSERT_FALSE(stop_lamp_step(&state, &config, 0, 0));
}

/* One second is fifteen time constants of the filters: they have settled to 1e-6. */
void test_deceleration_beyond_1300_mm_s2_lights_the_lamp_without_a_pedal(void)
{
    TEST_ASSERT_FALSE(decelerate(1.29, 1000, 1.0));
    TEST_ASSERT_TRUE(decelerate(1.31, 1000, 1.0));
}

void test_once_lit_the_lamp_stays_until_deceleration_falls_below_700_mm_s2(void)
{
    TEST_ASSERT_TRUE(decelerate(2.0, 500, 1.0));
    TEST_ASSERT_TRUE(decelerate(1.0, 1000, 1.0));
    TEST_ASSERT_TRUE(decelerate(0.71, 1000, 1.0));
    TEST_ASSERT_FALSE(decelerate(0.69, 1000, 1.0));
    TEST_ASSERT_FALSE(decelerate(1.0, 1000, 1.0));
}

void test_twice_the_threshold_lights_the_lamp_in_about_a_tenth_of_a_second(void)
{
    /* Two low-passes of 64 ms in a row reach half of a step after 1.678 time constants: 107 ms. */
    TEST_ASSERT_FALSE(decelerate(2.6, 95, 1.0));
    TEST_ASSERT_TRUE(decelerate(2.6, 25, 1.0));
}

void test_rolling_backwards_counts_the_same(void)
{
    TEST_ASSERT_FALSE(decelerate(1.29, 1000, -1.0));
    TEST_ASSERT_TRUE(decelerate(1.31, 1000, -1.0));
    TEST_ASSERT_FALSE(decelerate(0.69, 1000, -1.0));
}

void test_speeding_up_and_cruising_leave_the_lamp_dark(void)
{
    TEST_ASSERT_FALSE(decelerate(-3.0, 1000, 1.0));
    TEST_ASSERT_FALSE(decelerate(0.0, 1000, 1.0));
}

void test_waking_up_at_speed_is_no_deceleration(void)
{
    TEST_ASSERT_FALSE(stop_lamp_step(&state, &config, 60000, 0));
    TEST_ASSERT_FALSE(decelerate(0.0, 500, 1.0));
}

void test_the_ripple_of_one_wheel_at_constant_speed_does_not_flash_the_lamp(void)
{
    /* 1 % of 60 rad/s at 30 Hz: the wheel's rim swings by 28 m/s^2. Two low-passes of 64 ms (2.5
     * Hz) leave 0.7 % of it, 0.2 m/s^2. */
    for (int n = 0; n < 2000; n++) {
        const double ripple = 600.0 * sin(2.0 * 3.14159265358979323846 * 30.0 * n * 1e-3);
        TEST_ASSERT_FALSE(stop_lamp_step(&state, &config, (int32_t)lround(60000.0 + ripple), 0));
    }
}

void test_speeds_no_wheel_has_do_no_harm(void)
{
    for (int n = 0; n < 100; n++) {
        stop_lamp_step(&state, &config, n % 2 == 0 ? INT32_MAX : INT32_MIN, 0);
        stop_lamp_step(&state, &config, 0, 0);
    }
    TEST_ASSERT_FALSE(decelerate(0.0, 60000, 1.0));
}

/* SPDX-License-Identifier: Apache-2.0 */
#include <math.h>

#include "paper_vehicle.h"
#include "random_values.h"
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

/* Decelerates uniformly without a braking demand; returns whether the lamp is lit at the end. */
static bool decelerate(double m_s2, int milliseconds, double sign)
{
    bool lit = state.lit;
    for (int n = 0; n < milliseconds; n++) {
        speed_mrad_s -= m_s2 / (config.vehicle.wheel_radius_um * 1e-6);
        lit = stop_lamp_step(&state, &config, (int32_t)lround(sign * speed_mrad_s), 0);
    }
    return lit;
}

void test_any_braking_demand_lights_the_lamp_in_the_same_step(void)
{
    TEST_ASSERT_FALSE(stop_lamp_step(&state, &config, 0, 0));
    TEST_ASSERT_TRUE(stop_lamp_step(&state, &config, 0, 1));
}

/* Eight times 2^6 ms after the last demand; in proportion to the configured filter. */
void test_lamp_stays_lit_for_the_least_time_after_a_demand(void)
{
    for (int32_t log2 = 0; log2 <= 10; log2 += 2) {
        config.brake.stop_lamp_filter_log2 = log2;
        stop_lamp_init(&state);
        stop_lamp_step(&state, &config, 0, 1);
        for (int n = 1; n < 8 << log2; n++) {
            TEST_ASSERT_TRUE(stop_lamp_step(&state, &config, 0, 0));
        }
        TEST_ASSERT_FALSE(stop_lamp_step(&state, &config, 0, 0));
    }
}

/* 0 and 0.2 N m in any order, once a demand of CAN or more rarely: at most one change in the least
 * time, 512 ms, and none where the noise comes more often. */
void test_a_noisy_pedal_at_its_dead_band_does_not_make_the_lamp_flicker(void)
{
    random_t random = random_seeded(3);
    for (int32_t every_ms = 5; every_ms < 2000; every_ms = every_ms * 3 / 2) {
        stop_lamp_init(&state);
        int changes = 0;
        bool before = false;
        int32_t demand_mNm = 0;
        for (int n = 0; n < 30000; n++) {
            if (n % every_ms == 0) {
                demand_mNm = random_chance(&random, 0.5) ? 200 : 0;
            }
            const bool lit = stop_lamp_step(&state, &config, 0, demand_mNm);
            changes += lit != before ? 1 : 0;
            before = lit;
        }
        TEST_ASSERT_LESS_OR_EQUAL_INT(30000 / 512 + 1, changes);
        if (every_ms <= 20) { /* 25 zeros in a row have a chance of 3e-8 */
            TEST_ASSERT_LESS_OR_EQUAL_INT(1, changes);
        }
    }
}

/* One second is fifteen time constants: the filters have settled to 1e-6. */
void test_deceleration_above_1300_mm_s2_lights_the_lamp_without_a_demand(void)
{
    TEST_ASSERT_FALSE(decelerate(1.29, 1000, 1.0));
    TEST_ASSERT_TRUE(decelerate(1.31, 1000, 1.0));
}

void test_lamp_stays_lit_until_deceleration_falls_below_700_mm_s2(void)
{
    TEST_ASSERT_TRUE(decelerate(2.0, 500, 1.0));
    TEST_ASSERT_TRUE(decelerate(1.0, 1000, 1.0));
    TEST_ASSERT_TRUE(decelerate(0.71, 1000, 1.0));
    TEST_ASSERT_FALSE(decelerate(0.69, 1000, 1.0));
    TEST_ASSERT_FALSE(decelerate(1.0, 1000, 1.0));
}

void test_lamp_thresholds_are_the_configured_ones(void)
{
    config.brake.stop_lamp_on_mm_s2 = 2500;
    config.brake.stop_lamp_off_mm_s2 = 2000;
    TEST_ASSERT_FALSE(decelerate(2.49, 1000, 1.0));
    TEST_ASSERT_TRUE(decelerate(2.51, 1000, 1.0));
    TEST_ASSERT_TRUE(decelerate(2.01, 1000, 1.0));
    TEST_ASSERT_FALSE(decelerate(1.99, 1000, 1.0));
}

void test_lamp_filter_has_the_configured_time_constant(void)
{
    /* Half of a step after 1.678 time constants: of 256 ms 430 ms, of 1 ms two steps. */
    config.brake.stop_lamp_filter_log2 = 8;
    TEST_ASSERT_FALSE(decelerate(2.6, 410, 1.0));
    TEST_ASSERT_TRUE(decelerate(2.6, 40, 1.0));
    config.brake.stop_lamp_filter_log2 = 0;
    stop_lamp_init(&state);
    decelerate(0.0, 1, 1.0);
    TEST_ASSERT_TRUE(decelerate(2.6, 2, 1.0));
}

void test_twice_the_threshold_lights_the_lamp_after_about_107_ms(void)
{
    /* The step response of two low-passes of 64 ms in series is one half after 1.678 time
     * constants, 107 ms. */
    TEST_ASSERT_FALSE(decelerate(2.6, 95, 1.0));
    TEST_ASSERT_TRUE(decelerate(2.6, 25, 1.0));
}

void test_lamp_is_symmetric_in_the_direction_of_rotation(void)
{
    TEST_ASSERT_FALSE(decelerate(1.29, 1000, -1.0));
    TEST_ASSERT_TRUE(decelerate(1.31, 1000, -1.0));
    TEST_ASSERT_FALSE(decelerate(0.69, 1000, -1.0));
}

void test_lamp_is_dark_at_constant_speed_and_while_accelerating(void)
{
    TEST_ASSERT_FALSE(decelerate(-3.0, 1000, 1.0));
    TEST_ASSERT_FALSE(decelerate(0.0, 1000, 1.0));
}

void test_first_step_at_speed_is_no_deceleration(void)
{
    TEST_ASSERT_FALSE(stop_lamp_step(&state, &config, 60000, 0));
    TEST_ASSERT_FALSE(decelerate(0.0, 500, 1.0));
}

void test_speed_ripple_at_constant_speed_does_not_light_the_lamp(void)
{
    /* 1 % of 60 rad/s at 30 Hz: 28 m/s^2 at the wheel's rim. Two low-passes of 64 ms (2.5 Hz)
     * leave 0.7 %, 0.2 m/s^2. */
    for (int n = 0; n < 2000; n++) {
        const double ripple = 600.0 * sin(2.0 * 3.14159265358979323846 * 30.0 * n * 1e-3);
        TEST_ASSERT_FALSE(stop_lamp_step(&state, &config, (int32_t)lround(60000.0 + ripple), 0));
    }
}

void test_lamp_is_dark_after_speeds_beyond_any_range(void)
{
    for (int n = 0; n < 100; n++) {
        stop_lamp_step(&state, &config, n % 2 == 0 ? INT32_MAX : INT32_MIN, 0);
        stop_lamp_step(&state, &config, 0, 0);
    }
    TEST_ASSERT_FALSE(decelerate(0.0, 60000, 1.0));
}

/* ---- whole numbers, without filters ---- */

/* A step from this speed to standstill; mm/s^2, of a wheel of 0.256 m. */
static int32_t deceleration_from(int32_t mrad_s)
{
    config.brake.stop_lamp_filter_log2 = 0;
    config.vehicle.wheel_radius_um = 256000;
    stop_lamp_init(&state);
    (void)stop_lamp_step(&state, &config, mrad_s, 0);
    (void)stop_lamp_step(&state, &config, 0, 0);
    return state.decel_lp_mm_s2.accumulator;
}

/* 1/1000 is 16777/2^24 less 1.3e-5 of itself. 1 km/s^2 is the end of the range, whatever the
 * speed. */
void test_deceleration_is_that_of_the_wheel_s_rim_up_to_a_kilometre_per_second_squared(void)
{
    TEST_ASSERT_INT32_WITHIN(1, 256, deceleration_from(1));
    TEST_ASSERT_INT32_WITHIN(15, 768000, deceleration_from(3000));
    TEST_ASSERT_INT32_WITHIN(15, 768000, deceleration_from(-3000));
    TEST_ASSERT_EQUAL_INT32(1000000, deceleration_from(3907));
    TEST_ASSERT_EQUAL_INT32(1000000, deceleration_from(INT32_MAX));
    TEST_ASSERT_EQUAL_INT32(1000000, deceleration_from(INT32_MIN));
}

/* 8 mrad/s in a step are 2.048 m/s^2, 2047 in whole mm/s^2. */
void test_the_thresholds_of_the_lamp_are_exact(void)
{
    config.brake.stop_lamp_off_mm_s2 = 0;
    for (int32_t on_mm_s2 = 2046; on_mm_s2 <= 2047; on_mm_s2++) {
        config.brake.stop_lamp_on_mm_s2 = on_mm_s2;
        TEST_ASSERT_EQUAL_INT32(2047, deceleration_from(8));
        TEST_ASSERT_EQUAL_INT(on_mm_s2 == 2046, state.lit);
    }
    config.brake.stop_lamp_on_mm_s2 = 20000;
    for (int32_t off_mm_s2 = 2047; off_mm_s2 <= 2048; off_mm_s2++) {
        config.brake.stop_lamp_off_mm_s2 = off_mm_s2;
        stop_lamp_init(&state);
        TEST_ASSERT_TRUE(stop_lamp_step(&state, &config, 8, 1));
        state.quiet_ms = 7; /* of 8 */
        TEST_ASSERT_EQUAL_INT(off_mm_s2 == 2047, stop_lamp_step(&state, &config, 0, 0));
    }
}

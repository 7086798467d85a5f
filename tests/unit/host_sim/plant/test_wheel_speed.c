/* SPDX-License-Identifier: Apache-2.0 */
/* Toothed ring: speed from pulse times with the resolution of the clock, zero without pulses. */
#include "plant/wheel_speed.h"

#include <math.h>

#include "unity.h"

static const double STEP_S = 1e-3;
static const double TWO_PI = 6.283185307179586;

static wheel_speed_params_t params;
static wheel_speed_t ring;
static double time_s;

void setUp(void)
{
    const wheel_speed_params_t teeth = {.teeth = 48.0, .clock_s = 1e-5, .lowest_rad_per_s = 2.0};
    const wheel_speed_t standing = {.speed_rad_s = 0.0};
    params = teeth;
    ring = standing;
    time_s = 0.0;
}

void tearDown(void) {}

static double look(double speed_rad_s)
{
    time_s += STEP_S;
    return wheel_speed_step(&params, &ring, speed_rad_s * STEP_S, speed_rad_s, time_s, STEP_S,
                            false);
}

static double after(double speed_rad_s, double duration_s)
{
    double seen = 0.0;
    for (int k = 0; k < (int)lround(duration_s / STEP_S); k++) {
        seen = look(speed_rad_s);
    }
    return seen;
}

void test_constant_speed_is_measured_with_clock_resolution_in_both_directions(void)
{
    const double speeds[] = {3.0, 17.0, 44.4, -44.4, 300.0};
    for (int n = 0; n < 5; n++) {
        setUp();
        after(speeds[n], 0.5);
        /* One clock step of error in the time of the teeth since the last reading, at least one
         * tooth. */
        const double pitch_s = TWO_PI / 48.0 / fabs(speeds[n]);
        const double between_s = fmax(pitch_s, STEP_S - pitch_s);
        for (int k = 0; k < 500; k++) {
            TEST_ASSERT_DOUBLE_WITHIN(1.01 * fabs(speeds[n]) * 1e-5 / (between_s - 1e-5),
                                      fabs(speeds[n]), look(speeds[n]));
        }
    }
}

void test_with_an_unquantised_clock_the_speed_is_exact(void)
{
    params.clock_s = 0.0;
    after(30.0, 0.1);
    for (int k = 0; k < 100; k++) {
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, 30.0, look(30.0));
    }
}

void test_speed_needs_two_edges_and_is_delayed_by_one_tooth(void)
{
    const double pitch_s = TWO_PI / 48.0 / 10.0; /* 13.1 ms */
    TEST_ASSERT_EQUAL_DOUBLE(0.0, after(10.0, pitch_s));
    TEST_ASSERT_EQUAL_DOUBLE(0.0, after(10.0, 0.8 * pitch_s));
    TEST_ASSERT_DOUBLE_WITHIN(0.02, 10.0, after(10.0, 0.4 * pitch_s));
}

void test_after_a_stop_the_reported_speed_decays_to_zero(void)
{
    after(30.0, 0.2);
    double last = 31.0;
    int shown = 0;
    for (int k = 1; k <= 200; k++) {
        const double seen = look(0.0);
        TEST_ASSERT_TRUE(seen <= last);
        /* The last edge is at most a tooth's time before the stop. */
        TEST_ASSERT_TRUE(seen <= TWO_PI / 48.0 / (k * STEP_S) + 1e-9);
        last = seen;
        shown += seen > 0.0 ? 1 : 0;
    }
    TEST_ASSERT_EQUAL_DOUBLE(0.0, last);
    /* 2 rad/s are reached when a tooth of 131 mrad has taken 65 ms. */
    TEST_ASSERT_INT_WITHIN(6, 63, shown);
}

void test_reading_is_zero_below_the_lowest_speed(void)
{
    TEST_ASSERT_EQUAL_DOUBLE(0.0, after(1.9, 2.0));
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 2.1, after(2.1, 2.0));
}

void test_failed_sensor_reads_zero_and_restarts_after_recovery(void)
{
    after(30.0, 0.2);
    time_s += STEP_S;
    TEST_ASSERT_EQUAL_DOUBLE(0.0,
                             wheel_speed_step(&params, &ring, 0.03, 30.0, time_s, STEP_S, true));
    params.dead = 1.0;
    TEST_ASSERT_EQUAL_DOUBLE(0.0, look(30.0));
    params.dead = 0.0;
    TEST_ASSERT_EQUAL_DOUBLE(0.0, look(30.0));
    TEST_ASSERT_DOUBLE_WITHIN(0.1, 30.0, after(30.0, 0.02));
}

void test_without_teeth_the_reading_is_the_true_speed(void)
{
    params.teeth = 0.0;
    TEST_ASSERT_EQUAL_DOUBLE(12.345, look(-12.345));
}

/* SPDX-License-Identifier: Apache-2.0 */
/* The tracking loop: zero steady-state error at constant speed, bandwidth as designed. */
#include <math.h>

#include "angle_tracker.h"
#include "core/angle.h"
#include "tracker_config.h"
#include "unity.h"

static config_t config;
static const angle_tracker_t FRESH;
static angle_tracker_t tracker;

void setUp(void)
{
    config = tracker_config();
    tracker = FRESH;
}

void tearDown(void) {}

/* The angle that is tracked after one more look. */
static uint16_t step(double turns)
{
    angle_tracker_step(&tracker, &config, (uint16_t)((int64_t)floor(turns * 65536.0) & 0xFFFF));
    return (uint16_t)(tracker.theta_q32 >> 16);
}

void test_steady_state_error_is_zero_at_constant_speed(void)
{
    static const double SPEEDS[] = {0.0001, 0.002, 0.0123, 0.05, -0.0123, -0.05};
    for (int s = 0; s < 6; s++) {
        tracker = FRESH;
        double turns = 0.0;
        int64_t sum = 0;
        uint16_t theta_turn = step(turns);
        for (int n = 0; n < 12000; n++) {
            turns += SPEEDS[s];
            theta_turn = step(turns);
            if (n >= 10000) {
                const int32_t error = angle_difference(
                    theta_turn, (uint16_t)((int64_t)floor(turns * 65536.0) & 0xFFFF));
                TEST_ASSERT_INT32_WITHIN(2, 0, error);
                sum += error;
            }
        }
        TEST_ASSERT_DOUBLE_WITHIN(1.0, 0.0, (double)sum / 2000.0);
        /* Input steps of 1/65 536 turn, seen through a bandwidth of 50 Hz: 5e-3 LSB of angle a
         * period are 8e-8 turns. */
        TEST_ASSERT_DOUBLE_WITHIN(4e-7, SPEEDS[s], tracker.speed_q32 / 4294967296.0);
    }
}

/* With e the angle error after the correction, the loop is z^2 - (2 - kp - ki) z + (1 - kp) = 0.
 * Double-precision twin. */
void test_step_response_of_the_angle_is_the_designed_one(void)
{
    const double kp = config.rotor.pll_proportional_q16 / 65536.0;
    const double ki = config.rotor.pll_integral_q24 / 16777216.0;
    double theta = 0.0;
    double speed = 0.0;
    step(0.0);
    for (int n = 0; n < 2000; n++) {
        theta += speed;
        const double error = 0.05 - theta;
        theta += kp * error;
        speed += ki * error;
        const uint16_t theta_turn = step(0.05);
        TEST_ASSERT_DOUBLE_WITHIN(4.0 / 65536.0, theta, angle_difference(theta_turn, 0) / 65536.0);
    }
}

void test_the_bandwidth_is_the_designed_one(void)
{
    /* (2 w s + w^2)/(s + w)^2 at s = j w passes sqrt 5 / 2 = 1.118 of the amplitude; at 10 w, 0.2.
     */
    static const double FREQUENCY_HZ[] = {5.0, 50.0, 500.0};
    static const double GAIN[] = {1.0098, 1.1180,
                                  0.1985}; /* |1 + 2jx| / (1 + x^2), x = 0.1, 1, 10 */
    for (int f = 0; f < 3; f++) {
        tracker = FRESH;
        double cosine = 0.0;
        double sine = 0.0;
        const int periods = 20000 * 2;
        for (int n = 0; n < 2 * periods; n++) {
            const double phase = 2.0 * PI * FREQUENCY_HZ[f] * n / 20000.0;
            const uint16_t theta_turn = step(0.5 + 0.02 * sin(phase));
            const double followed = angle_difference(theta_turn, 32768) / 65536.0;
            if (n >= periods) {
                sine += followed * sin(phase) * 2.0 / periods;
                cosine += followed * cos(phase) * 2.0 / periods;
            }
        }
        /* 10 %: at 500 Hz the samples are no longer close to continuous. */
        TEST_ASSERT_DOUBLE_WITHIN(0.1 * GAIN[f], GAIN[f], hypot(sine, cosine) / 0.02);
    }
}

void test_loop_is_stable_at_the_largest_valid_gains(void)
{
    config.rotor.pll_proportional_q16 = 65536;
    config.rotor.pll_integral_q24 = 16777216;
    tracker = FRESH;
    step(0.0);
    uint16_t theta_turn = 0;
    for (int n = 0; n < 100; n++) {
        theta_turn = step(0.3);
    }
    TEST_ASSERT_INT32_WITHIN(2, (int32_t)(0.3 * 65536.0), theta_turn);
}

void test_half_a_turn_of_error_in_every_period_does_not_overflow(void)
{
    config.rotor.pll_proportional_q16 = 65536;
    config.rotor.pll_integral_q24 = 16777216;
    tracker = FRESH;
    for (int n = 0; n < 1000; n++) {
        step(n % 3 == 0 ? 0.5 : 0.0);
    }
    step(0.0);
    TEST_ASSERT_TRUE(tracker.started);
}

void test_speed_saturates_and_the_angle_wraps(void)
{
    for (int32_t sign = -1; sign <= 1; sign += 2) {
        tracker.started = true;
        tracker.theta_q32 = 0;
        tracker.speed_q32 = sign > 0 ? 1 << 30 : -(1 << 30);
        config.rotor.pll_proportional_q16 = 65536;
        config.rotor.pll_integral_q24 = 1 << 24;
        const uint16_t angle = (uint16_t)(sign * (16384 + 32000));
        angle_tracker_step(&tracker, &config, angle);
        TEST_ASSERT_EQUAL_INT32(sign > 0 ? INT32_MAX : INT32_MIN, tracker.speed_q32);
        TEST_ASSERT_EQUAL_HEX32((uint32_t)angle << 16, tracker.theta_q32);
    }
}

/* The largest error, half a turn backward, times the largest gain. */
void test_largest_correction_is_half_a_turn(void)
{
    tracker.started = true;
    config.rotor.pll_proportional_q16 = 65536;
    angle_tracker_step(&tracker, &config, 32768);
    TEST_ASSERT_EQUAL_HEX32(UINT32_C(1) << 31, tracker.theta_q32);
}

/* SPDX-License-Identifier: Apache-2.0 */
/* An absolute angle whose sensor jumps, stands, turns round or starts at speed. */
#include "absolute_angle.h"

#include <math.h>

#include "core/angle.h"
#include "unity.h"

extern const config_t CONFIG_LU2013;

static const double PI = 3.14159265358979323846;
static const double TURNS_A_PERIOD = 0.01;

static config_t config;
static absolute_angle_t angle;
static double rotor_turns;

static uint16_t reading(double turns)
{
    return (uint16_t)((int64_t)floor(turns * 65536.0) & 0xFFFF);
}

/* The rotor goes on; the sensor shows it with an offset. */
static void step(double offset_deg)
{
    rotor_turns += TURNS_A_PERIOD;
    absolute_angle_step(&angle, &config, reading(rotor_turns + offset_deg / 360.0));
}

static double error_deg(void)
{
    const uint16_t tracked = (uint16_t)(angle.tracker.theta_q32 >> 16);
    return angle_difference(tracked, reading(rotor_turns)) * 360.0 / 65536.0;
}

/* Critically damped at 50 Hz: 2 w T and (w T)^2. 3000 periods at one speed: settled. */
void setUp(void)
{
    config = CONFIG_LU2013;
    const double w_T = 2.0 * PI * 50.0 / 20000.0;
    config.rotor.pll_proportional_q16 = (int32_t)lround(2.0 * w_T * 65536.0);
    config.rotor.pll_integral_q24 = (int32_t)lround(w_T * w_T * 16777216.0);
    absolute_angle_init(&angle);
    rotor_turns = 0.3;
    for (int n = 0; n < 3000; n++) {
        step(0.0);
    }
}

void tearDown(void) {}

/* From 45 degrees on; 44 degrees move the angle by 2 w T of them. */
void test_wrong_samples_do_not_move_the_angle(void)
{
    static const double JUMPS_DEG[] = {46.0, -46.0, 90.0, -120.0, 179.0};
    for (int j = 0; j < 5; j++) {
        for (int n = 0; n < ABSOLUTE_ANGLE_APART; n++) {
            step(JUMPS_DEG[j]);
            TEST_ASSERT_DOUBLE_WITHIN(0.05, 0.0, error_deg());
        }
        for (int n = 0; n < ABSOLUTE_ANGLE_APART; n++) {
            step(0.0);
            TEST_ASSERT_EQUAL_UINT8(ABSOLUTE_ANGLE_APART - 1 - n, angle.apart);
        }
        TEST_ASSERT_TRUE(angle.valid);
        TEST_ASSERT_EQUAL_UINT16(0, angle.faults);
    }
    step(44.0);
    TEST_ASSERT_DOUBLE_WITHIN(0.05, 44.0 * 2.0 * 2.0 * PI * 50.0 / 20000.0, error_deg());
}

/* Displaced for good: invalid and counted with the 33rd sample, followed with the 96th, and with
 * the 255 that agree with each other from there on valid again, displaced. */
void test_a_displaced_sensor_is_invalid_until_its_samples_agree_with_each_other(void)
{
    for (int n = 1; n < ABSOLUTE_ANGLE_GIVEN_UP; n++) {
        step(90.0);
        TEST_ASSERT_EQUAL_INT(n <= ABSOLUTE_ANGLE_APART, angle.valid);
        TEST_ASSERT_EQUAL_UINT16(n <= ABSOLUTE_ANGLE_APART ? 0 : 1, angle.faults);
        TEST_ASSERT_DOUBLE_WITHIN(0.05, 0.0, error_deg());
    }
    for (int n = 0; n <= ABSOLUTE_ANGLE_SETTLED; n++) {
        TEST_ASSERT_FALSE(angle.valid);
        step(90.0);
    }
    TEST_ASSERT_DOUBLE_WITHIN(0.5, 90.0, error_deg());
    TEST_ASSERT_TRUE(angle.valid);
    TEST_ASSERT_EQUAL_UINT16(1, angle.faults);
}

/* Wrong for 40 samples, then right again: valid after as many right ones. */
void test_a_sensor_that_comes_back_is_valid_after_as_many_samples(void)
{
    for (int n = 0; n < 40; n++) {
        step(90.0);
    }
    for (int n = 0; n < 40; n++) {
        TEST_ASSERT_FALSE(angle.valid);
        step(0.0);
        TEST_ASSERT_DOUBLE_WITHIN(0.05, 0.0, error_deg());
    }
    TEST_ASSERT_TRUE(angle.valid);
    TEST_ASSERT_EQUAL_UINT16(1, angle.faults);
}

/* 3.6 degrees a period: the sensor is within 45 degrees of the rotor for a quarter of the time, so
 * that the count grows by one in two periods: invalid after 64 and what the loop follows of it. At
 * 1/18 turn a period, the fastest motor here, likewise. */
void test_a_frozen_sensor_is_invalid_within_90_periods(void)
{
    static const double SPEEDS[] = {0.01, -0.01, 1.0 / 18.0};
    for (int s = 0; s < 3; s++) {
        absolute_angle_init(&angle);
        for (int n = 0; n < 4000; n++) {
            rotor_turns += SPEEDS[s];
            absolute_angle_step(&angle, &config, reading(rotor_turns));
        }
        const uint16_t stands = reading(rotor_turns);
        int n = 0;
        while (angle.valid && n < 1000) {
            absolute_angle_step(&angle, &config, stands);
            n++;
        }
        TEST_ASSERT_TRUE(n > ABSOLUTE_ANGLE_APART && n <= 90);
        TEST_ASSERT_EQUAL_UINT16(1, angle.faults);
    }
}

/* A controller that starts on a rolling wheel: 1/16 turn a period, the largest speed there is. */
void test_a_start_at_any_speed_skips_no_sample(void)
{
    static const double SPEEDS[] = {0.0, 0.01, 0.03, 0.0625, -0.0625};
    for (int s = 0; s < 5; s++) {
        absolute_angle_init(&angle);
        rotor_turns = 0.1;
        for (int n = 0; n < 4000; n++) {
            rotor_turns += SPEEDS[s];
            absolute_angle_step(&angle, &config, reading(rotor_turns));
            TEST_ASSERT_TRUE(angle.valid);
        }
        TEST_ASSERT_EQUAL_UINT16(0, angle.faults);
        TEST_ASSERT_DOUBLE_WITHIN(0.05, 0.0, error_deg());
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, SPEEDS[s], angle.tracker.speed_q32 / 4294967296.0);
    }
}

/* 23 000 rad/s^2 electrical, 100 N m at 0.1 kg m^2 and 23 pole pairs, from 3.6 degrees a period to
 * the same speed backwards: a/(2 pi 50 Hz)^2 = 13.4 degrees behind. */
void test_the_hardest_stop_of_a_wheel_is_followed(void)
{
    double speed = TURNS_A_PERIOD;
    const double change = 23000.0 / (2.0 * PI) / 20000.0 / 20000.0;
    double most_deg = 0.0;
    while (speed > -TURNS_A_PERIOD) {
        speed -= change;
        rotor_turns += speed;
        absolute_angle_step(&angle, &config, reading(rotor_turns));
        most_deg = fmax(most_deg, fabs(error_deg()));
        TEST_ASSERT_EQUAL_UINT8(0, angle.apart);
    }
    TEST_ASSERT_TRUE(angle.valid);
    TEST_ASSERT_DOUBLE_WITHIN(0.7, 13.4, most_deg);
}

/* Of a rotor that has stood at zero. */
static uint8_t apart_at(int32_t angle_turn)
{
    absolute_angle_init(&angle);
    for (int n = 0; n <= ABSOLUTE_ANGLE_SETTLED; n++) {
        absolute_angle_step(&angle, &config, 0);
    }
    absolute_angle_step(&angle, &config, (uint16_t)angle_turn);
    return angle.apart;
}

void test_sample_of_exactly_an_eighth_turn_from_its_prediction_is_used(void)
{
    for (int32_t sign = -1; sign <= 1; sign += 2) {
        TEST_ASSERT_EQUAL_UINT8(0, apart_at(sign * 8192));
        TEST_ASSERT_EQUAL_UINT8(1, apart_at(sign * 8193));
    }
}

void test_sensor_taken_as_it_is_has_no_wrong_samples_counted(void)
{
    for (int n = 1; n < ABSOLUTE_ANGLE_GIVEN_UP; n++) {
        step(90.0);
        TEST_ASSERT_EQUAL_UINT8(n, angle.apart);
    }
    step(90.0);
    TEST_ASSERT_EQUAL_UINT8(0, angle.apart);
}

/* SPDX-License-Identifier: Apache-2.0 */
/* A rotor sensor that stops faster than a tyre slows its wheel: from which speed it is sudden, how
 * often, and what it is not. The vehicle is chosen so that its figures are whole numbers: 10 pole
 * pairs; tyre grip slows the wheel by 100 mrad/s in a step, coasting by 1. */
#include <math.h>

#include "monitor/monitor_speed.h"
#include "monitor_case.h"
#include "paper_vehicle.h"
#include "unity.h"

enum { COASTING_urad_s = 1000, HAND_OVER_mrad_s = 2000 };

static config_t config;
static monitor_speed_state_t state;
static monitor_case_t in;

void setUp(void)
{
    const monitor_speed_state_t initial = {.windows = 0};
    const monitor_case_t rest = {.report = {.offsets_done = true, .bridge = BRIDGE_PWM},
                                 .now = {.angle_valid = true, .bus_voltage_mV = 40000}};
    config = paper_vehicle();
    config.rotor.sensor = CONFIG_ROTOR_ENCODER;
    config.monitor.tyre_grip_mm_s2 = 9800;
    config.monitor.coasting_mm_s2 = 98;
    config.vehicle.wheel_radius_um = 98000;
    config.brake.blend_out_end_mrad_s = HAND_OVER_mrad_s;
    config.motor.pole_pairs = 10;
    state = initial;
    in = rest;
}

void tearDown(void) {}

static void ride(int milliseconds, int32_t mrad_s)
{
    in.now.speed_mrad_s = mrad_s;
    for (int n = 0; n < milliseconds; n++) {
        (void)monitor_speed_step(&state, &config, measured_of(&in));
    }
}

void test_a_sensor_stops_when_it_falls_by_more_than_grip_and_the_hand_over_speed(void)
{
    ride(10, 44000);
    ride(1, 44000 - 100 - HAND_OVER_mrad_s);
    TEST_ASSERT_FALSE(state.stopped);
    TEST_ASSERT_EQUAL_UINT16(0, state.sudden_stops);
    setUp();
    ride(10, 44000); /* the speed falls to less than movement, which would count at once */
    ride(1, 44000 - 100 - HAND_OVER_mrad_s - 1);
    TEST_ASSERT_TRUE(state.stopped);
    setUp();
    ride(100, 44000);
    ride(1, 0);
    TEST_ASSERT_TRUE(state.stopped);
    TEST_ASSERT_EQUAL_UINT16(1, state.sudden_stops);
}

void test_every_sudden_stop_is_counted_once(void)
{
    for (uint16_t stops = 1; stops <= 3; stops++) {
        ride(100, 44000); /* at least rest's speed: counts again at once */
        TEST_ASSERT_FALSE(state.stopped);
        ride(50, 0);
        TEST_ASSERT_TRUE(state.stopped);
        TEST_ASSERT_EQUAL_UINT16(stops, state.sudden_stops);
    }
}

/* After a start at speed the angle is still being acquired: a tracker passes the speed and returns.
 * Rest does not follow it, but no sensor is wrong. */
void test_a_sensor_that_has_moved_for_less_than_100_ms_does_not_stop_suddenly(void)
{
    for (int moving_ms = 99; moving_ms <= 100; moving_ms++) {
        setUp();
        ride(1, HAND_OVER_mrad_s); /* no movement */
        ride(moving_ms, 44000);
        ride(1, 0);
        TEST_ASSERT_TRUE(state.stopped);
        TEST_ASSERT_EQUAL_UINT16(moving_ms == 100, state.sudden_stops);
    }
}

/* Braked by a, halls that have passed their last edge at sqrt(2 a s), a sector s before standstill,
 * show the mean of the turn before it, (sqrt(14 a s) + sqrt(2 a s))/2, until the wheel stands: with
 * a = 100 rad/s^2 and s = 2 pi/60 that is 8.34 rad/s. */
void test_halls_that_stop_within_a_sector_are_not_sudden(void)
{
    const double a_s = 100.0 * 6.283185307 / 60.0;
    const int32_t shown_mrad_s = (int32_t)(500.0 * (sqrt(14.0 * a_s) + sqrt(2.0 * a_s)));
    const int32_t most_mrad_s = (int32_t)(1000.0 * sqrt(7.0 * a_s));
    TEST_ASSERT_TRUE(shown_mrad_s > 4 * HAND_OVER_mrad_s && shown_mrad_s < most_mrad_s);
    for (int32_t beyond_mrad_s = 0; beyond_mrad_s <= 5; beyond_mrad_s += 5) {
        setUp();
        config.rotor.sensor = CONFIG_ROTOR_HALL;
        ride(100, most_mrad_s - 2 + beyond_mrad_s);
        ride(1, 0);
        TEST_ASSERT_TRUE(state.stopped);
        TEST_ASSERT_EQUAL_UINT16(beyond_mrad_s > 0, state.sudden_stops);
    }
}

/* p w^2 = 7 a pi/3 in whole numbers, 29 320^2 = 7330 x 117 280. */
void test_halls_stop_suddenly_from_the_square_of_their_speed_on(void)
{
    for (int32_t beyond_mrad_s = 0; beyond_mrad_s <= 1; beyond_mrad_s++) {
        setUp();
        config.rotor.sensor = CONFIG_ROTOR_HALL;
        config.motor.pole_pairs = 1;
        config.monitor.tyre_grip_mm_s2 = 11494; /* 117 280 urad/s in a step */
        ride(100, 29320 + beyond_mrad_s);
        ride(1, 0);
        TEST_ASSERT_EQUAL_UINT16(beyond_mrad_s, state.sudden_stops);
    }
}

/* A bound by the EMF may be beyond 32 bits: its lower half is no speed. */
void test_halls_stop_suddenly_from_a_speed_beyond_32_bits(void)
{
    config.rotor.sensor = CONFIG_ROTOR_HALL;
    ride(100, 44000);
    state.bound_urad_s = (INT64_C(1) << 32) * 1000;
    state.rest_urad_s = state.bound_urad_s;
    ride(1, 0);
    TEST_ASSERT_EQUAL_UINT16(1, state.sudden_stops);
}

void test_a_sensor_with_an_angle_stops_suddenly_from_four_hand_over_speeds_on(void)
{
    for (int32_t beyond_mrad_s = 0; beyond_mrad_s <= 1; beyond_mrad_s++) {
        setUp();
        ride(100, 4 * HAND_OVER_mrad_s + beyond_mrad_s);
        ride(1, 0);
        TEST_ASSERT_EQUAL_UINT16(beyond_mrad_s, state.sudden_stops);
    }
}

/* Its square does not fit: beyond 1000 rad/s no halls stop within a sector. */
void test_the_largest_speed_of_halls_stops_suddenly(void)
{
    config.rotor.sensor = CONFIG_ROTOR_HALL;
    config.motor.pole_pairs = 60;
    ride(100, INT32_MAX);
    ride(1, 0);
    TEST_ASSERT_EQUAL_UINT16(1, state.sudden_stops);
}

void test_an_invalid_sensor_does_not_stop(void)
{
    ride(10, 44000);
    in.now.angle_valid = false;
    ride(100, 0);
    TEST_ASSERT_FALSE(state.stopped);
    TEST_ASSERT_EQUAL_UINT16(0, state.sudden_stops);
}

/* Rest falls by 1 mrad/s in a step and meets a sensor that shows the speed that it will have. A
 * sensor that counts again lowers it as fast as grip permits. */
void test_a_stopped_sensor_that_shows_the_speed_of_rest_counts_again(void)
{
    ride(10, 44000);
    ride(99, 0);
    TEST_ASSERT_EQUAL_INT64(44000000 - 99 * COASTING_urad_s, state.rest_urad_s);
    ride(1, 44000 - 99);
    ride(1, 44000 - 99 - 50);
    TEST_ASSERT_EQUAL_INT64(INT64_C(1000) * (44000 - 99 - 50), state.rest_urad_s);
}

void test_neither_an_invalid_sensor_nor_the_hand_over_speed_shows_movement(void)
{
    for (int valid = 0; valid < 2; valid++) {
        setUp();
        ride(10, 44000);
        ride(100, 0);
        in.now.angle_valid = valid != 0;
        ride(300, valid != 0 ? HAND_OVER_mrad_s : 2 * HAND_OVER_mrad_s);
        TEST_ASSERT_TRUE(state.stopped);
        TEST_ASSERT_EQUAL_INT64(44000000 - 400 * COASTING_urad_s, state.rest_urad_s);
    }
}

void test_movement_is_not_forgotten_after_65_s(void)
{
    ride(UINT16_MAX + 50, 44000);
    ride(1, 10000);
    TEST_ASSERT_FALSE(state.stopped);
}

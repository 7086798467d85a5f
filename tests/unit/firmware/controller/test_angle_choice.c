/* SPDX-License-Identifier: Apache-2.0 */
#include "angle_choice_rig.h"

enum { DEGREES_90 = 16384, DEGREES_60 = 10923, DEGREES_20 = 3641, DEGREES_10 = 1820 };
enum { LEAST_PU = 2048 };

void setUp(void)
{
    rig_up(&ROLLING);
}

void tearDown(void) {}

/* Steps until the observer's angle is used; -1: never within so many. */
static int steps_until_used(int most)
{
    for (int n = 1; n <= most; n++) {
        run(1);
        if (observed()) {
            return n;
        }
    }
    return -1;
}

void test_a_sensor_that_agrees_is_used(void)
{
    at.difference_turn = DEGREES_10;
    TEST_ASSERT_EQUAL_INT(-1, steps_until_used(5000));
    TEST_ASSERT_TRUE(seen.valid && !seen.sensor_wrong);
}

void test_an_opposed_sensor_is_replaced_within_5_milliseconds_forwards_and_backwards(void)
{
    for (int sign = -1; sign <= 1; sign += 2) {
        setUp();
        at.observer_mrad_s *= sign;
        run(100);
        at.difference_turn = (int16_t)(sign * DEGREES_60);
        const int steps = steps_until_used(5);
        TEST_ASSERT_TRUE(steps > 1 && steps <= 5);
        TEST_ASSERT_TRUE(seen.valid && seen.sensor_wrong);
    }
}

void test_a_slip_of_20_degrees_is_named_within_20_milliseconds(void)
{
    run(100);
    at.difference_turn = DEGREES_20;
    const int steps = steps_until_used(20);
    TEST_ASSERT_TRUE(steps > 5 && steps <= 20);
}

void test_a_single_deviation_is_not_enough(void)
{
    run(100);
    for (int n = 0; n < 200; n++) {
        at.difference_turn = n % 3 == 0 ? DEGREES_60 : 0;
        run(1);
        TEST_ASSERT_FALSE(observed());
    }
}

/* A frozen sensor agrees twice in every turn. */
void test_a_wrong_sensor_returns_only_after_long_agreement_or_an_acknowledgement(void)
{
    run(100);
    at.difference_turn = DEGREES_60;
    run(10);
    at.difference_turn = 0;
    run(CONFIG_LU2013.monitor.rotor_warning_time_ms - 1);
    TEST_ASSERT_TRUE(observed());
    run(1);
    TEST_ASSERT_FALSE(observed());
    at.difference_turn = DEGREES_60;
    run(10);
    TEST_ASSERT_TRUE(seen.sensor_wrong);
    cleared = true;
    at.switching = false;
    run(1);
    TEST_ASSERT_TRUE(seen.valid && !seen.sensor_wrong);
}

void test_an_invalid_sensor_is_replaced_at_once_if_the_observer_is_confirmed(void)
{
    run(100);
    at.sensor_valid = false;
    TEST_ASSERT_EQUAL_INT(1, steps_until_used(1));
    TEST_ASSERT_TRUE(seen.valid);
    at.sensor_valid = true;
    run(1);
    TEST_ASSERT_FALSE(observed());
}

/* Angle without torque: dead reckoning of the sensor, or the observer's where it was in use. */
void test_below_its_speed_the_observer_permits_no_torque(void)
{
    const int32_t from_mrad_s = CONFIG_LU2013.rotor.observer_speed_mrad_s;
    at.observer_mrad_s = from_mrad_s / 2 - 1;
    at.sensor_valid = false;
    run(100);
    TEST_ASSERT_FALSE(seen.valid || observed());
    at.observer_mrad_s = from_mrad_s / 2;
    run(10);
    TEST_ASSERT_TRUE(!seen.valid && observed());
    at.observer_mrad_s = -from_mrad_s;
    run(20);
    TEST_ASSERT_TRUE(seen.valid && observed());
    at.observer_mrad_s = -(from_mrad_s * 15 / 16 + 2);
    run(10);
    TEST_ASSERT_TRUE(seen.valid);
    at.observer_mrad_s = -(from_mrad_s * 15 / 16 - 2);
    run(10);
    TEST_ASSERT_TRUE(!seen.valid && observed());
}

void test_noise_is_not_confirmed(void)
{
    at.sensor_valid = false;
    at.flux_q14 = 1999; /* less than half of what turns at this speed */
    run(100);
    TEST_ASSERT_FALSE(seen.valid);
    at.flux_q14 = 4000;
    at.across_q14 = -1001;
    run(100);
    TEST_ASSERT_FALSE(seen.valid);
    at.across_q14 = 0;
    at.acquired = false;
    run(100);
    TEST_ASSERT_FALSE(seen.valid);
    at.acquired = true;
    run(2);
    TEST_ASSERT_TRUE(seen.valid);
}

/* The bridge begins to switch without a sensor: the observer's angle from the start, no torque. */
void test_a_start_without_a_sensor_uses_the_observers_angle_at_zero_torque(void)
{
    at.switching = false;
    at.acquired = false;
    at.sensor_valid = false;
    run(10);
    TEST_ASSERT_TRUE(!seen.valid && observed());
    at.switching = true;
    run(3);
    TEST_ASSERT_TRUE(!seen.valid && observed());
    at.acquired = true;
    run(2);
    TEST_ASSERT_TRUE(seen.valid);
}

void test_without_takeover_the_sensor_alone_decides(void)
{
    config.rotor.observer_takeover = 0;
    at.difference_turn = DEGREES_60;
    run(100);
    TEST_ASSERT_TRUE(seen.valid && !observed() && !seen.sensor_wrong);
    at.sensor_valid = false;
    run(100);
    TEST_ASSERT_FALSE(seen.valid || observed());
}

/* Steps from a contradiction to its name; at most 20. */
static void assert_named_within_20_milliseconds(reason_t name)
{
    int steps = 0;
    do {
        run(1);
        steps++;
    } while (seen.name == REASON_NONE && steps <= 20);
    TEST_ASSERT_EQUAL_INT(name, seen.name);
    TEST_ASSERT_TRUE(steps <= 20);
}

void test_slip_freeze_and_reversal_are_named_forwards_and_backwards(void)
{
    static const struct {
        int32_t sensor_mrad_s;
        int16_t difference_turn;
        reason_t name;
    } wrong[] = {{20000, DEGREES_20, REASON_ROTOR_SLIPPED},
                 {20000, DEGREES_60, REASON_ROTOR_SLIPPED},
                 {0, DEGREES_90, REASON_ROTOR_FROZEN},
                 {-20000, DEGREES_60, REASON_ROTOR_REVERSED}};
    for (int k = 0; k < 4; k++) {
        for (int sign = -1; sign <= 1; sign += 2) {
            setUp();
            at.observer_mrad_s *= sign;
            at.sensor_mrad_s *= sign;
            run(100);
            TEST_ASSERT_EQUAL_INT(REASON_NONE, seen.name);
            at.difference_turn = wrong[k].difference_turn;
            at.sensor_mrad_s = sign * wrong[k].sensor_mrad_s;
            assert_named_within_20_milliseconds(wrong[k].name);
            at.sensor_mrad_s = sign * 20000; /* the first name stays */
            run(100);
            TEST_ASSERT_EQUAL_INT(wrong[k].name, seen.name);
        }
    }
}

/* Below its speed the observer only takes torque away. */
void test_an_opposed_sensor_below_the_observer_s_speed_loses_its_torque(void)
{
    at.observer_mrad_s = CONFIG_LU2013.rotor.observer_speed_mrad_s * 3 / 4;
    at.sensor_mrad_s = at.observer_mrad_s;
    run(100);
    TEST_ASSERT_TRUE(seen.valid);
    at.difference_turn = DEGREES_20;
    run(1000);
    TEST_ASSERT_TRUE(seen.valid && !seen.sensor_wrong);
    at.difference_turn = DEGREES_60;
    run(11);
    TEST_ASSERT_TRUE(seen.valid);
    run(1);
    TEST_ASSERT_TRUE(!seen.valid && observed());
    at.difference_turn = 0;
    run(CONFIG_LU2013.monitor.rotor_warning_time_ms + 1);
    TEST_ASSERT_FALSE(seen.valid);
}

void test_more_flux_than_magnets_and_current_have_does_not_confirm(void)
{
    at.sensor_valid = false;
    at.flux_q14 = 4 * at.expected_q14 + 4;
    run(100);
    TEST_ASSERT_FALSE(seen.valid);
    at.flux_q14--;
    run(2);
    TEST_ASSERT_TRUE(seen.valid);
}

/* The first hall edge from standstill turns the current by 60 degrees, and the observer swings: in
 * six milliseconds beyond its speed and back, as recorded from a scooter that drives off. */
void test_an_observer_that_swings_does_not_replace_a_sensor_at_standstill(void)
{
    static const int32_t SWINGS_mrad_s[] = {489, -558, -5379, -7275, -2116, -239, 6877, 9940};
    at.sensor_mrad_s = 0;
    at.observer_mrad_s = 450;
    run(150);
    for (int n = 0; n < 8; n++) {
        at.observer_mrad_s = 2 * SWINGS_mrad_s[n];
        at.difference_turn = DEGREES_60 + 8000;
        run(1);
        TEST_ASSERT_TRUE(seen.valid && !seen.sensor_wrong && !observed());
    }
}

/* A motor of 400 V, healthy, whose torque changes where it hardly turns: for up to eight steps the
 * observer has a speed that the rotor has not (rides drawn at random). */
void test_an_observer_that_errs_for_eight_steps_takes_no_torque_away(void)
{
    config.rotor.sensor = CONFIG_ROTOR_ANGLE;
    at.observer_mrad_s = CONFIG_LU2013.rotor.observer_speed_mrad_s * 9 / 16;
    at.sensor_mrad_s = at.observer_mrad_s / 8;
    at.i_pu.q = 8000;
    run(100);
    at.difference_turn = DEGREES_60;
    run(8);
    at.difference_turn = 0;
    run(1);
    at.difference_turn = DEGREES_60;
    run(8);
    TEST_ASSERT_TRUE(seen.valid && !seen.sensor_wrong);
}

/* A wheel that a brake has just stopped: the current is taken away, and what the dead time makes
 * then turns the observer at 0.6 of its speed for 15 ms, the sensor stands and is right. With a
 * current it shows a rotor that turns. */
void test_an_observer_without_current_does_not_replace_a_sensor_that_has_stopped(void)
{
    config.rotor.sensor = CONFIG_ROTOR_ANGLE;
    at.observer_mrad_s = CONFIG_LU2013.rotor.observer_speed_mrad_s * 5 / 8;
    at.sensor_mrad_s = at.observer_mrad_s;
    at.i_pu.q = LEAST_PU;
    run(100);
    at.i_pu.q = LEAST_PU - 1;
    at.sensor_mrad_s = 0;
    at.difference_turn = DEGREES_60;
    run(200);
    TEST_ASSERT_TRUE(seen.valid && !seen.sensor_wrong);
    at.i_pu.q = LEAST_PU;
    run(100);
    TEST_ASSERT_TRUE(!seen.valid && seen.sensor_wrong);
}

/* A rotor that turns round stands still in between, where nothing can be observed. At 25 Nm and
 * half its speed the observer of a hub on an encoder went from 0.8 to -1.5 of its speed in 10 ms,
 * the sensor was right. */
void test_an_observer_that_turns_round_takes_no_torque_away(void)
{
    const int32_t least_mrad_s = CONFIG_LU2013.rotor.observer_speed_mrad_s;
    for (int share = 3; share <= 6; share++) { /* 0.75 to 1.5: below and above its speed */
        setUp();
        at.observer_mrad_s = share * least_mrad_s / 4;
        at.sensor_mrad_s = at.observer_mrad_s;
        at.i_pu.q = 0;
        run(100);
        at.observer_mrad_s = -at.observer_mrad_s;
        at.i_pu.q = share < 4 ? LEAST_PU : 0; /* below its speed it shows none without a current */
        at.difference_turn = INT16_MIN;
        for (int n = 0; n < 10; n++) {
            run(1);
            TEST_ASSERT_TRUE(seen.valid && !seen.sensor_wrong && !observed());
        }
        run(share < 4 ? 11 : 1); /* what has one direction for longer is a rotor */
        TEST_ASSERT_FALSE(seen.sensor_wrong);
        run(1);
        TEST_ASSERT_TRUE(seen.sensor_wrong);
    }
}

/* Between two edges halls keep the speed of the last sector: from standstill a wheel turns a fifth
 * to a half faster in the next, which is up to 30 degrees. */
void test_halls_that_lag_an_acceleration_have_not_slipped(void)
{
    run(100);
    at.sensor_mrad_s = at.observer_mrad_s * 2 / 3;
    at.difference_turn = -DEGREES_20 * 3 / 2;
    TEST_ASSERT_EQUAL_INT(-1, steps_until_used(100));
    config.rotor.sensor = CONFIG_ROTOR_ANGLE;
    const int steps = steps_until_used(20);
    TEST_ASSERT_TRUE(steps > 5 && steps <= 20);
}

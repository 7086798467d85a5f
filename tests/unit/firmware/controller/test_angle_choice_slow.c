/* SPDX-License-Identifier: Apache-2.0 */
/* Sensor against observer below the observer's speed. */
#include "angle_choice_rig.h"

/* 30 degrees of 65 536, rounded up; a sixteenth of the current's full scale; a time of the header.
 */
enum { ASKEW = 5462, LEAST_PU = 2048, SLOW_SLIP_ms = 6 };

void setUp(void)
{
    rig_up_to_compare();
}

void tearDown(void) {}

/* Below half of its speed, or where its flux is not plausible. */
void test_an_observer_without_a_plausible_angle_contradicts_no_sensor(void)
{
    for (int sign = -1; sign <= 1; sign += 2) {
        setUp();
        at.observer_mrad_s = sign * (FROM_mrad_s / 2 - 1);
        at.sensor_mrad_s = at.observer_mrad_s;
        at.i_pu.q = LEAST_PU;
        run_at(100, OPPOSED);
        TEST_ASSERT_FALSE(seen.sensor_wrong);
        at.observer_mrad_s = sign * FROM_mrad_s / 2;
        at.flux_q14 = 0;
        run_at(100, OPPOSED);
        TEST_ASSERT_FALSE(seen.sensor_wrong);
    }
}

/* With the current that makes torque. Halls are half a sector late there: 60 degrees. */
static bool is_a_slow_slip(int32_t sensor, int sign, int16_t size_turn, int steps)
{
    const int16_t difference_turn = (int16_t)(sign * size_turn);
    setUp();
    config.rotor.sensor = sensor;
    at.observer_mrad_s = -sign * FROM_mrad_s / 2;
    at.sensor_mrad_s = at.observer_mrad_s;
    at.i_pu.q = sign * LEAST_PU;
    run(100);
    run_at(steps, difference_turn);
    return seen.sensor_wrong;
}

void test_below_the_observer_s_speed_30_degrees_are_a_slip_or_60_of_halls(void)
{
    static const int32_t SENSORS[] = {CONFIG_ROTOR_ENCODER, CONFIG_ROTOR_ANGLE, CONFIG_ROTOR_HALL};
    for (int sign = -1; sign <= 1; sign += 2) {
        for (int k = 0; k < 3; k++) {
            const int16_t least = SENSORS[k] == CONFIG_ROTOR_HALL ? OPPOSED + 1 : ASKEW;
            TEST_ASSERT_FALSE(is_a_slow_slip(SENSORS[k], sign, (int16_t)(least - 2), 100));
            TEST_ASSERT_FALSE(is_a_slow_slip(SENSORS[k], sign, least, SLOW_SLIP_ms - 1));
            TEST_ASSERT_TRUE(is_a_slow_slip(SENSORS[k], sign, least, SLOW_SLIP_ms));
            TEST_ASSERT_TRUE(observed() && !seen.valid);
        }
    }
}

/* Less current makes no torque that could be wrong. A sensor that does not turn as fast as the
 * observer is judged by 60 degrees, in twice the time. */
void test_a_slow_slip_has_a_current_and_the_observer_s_speed(void)
{
    for (int sign = -1; sign <= 1; sign += 2) {
        TEST_ASSERT_FALSE(is_a_slow_slip(CONFIG_ROTOR_ANGLE, sign, ASKEW, 0));
        at.i_pu.q = sign * (LEAST_PU - 1);
        run_at(100, ASKEW);
        TEST_ASSERT_FALSE(seen.sensor_wrong);
        at.i_pu.q = sign * LEAST_PU;
        for (int faster = -1; faster <= 1; faster += 2) {
            at.sensor_mrad_s = at.observer_mrad_s + faster * (FROM_mrad_s / 8 + 1);
            run_at(100, ASKEW);
            TEST_ASSERT_FALSE(seen.sensor_wrong);
        }
        at.sensor_mrad_s = at.observer_mrad_s;
        run_at(100, 0); /* no longer one that rests */
        at.sensor_mrad_s = 0;
        run_at(SLOW_ms - 1, OPPOSED);
        TEST_ASSERT_FALSE(seen.sensor_wrong);
        run(1);
        TEST_ASSERT_TRUE(seen.sensor_wrong);
        for (int faster = -1; faster <= 1; faster += 2) {
            TEST_ASSERT_FALSE(is_a_slow_slip(CONFIG_ROTOR_ANGLE, sign, ASKEW, 0));
            at.sensor_mrad_s = at.observer_mrad_s + faster * FROM_mrad_s / 8;
            run_at(SLOW_SLIP_ms, ASKEW);
            TEST_ASSERT_TRUE(seen.sensor_wrong);
        }
    }
}

/* A current changes the flux of a salient motor as a rotor that turns does: what has shown a rotor
 * near rest for 50 ms is judged where the EMF is twice what is not known of it, else after 100 ms.
 * A sensor that was turning just before has stopped counting. */
void test_a_sensor_that_shows_rest_is_judged_from_twice_the_observer_s_speed(void)
{
    enum { REST_ms = 50, LONG_ms = 100 };
    for (int sign = -1; sign <= 1; sign += 2) {
        for (int twice = 0; twice <= 1; twice++) {
            setUp();
            config.rotor.sensor = CONFIG_ROTOR_HALL;
            at.sensor_mrad_s = sign * (FROM_mrad_s / 2 - 4);
            at.observer_mrad_s = sign * (2 * FROM_mrad_s - 1 + twice);
            run(REST_ms);
            run_at((twice == 1 ? 2 : LONG_ms) - 1, OPPOSED);
            TEST_ASSERT_FALSE(seen.sensor_wrong);
            run(1);
            TEST_ASSERT_TRUE(seen.sensor_wrong);
        }
        setUp();
        run(100);
        at.sensor_mrad_s = 1;
        run(REST_ms - 3);
        run_at(2, OPPOSED);
        TEST_ASSERT_TRUE(seen.sensor_wrong);
    }
}

/* Halls that have stood show a speed from their second edge on, while the current still rises. */
void test_a_sensor_that_begins_to_turn_is_judged_as_at_rest_for_as_long_as_it_rested(void)
{
    enum { REST_ms = 50, LONG_ms = 100 };
    for (int rested_ms = REST_ms; rested_ms <= 4 * REST_ms; rested_ms *= 2) {
        setUp();
        config.rotor.sensor = CONFIG_ROTOR_HALL;
        at.observer_mrad_s = 2 * FROM_mrad_s - 1;
        at.sensor_mrad_s = 0;
        run(rested_ms);
        const int turns_ms = q_min(rested_ms - REST_ms, REST_ms);
        at.sensor_mrad_s = FROM_mrad_s / 2 + 4;
        run_at(turns_ms, OPPOSED);
        TEST_ASSERT_FALSE(seen.sensor_wrong);
        run(turns_ms > 0 ? 1 : 2); /* two steps of the opposition are needed */
        TEST_ASSERT_TRUE(seen.sensor_wrong);
    }
}

/* Halls that accelerate show less. */
void test_a_sensor_that_shows_a_quarter_more_than_the_observer_is_judged_as_at_rest(void)
{
    enum { REST_ms = 50, LONG_ms = 100, QUARTER_mrad_s = 4000, FAST_mrad_s = 16000 };
    static const int32_t SHOWN_mrad_s[] = {FAST_mrad_s / 2, FAST_mrad_s + QUARTER_mrad_s,
                                           FAST_mrad_s + QUARTER_mrad_s + 1};
    for (int sign = -1; sign <= 1; sign += 2) {
        for (int k = 0; k < 3; k++) {
            setUp();
            config.rotor.sensor = CONFIG_ROTOR_HALL;
            at.observer_mrad_s = FAST_mrad_s;
            at.sensor_mrad_s = sign * SHOWN_mrad_s[k];
            run(REST_ms);
            run_at((k == 2 ? LONG_ms : 2) - 1, OPPOSED);
            TEST_ASSERT_FALSE(seen.sensor_wrong);
            run(1);
            TEST_ASSERT_TRUE(seen.sensor_wrong);
        }
    }
}

/* With t = sqrt(2 s/a) for the last sector s at a deceleration a a wheel n sectors before rest
 * turns at 2 sqrt(n) s/t, and halls show the mean of the turn before the edge: (sqrt(n + 6) +
 * sqrt(n)) s/t. Where it stops right behind an edge the next one is overdue 2 t later. */
static double turning_s_per_t(double sectors)
{
    return 2.0 * sqrt(sectors);
}

static double shown_s_per_t(double edge_sectors)
{
    return sqrt(edge_sectors + 6.0) + sqrt(edge_sectors);
}

/* A stop of 12 sectors with an observer that is right as long as the wheel turns. Stands after. */
static void stop_on_an_edge(double t_ms, double unit_mrad_s)
{
    const double from = 12.0;
    const int stop_ms = (int)ceil(sqrt(from) * t_ms);
    for (int ms = 0; ms < stop_ms; ms++) {
        const double left = sqrt(from) - ms / t_ms;
        const double sectors = left * left;
        at.observer_mrad_s = (int32_t)lround(turning_s_per_t(sectors) * unit_mrad_s);
        at.sensor_mrad_s = (int32_t)lround(shown_s_per_t(ceil(sectors)) * unit_mrad_s);
        run(1);
    }
    at.sensor_mrad_s = (int32_t)lround(shown_s_per_t(0.0) * unit_mrad_s);
}

/* An observer that then has the flux of a current that ended, either way, and a lower speed than
 * shown. t from 23 ms on, which takes 44 m/s^2 of the paper's wheel. */
void test_halls_of_a_wheel_that_has_just_stopped_are_judged_as_at_rest(void)
{
    enum { SHORTEST_ms = 23, LONGEST_ms = 200, LONG_ms = 100 };
    for (int t_ms = SHORTEST_ms; t_ms <= LONGEST_ms; t_ms += 3) {
        for (int sign = -1; sign <= 1; sign += 2) {
            setUp();
            config.rotor.sensor = CONFIG_ROTOR_HALL;
            stop_on_an_edge(t_ms, 0.6 * FROM_mrad_s);
            TEST_ASSERT_GREATER_THAN_INT32(FROM_mrad_s / 4 * 5, at.sensor_mrad_s);
            at.observer_mrad_s = sign * FROM_mrad_s;
            run_at(q_min(2 * t_ms, LONG_ms - 1), OPPOSED);
            TEST_ASSERT_FALSE(seen.sensor_wrong);
        }
    }
}

/* Frozen halls show the speed that the observer has until their edge is overdue. */
void test_halls_that_freeze_are_wrong_as_soon_as_they_are_opposed(void)
{
    for (int faster = -1; faster <= 1; faster += 2) {
        setUp();
        config.rotor.sensor = CONFIG_ROTOR_HALL;
        at.observer_mrad_s = 2 * FROM_mrad_s - 1;
        at.sensor_mrad_s = at.observer_mrad_s + faster * (at.observer_mrad_s / 4);
        run_at(100, 0);
        run_at(1, OPPOSED);
        at.sensor_mrad_s = at.sensor_mrad_s / 2; /* it decays */
        TEST_ASSERT_FALSE(seen.sensor_wrong);
        run(1);
        TEST_ASSERT_TRUE(seen.sensor_wrong);
    }
}

/* While the bridge does not switch there is no observer to turn with. */
void test_a_sensor_that_turned_while_coasting_is_judged_as_turning(void)
{
    setUp();
    config.rotor.sensor = CONFIG_ROTOR_HALL;
    at.switching = false;
    at.acquired = false;
    at.sensor_mrad_s = FROM_mrad_s;
    at.observer_mrad_s = 0;
    run(100);
    at.switching = true;
    run(3);
    at.acquired = true;
    at.observer_mrad_s = FROM_mrad_s;
    run(2);
    run_at(2, OPPOSED);
    TEST_ASSERT_TRUE(seen.sensor_wrong);
}

/* They show their sector of 60 degrees, and the observer is up to 30 off. */
void test_halls_without_a_speed_are_wrong_from_90_degrees(void)
{
    for (int hall = 0; hall <= 1; hall++) {
        setUp();
        config.rotor.sensor = hall == 1 ? CONFIG_ROTOR_HALL : CONFIG_ROTOR_ANGLE;
        at.observer_mrad_s = 2 * FROM_mrad_s;
        at.sensor_mrad_s = 0;
        run(100);
        run_at(100, 16383);
        TEST_ASSERT_EQUAL(hall == 0, seen.sensor_wrong);
        run_at(2, 16384);
        TEST_ASSERT_TRUE(seen.sensor_wrong);
    }
}

/* The sign of the dead time's voltage is the current's, and the observer remembers the one before.
 * From four times its speed it is within 14 degrees all the same. */
void test_a_slip_is_seen_with_40_ms_of_current_or_at_four_times_the_observer_s_speed(void)
{
    enum { CURRENT_ms = 40, SLIP_ms = 12, SLIPPED = 2913 };
    for (int sign = -1; sign <= 1; sign += 2) {
        setUp();
        at.observer_mrad_s = at.sensor_mrad_s = 4 * FROM_mrad_s - 1;
        at.i_pu.q = sign * LEAST_PU;
        run(100);
        at.i_pu.q = -at.i_pu.q;
        run_at(CURRENT_ms - 1, SLIPPED);
        run(SLIP_ms - 1);
        TEST_ASSERT_FALSE(seen.sensor_wrong);
        at.i_pu.q = 0;
        run(1000);
        TEST_ASSERT_FALSE(seen.sensor_wrong);
        at.observer_mrad_s = at.sensor_mrad_s = 4 * FROM_mrad_s;
        run(SLIP_ms - 1);
        TEST_ASSERT_FALSE(seen.sensor_wrong);
        run(1);
        TEST_ASSERT_TRUE(seen.sensor_wrong);
    }
}

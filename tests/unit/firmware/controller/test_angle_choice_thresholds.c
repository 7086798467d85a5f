/* SPDX-License-Identifier: Apache-2.0 */
/* The thresholds and times of sensor against observer, each from both of its sides. */
#include "angle_choice_rig.h"

/* 16 and 12 degrees of 65 536, rounded up, and what L_q may turn the observer by; times of the
 * header. */
enum { SLIPPED = 2914, AGREED = 2184, SLIP_ms = 12, NAME_ms = 10 };

void setUp(void)
{
    rig_up_to_compare();
}

void tearDown(void) {}

/* ---- late halls ---- */

/* Up to 45 rad/s electrical a stop, or a wait in the middle of the sector, is more than 16 degrees;
 * no other sensor is late. */
void test_slow_halls_have_not_slipped_by_less_than_60_degrees(void)
{
    static const struct {
        int32_t sensor, speed_mrad_s, difference_turn;
        bool slipped;
    } CASES[] = {
        {CONFIG_ROTOR_HALL, 11249, OPPOSED - 200, false},
        {CONFIG_ROTOR_HALL, 11250, SLIPPED, true},
        {CONFIG_ROTOR_HALL, 11249, OPPOSED + 200, true},
        {CONFIG_ROTOR_ANGLE, 11249, SLIPPED, true},
    };
    for (int k = 0; k < 4; k++) {
        for (int sign = -1; sign <= 1; sign += 2) {
            rig_up_to_compare();
            config.rotor.observer_speed_mrad_s = 4000;
            config.motor.pole_pairs = 4;
            config.rotor.sensor = CASES[k].sensor;
            at.observer_mrad_s = at.sensor_mrad_s = sign * CASES[k].speed_mrad_s;
            run(100);
            run_at(SLIP_ms + 1, (int16_t)(sign * CASES[k].difference_turn));
            TEST_ASSERT_EQUAL(CASES[k].slipped, seen.sensor_wrong);
        }
    }
}

/* ---- confirmation ---- */

/* With the input of `at` and without a sensor. */
static bool confirms(void)
{
    angle_choice_init(&rotor);
    at.sensor_valid = false;
    run(10);
    return seen.valid;
}

void test_bounds_of_flux_and_speed_are_exact(void)
{
    for (int sign = -1; sign <= 1; sign += 2) {
        at.across_q14 = sign * 1000;
        TEST_ASSERT_TRUE(confirms());
        at.across_q14 = sign * 1001;
        TEST_ASSERT_FALSE(confirms());
        at.across_q14 = 0;
        at.observer_mrad_s = sign * FROM_mrad_s;
        TEST_ASSERT_TRUE(confirms());
        at.observer_mrad_s = sign * (FROM_mrad_s - 1);
        TEST_ASSERT_FALSE(confirms());
        at.observer_mrad_s = sign * 20000;
    }
    at.expected_q14 = 8001;
    TEST_ASSERT_TRUE(confirms());
    at.expected_q14 = 8002;
    TEST_ASSERT_FALSE(confirms());
}

void test_two_steps_confirm_and_two_lose(void)
{
    at.sensor_valid = false;
    run(1);
    TEST_ASSERT_FALSE(seen.valid);
    run(1);
    TEST_ASSERT_TRUE(seen.valid);
    at.flux_q14 = 0;
    run(1);
    TEST_ASSERT_TRUE(seen.valid);
    run(1);
    TEST_ASSERT_FALSE(seen.valid);
    at.flux_q14 = 4000;
    run(2);
    TEST_ASSERT_TRUE(seen.valid);
    at.switching = false; /* at once */
    run(1);
    TEST_ASSERT_FALSE(seen.valid);
    run(10); /* and not counted meanwhile */
    at.switching = true;
    run(1);
    TEST_ASSERT_FALSE(seen.valid);
}

/* The observer's speed goes up and down by `change_mrad_s`. */
static bool confirms_while_it_swings(int32_t speed_mrad_s, int32_t change_mrad_s)
{
    angle_choice_init(&rotor);
    for (int n = 0; n < 20; n++) {
        at.observer_mrad_s = speed_mrad_s + (n % 2 == 0 ? 0 : change_mrad_s);
        run(1);
    }
    return rotor.confirmed;
}

/* A quarter of 16 rad/s in a step, unless the sensor itself has half of it. */
void test_an_observer_that_swings_is_not_confirmed_near_standstill(void)
{
    for (int sign = -1; sign <= 1; sign += 2) {
        at.sensor_mrad_s = 0;
        TEST_ASSERT_TRUE(confirms_while_it_swings(sign * 20000, sign * 4000));
        TEST_ASSERT_FALSE(confirms_while_it_swings(sign * 20000, sign * 4002));
        at.sensor_mrad_s = sign * FROM_mrad_s / 2;
        TEST_ASSERT_TRUE(confirms_while_it_swings(sign * 20000, sign * 40000));
        at.sensor_mrad_s = sign * (FROM_mrad_s / 2 - 2);
        TEST_ASSERT_FALSE(confirms_while_it_swings(sign * 20000, sign * 40000));
    }
    /* Once it is confirmed a swing does not end that. */
    at.observer_mrad_s = 20000;
    run(3);
    TEST_ASSERT_TRUE(rotor.confirmed);
    for (int n = 0; n < 10; n++) {
        at.observer_mrad_s = n % 2 == 0 ? 60000 : 20000;
        run(1);
        TEST_ASSERT_TRUE(rotor.confirmed);
    }
}

/* Zero counts as forwards. */
void test_the_direction_is_the_sign_of_the_observer_s_speed(void)
{
    static const int32_t SPEEDS_mrad_s[] = {20000, 1, 0, -1, -20000};
    for (int k = 0; k < 5; k++) {
        setUp();
        at.observer_mrad_s = SPEEDS_mrad_s[k];
        run(1);
        TEST_ASSERT_EQUAL_INT8(SPEEDS_mrad_s[k] >= 0 ? 1 : -1, rotor.direction);
    }
}

/* Without PWM, or before the observer has acquired the rotor, none is known. */
void test_a_start_has_no_direction_before_it(void)
{
    for (int starts = 0; starts < 2; starts++) {
        setUp();
        run(20);
        at.observer_mrad_s = -20000;
        bool *const known = starts != 0 ? &at.acquired : &at.switching;
        *known = false;
        run(1);
        TEST_ASSERT_EQUAL_INT(0, rotor.against);
        TEST_ASSERT_EQUAL_INT(-1, rotor.direction);
        *known = true;
        run(1);
        TEST_ASSERT_EQUAL_INT(0, rotor.against);
    }
}

/* ---- comparison ---- */

/* Below 12 degrees, in the same step; or at any angle once the observer is not confirmed. */
void test_a_sensor_that_is_valid_again_is_used_once_it_agrees(void)
{
    for (int sign = -1; sign <= 1; sign += 2) {
        for (int16_t apart = AGREED + 1; apart <= AGREED + 2; apart++) {
            setUp();
            run(20);
            at.sensor_valid = false;
            run(5);
            TEST_ASSERT_TRUE(observed());
            at.sensor_valid = true;
            run_at(3, (int16_t)(sign * apart));
            TEST_ASSERT_EQUAL_INT(apart > AGREED + 1, observed());
            TEST_ASSERT_TRUE(seen.valid);
            at.flux_q14 = 0;
            run(2);
            TEST_ASSERT_FALSE(observed());
        }
    }
}

/* A sensor that is not valid is not compared, and what was counted is forgotten. */
void test_an_invalid_sensor_begins_every_count_anew(void)
{
    run(100);
    run_at(1, OPPOSED);
    at.sensor_valid = false;
    run(10);
    TEST_ASSERT_FALSE(seen.sensor_wrong);
    at.sensor_valid = true;
    run(1);
    TEST_ASSERT_FALSE(seen.sensor_wrong);
    run_at(50, 0);

    run_at(SLIP_ms - 1, SLIPPED);
    at.sensor_valid = false;
    run(1);
    at.sensor_valid = true;
    run(SLIP_ms - 1);
    TEST_ASSERT_FALSE(seen.sensor_wrong);
    run(1);
    TEST_ASSERT_TRUE(seen.sensor_wrong);

    run_at(HEAL_ms - 1, 0);
    at.sensor_valid = false;
    run(1);
    at.sensor_valid = true;
    run(HEAL_ms - 1);
    TEST_ASSERT_TRUE(seen.sensor_wrong);
    run(1);
    TEST_ASSERT_FALSE(seen.sensor_wrong);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, seen.name);
}

void test_agreement_is_below_12_degrees_and_ends_a_long_slip(void)
{
    for (int sign = -1; sign <= 1; sign += 2) {
        setUp();
        run(100);
        run_at(100, (int16_t)(sign * SLIPPED));
        TEST_ASSERT_TRUE(seen.sensor_wrong);
        run_at(1000, (int16_t)(sign * (AGREED + 1)));
        TEST_ASSERT_TRUE(seen.sensor_wrong);
        run_at(100, (int16_t)(sign * SLIPPED));
        run_at(HEAL_ms - 1, (int16_t)(sign * AGREED));
        TEST_ASSERT_TRUE(seen.sensor_wrong);
        run(1);
        TEST_ASSERT_FALSE(seen.sensor_wrong);
    }
    config.monitor.rotor_warning_time_ms = 1;
    run_at(100, SLIPPED);
    run_at(1, 0);
    TEST_ASSERT_FALSE(seen.sensor_wrong);
}

/* ---- names ---- */

/* 10 ms after it is wrong and not before; then as long as it is. */
static void assert_named(int32_t sensor_mrad_s, reason_t name)
{
    const int32_t observer_mrad_s = at.observer_mrad_s;
    setUp();
    at.observer_mrad_s = observer_mrad_s;
    at.sensor_mrad_s = observer_mrad_s;
    run(100);
    at.sensor_mrad_s = sensor_mrad_s;
    run_at(2, OPPOSED);
    TEST_ASSERT_TRUE(seen.sensor_wrong);
    for (int n = 1; n < NAME_ms; n++) {
        TEST_ASSERT_EQUAL_INT(REASON_NONE, seen.name);
        run(1);
    }
    for (int n = 0; n < 600; n++) {
        TEST_ASSERT_EQUAL_INT(name, seen.name);
        run(1);
    }
    cleared = true; /* with an open bridge only */
    run_at(1, 0);
    TEST_ASSERT_EQUAL_INT(name, seen.name);
    at.switching = false;
    run(1);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, seen.name);
}

void test_names_by_the_sensor_s_speed_are_exact(void)
{
    for (int sign = -1; sign <= 1; sign += 2) {
        at.observer_mrad_s = sign * 20000;
        assert_named(sign * 10000, REASON_ROTOR_SLIPPED);
        assert_named(sign * 9999, REASON_ROTOR_FROZEN);
        assert_named(sign * -9999, REASON_ROTOR_FROZEN);
        assert_named(sign * -10000, REASON_ROTOR_REVERSED);
    }
    at.observer_mrad_s = -20000;
    assert_named(INT32_MIN, REASON_ROTOR_SLIPPED);
}

/* With the least speed that can be configured: zero counts as forwards. */
void test_names_beside_an_observer_that_hardly_turns_are_exact(void)
{
    static const struct {
        int32_t observer_mrad_s, sensor_mrad_s;
        reason_t name;
    } CASES[] = {{0, 5, REASON_ROTOR_SLIPPED},
                 {0, -5, REASON_ROTOR_REVERSED},
                 {-1, 5, REASON_ROTOR_REVERSED},
                 {1, -5, REASON_ROTOR_REVERSED}};
    for (unsigned k = 0; k < sizeof CASES / sizeof CASES[0]; k++) {
        setUp();
        config.rotor.observer_speed_mrad_s = 1;
        at.observer_mrad_s = CASES[k].observer_mrad_s;
        at.sensor_mrad_s = CASES[k].sensor_mrad_s;
        run_at(SLOW_ms + NAME_ms, OPPOSED);
        TEST_ASSERT_EQUAL_INT(CASES[k].name, seen.name);
    }
}

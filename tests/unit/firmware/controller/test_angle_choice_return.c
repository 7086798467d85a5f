/* SPDX-License-Identifier: Apache-2.0 */
/* A sensor that contradicts itself where no observer sees whether it is right afterwards. */
#include "angle_choice_rig.h"

enum { HALF_mrad_s = FROM_mrad_s / 2, INVALID_ms = 5, LONG_ms = 5000 };

/* Creeping, the observer still without the magnets' flux. */
void setUp(void)
{
    rig_up(&ROLLING);
    config.rotor.observer_speed_mrad_s = FROM_mrad_s;
    at.observer_mrad_s = 1000;
    at.sensor_mrad_s = 3000;
    at.flux_q14 = 100;
    at.across_q14 = 4000;
}

void tearDown(void) {}

/* Invalid for a while, and valid again; the torque meanwhile. */
static bool has_torque_after_an_interruption(void)
{
    run(10);
    TEST_ASSERT_TRUE(seen.valid);
    at.sensor_valid = false;
    run(1);
    TEST_ASSERT_FALSE(seen.valid);
    run(INVALID_ms - 1);
    at.sensor_valid = true;
    run(1);
    const bool at_once = seen.valid;
    run(LONG_ms);
    TEST_ASSERT_EQUAL(at_once, seen.valid);
    TEST_ASSERT_EQUAL(at_once, !seen.sensor_wrong);
    return at_once;
}

void test_halls_and_an_absolute_angle_that_return_make_no_torque(void)
{
    static const int32_t SENSORS[] = {CONFIG_ROTOR_HALL, CONFIG_ROTOR_ANGLE};
    for (size_t k = 0; k < sizeof SENSORS / sizeof SENSORS[0]; k++) {
        for (int sign = -1; sign <= 1; sign++) {
            setUp();
            config.rotor.sensor = SENSORS[k];
            at.sensor_mrad_s = sign * 3000;
            TEST_ASSERT_FALSE(has_torque_after_an_interruption());
            TEST_ASSERT_FALSE(observed());
            TEST_ASSERT_EQUAL_INT(REASON_ROTOR_UNCERTAIN, seen.name);
        }
    }
}

/* Its index has been confirmed by then. */
void test_an_encoder_that_returns_is_used(void)
{
    config.rotor.sensor = CONFIG_ROTOR_ENCODER;
    TEST_ASSERT_TRUE(has_torque_after_an_interruption());
}

void test_a_sensor_that_was_never_valid_is_used_from_then_on(void)
{
    at.sensor_valid = false;
    run(LONG_ms);
    TEST_ASSERT_FALSE(seen.sensor_wrong);
    at.sensor_valid = true;
    run(1);
    TEST_ASSERT_TRUE(seen.valid);
}

/* It makes no torque that could be wrong, and turns slowly. */
void test_without_pwm_a_sensor_may_return(void)
{
    at.switching = false;
    TEST_ASSERT_TRUE(has_torque_after_an_interruption());
    /* Nor does the bridge's closing make one wrong that became invalid before. */
    at.sensor_valid = false;
    run(1);
    at.switching = true;
    run(INVALID_ms);
    at.sensor_valid = true;
    run(1);
    TEST_ASSERT_TRUE(seen.valid);
}

/* A wheel that locks stops its sensor at speed. */
void test_the_observer_s_speed_is_the_bound(void)
{
    for (int sign = -1; sign <= 1; sign += 2) {
        setUp();
        at.sensor_mrad_s = sign * FROM_mrad_s;
        TEST_ASSERT_TRUE(has_torque_after_an_interruption());
        setUp();
        at.sensor_mrad_s = sign * (FROM_mrad_s - 2);
        TEST_ASSERT_FALSE(has_torque_after_an_interruption());
    }
    setUp();
    at.sensor_mrad_s = INT32_MIN;
    TEST_ASSERT_TRUE(has_torque_after_an_interruption());
}

/* From half its speed on, by the sensor or the observer, a torque can ramp out: with the angle that
 * the sensor had, or the observer's. */
void test_from_half_the_speed_on_it_is_wrong_at_its_return(void)
{
    for (int watched = 0; watched < 2; watched++) {
        setUp();
        if (watched != 0) {
            at.observer_mrad_s = HALF_mrad_s;
            at.flux_q14 = 4000;
            at.across_q14 = 100;
        } else {
            at.sensor_mrad_s = HALF_mrad_s;
        }
        run(10);
        at.sensor_valid = false;
        run(LONG_ms);
        TEST_ASSERT_TRUE(!seen.sensor_wrong && !seen.valid);
        TEST_ASSERT_EQUAL(watched != 0, observed());
        at.sensor_valid = true;
        run(1);
        TEST_ASSERT_TRUE(seen.sensor_wrong && !seen.valid);
        run(LONG_ms);
        TEST_ASSERT_TRUE(seen.sensor_wrong && !seen.valid);
    }
}

void test_below_half_the_speed_it_is_wrong_at_once(void)
{
    for (int sign = -1; sign <= 1; sign += 2) {
        setUp();
        at.sensor_mrad_s = sign * (HALF_mrad_s - 2);
        run(10);
        at.sensor_valid = false;
        run(1);
        TEST_ASSERT_TRUE(seen.sensor_wrong && !observed());
    }
}

/* Not one that comes back with an open bridge. */
void test_an_open_bridge_forgets_it(void)
{
    at.sensor_mrad_s = HALF_mrad_s;
    run(10);
    at.sensor_valid = false;
    run(INVALID_ms);
    at.switching = false;
    run(1);
    at.switching = true;
    run(1);
    at.sensor_valid = true;
    run(1);
    TEST_ASSERT_TRUE(!seen.sensor_wrong && seen.valid);
}

/* A sensor that shows too little: the observer decides. */
void test_a_confirmed_observer_decides_instead(void)
{
    at.observer_mrad_s = FROM_mrad_s;
    at.sensor_mrad_s = FROM_mrad_s / 2;
    at.flux_q14 = 4000;
    at.across_q14 = 100;
    run(10);
    at.sensor_valid = false;
    run(1);
    TEST_ASSERT_TRUE(!seen.sensor_wrong && observed() && seen.valid);
    at.sensor_valid = true;
    run(1);
    TEST_ASSERT_TRUE(!seen.sensor_wrong && !observed() && seen.valid);
}

void test_an_acknowledgement_makes_it_right(void)
{
    TEST_ASSERT_FALSE(has_torque_after_an_interruption());
    cleared = true;
    at.switching = false;
    run(1);
    TEST_ASSERT_FALSE(seen.sensor_wrong);
    TEST_ASSERT_TRUE(seen.valid);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, seen.name);
    /* Not one while the bridge switches. */
    at.switching = true;
    cleared = false;
    run(1);
    at.sensor_valid = false;
    cleared = true;
    run(1);
    TEST_ASSERT_TRUE(seen.sensor_wrong);
}

/* At speed the observer shows that it is right after all. */
void test_long_agreement_with_the_observer_makes_it_right(void)
{
    config.monitor.rotor_warning_time_ms = 20;
    TEST_ASSERT_FALSE(has_torque_after_an_interruption());
    at.observer_mrad_s = 20000;
    at.sensor_mrad_s = 20000;
    at.flux_q14 = 4000;
    at.across_q14 = 100;
    run(10);
    TEST_ASSERT_TRUE(seen.valid && observed() && seen.sensor_wrong);
    run(20);
    TEST_ASSERT_TRUE(seen.valid && !observed() && !seen.sensor_wrong);
}

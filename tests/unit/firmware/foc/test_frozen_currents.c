/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Readings of the current sensors that do not move although the controller sees an error. Currents
 * and errors are shares of the full scale of 32 768; a code is 16 of them.
 */
#include "frozen_currents.h"

#include <math.h>

#include "foc_rig.h"

static frozen_currents_t state;
static foc_period_t latest;

void setUp(void)
{
    rig_up();
    const frozen_currents_t fresh = {.last_step = 0};
    state = fresh;
    latest.step_count = 1000;
    latest.i_pu.v = q_pair(0, -4000);
    latest.i_reference_pu.v = q_pair(0, -5600);
    codes[0] = 1900;
    codes[1] = 2300;
    codes[2] = 1944;
}

void tearDown(void) {}

static bool look(uint32_t periods)
{
    latest.step_count += periods;
    return frozen_currents_step(&state, &latest, codes);
}

/* Periods from the first look, which has nothing to compare with, to the one that finds `3 -
 * moving` readings frozen; 0: none does. */
static uint32_t periods_until(int moving, uint32_t between)
{
    look(100);
    const uint32_t begin = latest.step_count;
    for (int n = 1; n <= 20; n++) {
        for (int x = 0; x < moving; x++) {
            codes[x]++;
        }
        if (look(between)) {
            return latest.step_count - begin;
        }
    }
    return 0;
}

void test_three_readings_that_stay_for_twelve_periods_are_frozen(void)
{
    TEST_ASSERT_EQUAL_UINT32(12, periods_until(0, 4));
    TEST_ASSERT_EQUAL_UINT32(12, periods_until(0, 1));
}

void test_with_a_very_large_error_eight_periods_are_enough(void)
{
    latest.i_reference_pu.v = q_pair(0, -4000 - 2040);
    TEST_ASSERT_EQUAL_UINT32(12, periods_until(0, 4));
    latest.i_reference_pu.v = q_pair(0, -4000 - 2056);
    TEST_ASSERT_EQUAL_UINT32(8, periods_until(0, 4));
    TEST_ASSERT_EQUAL_UINT32(8, periods_until(0, 1));
}

void test_two_that_stay_are_frozen_one_alone_is_not(void)
{
    TEST_ASSERT_EQUAL_UINT32(12, periods_until(1, 4));
    TEST_ASSERT_EQUAL_UINT32(0, periods_until(2, 4));
    TEST_ASSERT_EQUAL_UINT32(0, periods_until(3, 4));
}

void test_any_two_that_stay_are_frozen(void)
{
    for (int moving = 0; moving < 3; moving++) {
        look(100);
        for (int n = 1; n <= 3; n++) {
            codes[moving]++;
            TEST_ASSERT_EQUAL(n == 3, look(4));
        }
    }
}

void test_one_code_of_movement_begins_the_periods_again(void)
{
    look(100);
    look(4);
    codes[0]++;
    codes[1]--;
    TEST_ASSERT_FALSE(look(4));
    TEST_ASSERT_FALSE(look(4));
    TEST_ASSERT_FALSE(look(4));
    TEST_ASSERT_TRUE(look(4));
}

/* A period with a hall edge is left out, so is its look. */
void test_one_look_may_be_left_out_two_begin_again(void)
{
    TEST_ASSERT_EQUAL_UINT32(16, periods_until(0, 8));
    TEST_ASSERT_EQUAL_UINT32(0, periods_until(0, 9));
    TEST_ASSERT_EQUAL_UINT32(0, periods_until(0, 12));
}

/* After 90 codes, 1 440, and before 91: the square of the limit is 2^21. */
void test_a_look_is_due_from_an_error_of_91_codes_on_in_any_direction(void)
{
    for (int degree = 0; degree < 360; degree += 15) {
        const double at = degree * 3.14159265358979 / 180.0;
        for (int large = 0; large < 2; large++) {
            const double size = large ? 91.0 * 16.0 : 90.0 * 16.0;
            latest.i_pu.v = q_pair(-300, 500);
            latest.i_reference_pu.v = q_pair(-300 + (int32_t)lround(size * cos(at)),
                                             500 + (int32_t)lround(size * sin(at)));
            TEST_ASSERT_EQUAL(large == 1, frozen_currents_due(&latest));
        }
    }
}

/* In the fast loop: a braking current in a turning rotor, then a converter that stops. The error is
 * the current times the turn since then: 600 codes at 0.0511 rad a period, 31 codes a period. The
 * first look falls into the fourth period: 123 codes, above 90; the second and the third see 245
 * and 368, above 128, so the readings have stayed long enough eight periods after the first. */
static int periods_until_frozen(int sensors)
{
    int32_t frozen[3] = {0, 0, 0};
    for (int n = 0; n < 4000; n++) { /* until the angle's speed is known */
        in.rotor_angle_turn = (uint16_t)(in.rotor_angle_turn + 533U);
        foc_idle_step(&foc, &config, &setpoint, &in);
    }
    for (int n = 0; n < 40; n++) {
        in.rotor_angle_turn = (uint16_t)(in.rotor_angle_turn + 533U);
        const double angle = in.rotor_angle_turn / 65536.0;
        for (int x = 0; x < 3; x++) {
            const double at = 6.283185307179586 * (angle - x / 3.0);
            const int32_t code = (int32_t)lround(2048.0 + 600.0 * sin(at));
            frozen[x] = n < 20 ? code : frozen[x];
            codes[x] = (uint16_t)(x < sensors ? frozen[x] : code);
        }
        if (foc_step(&foc, &config, &setpoint, &in)) {
            return n - 19;
        }
    }
    return 0;
}

void test_a_stopped_converter_under_a_turning_current_is_found_after_twelve_periods(void)
{
    for (int offset = 0; offset < 16; offset++) {
        rig_up();
        setpoint.i_reference_pu.q = -600 * 16;
        setpoint.sequence = 1;
        in.rotor_angle_turn = (uint16_t)(offset * 4099);
        TEST_ASSERT_EQUAL_INT(12, periods_until_frozen(3));
    }
}

void test_a_turning_current_with_all_sensors_right_is_never_frozen(void)
{
    setpoint.i_reference_pu.q = -600 * 16;
    setpoint.sequence = 1;
    TEST_ASSERT_EQUAL_INT(0, periods_until_frozen(0));
}

/* Readings of no current under a reference of 600 codes, at standstill. The looks fall into periods
 * 4, 8 and 12; one that meets a hall edge waits for a period. */
static int periods_until_found(int edge_in_period)
{
    rig_up();
    config.rotor.sensor = CONFIG_ROTOR_HALL;
    restart();
    for (int n = 0; n < 100; n++) {
        step(true);
    }
    setpoint.i_reference_pu.q = 600 * 16;
    setpoint.sequence++;
    for (int n = 1; n <= 40; n++) {
        in.hall_state = n >= edge_in_period ? 1 : 5;
        if (foc_step(&foc, &config, &setpoint, &in)) {
            return n;
        }
    }
    return 0;
}

void test_the_look_that_meets_a_hall_edge_comes_one_period_later(void)
{
    TEST_ASSERT_EQUAL_INT(12, periods_until_found(41));
    TEST_ASSERT_EQUAL_INT(12, periods_until_found(11));
    TEST_ASSERT_EQUAL_INT(13, periods_until_found(12));
    TEST_ASSERT_EQUAL_INT(12, periods_until_found(8));
}

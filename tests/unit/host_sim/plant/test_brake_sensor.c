/* SPDX-License-Identifier: Apache-2.0 */
/* What a sensor of the hydraulic torque reports, and when. */
#include "plant/brake_sensor.h"

#include <math.h>

#include "unity.h"

static brake_sensor_params_t params;
static brake_sensor_state_t state;

void setUp(void)
{
    const brake_sensor_params_t fitted = {.fitted = 1.0, .period_s = 0.01, .delay_s = 0.005};
    params = fitted;
    state = brake_sensor_init(random_init(1, 0));
}

void tearDown(void) {}

void test_a_message_holds_the_torque_of_a_delay_ago_and_grows_old_until_the_next(void)
{
    for (int ms = 0; ms < 500; ms++) {
        const brake_sensor_report_t report = brake_sensor_step(&params, &state, ms);
        const int sent_ms = ms / 10 * 10;
        TEST_ASSERT_TRUE(report.valid);
        TEST_ASSERT_EQUAL_INT(ms - sent_ms, report.age_ms);
        TEST_ASSERT_EQUAL_DOUBLE(sent_ms < 5 ? 0.0 : sent_ms - 5, report.torque_nm);
    }
}

void test_without_a_sensor_there_is_no_valid_report(void)
{
    params.fitted = 0.0;
    for (int ms = 0; ms < 50; ms++) {
        TEST_ASSERT_FALSE(brake_sensor_step(&params, &state, 30.0).valid);
    }
}

void test_gain_error_and_offset_change_what_is_shown(void)
{
    params.delay_s = 0.0;
    params.gain_error = -0.25;
    params.offset_nm = 3.0;
    TEST_ASSERT_EQUAL_DOUBLE(0.75 * 40.0 + 3.0, brake_sensor_step(&params, &state, 40.0).torque_nm);
}

void test_a_stuck_sensor_repeats_its_value_in_messages_that_seem_valid(void)
{
    params.delay_s = 0.0;
    brake_sensor_step(&params, &state, 40.0);
    params.stuck = 1.0;
    for (int ms = 1; ms < 50; ms++) {
        const brake_sensor_report_t report = brake_sensor_step(&params, &state, 0.0);
        TEST_ASSERT_TRUE(report.valid);
        TEST_ASSERT_EQUAL_DOUBLE(40.0, report.torque_nm);
    }
}

void test_a_silent_sensor_leaves_its_last_message_to_grow_old(void)
{
    brake_sensor_step(&params, &state, 0.0);
    params.silent = 1.0;
    brake_sensor_report_t report = {.age_ms = 0};
    for (int ms = 1; ms <= 200; ms++) {
        report = brake_sensor_step(&params, &state, 40.0);
    }
    TEST_ASSERT_EQUAL_INT(200, report.age_ms);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, report.torque_nm);
}

void test_a_sensor_fault_flag_makes_the_reading_invalid(void)
{
    params.invalid = 1.0;
    TEST_ASSERT_FALSE(brake_sensor_step(&params, &state, 0.0).valid);
}

/* Of a torque at rest: the mean is the torque, the deviation the sensor's, each within four times
 * the error of that mean. A stuck sensor shows one number. */
void test_the_noise_of_the_sensor_has_its_standard_deviation(void)
{
    enum { COUNT = 4000 };
    params.noise_nm = 2.0;
    params.period_s = params.delay_s = 0.0;
    double sum = 0.0, squares = 0.0;
    for (int n = 0; n < COUNT; n++) {
        const double off_nm = brake_sensor_step(&params, &state, 40.0).torque_nm - 40.0;
        sum += off_nm;
        squares += off_nm * off_nm;
    }
    TEST_ASSERT_DOUBLE_WITHIN(4.0 * 2.0 / sqrt(COUNT), 0.0, sum / COUNT);
    TEST_ASSERT_DOUBLE_WITHIN(4.0 * 2.0 / sqrt(2.0 * COUNT), 2.0, sqrt(squares / COUNT));
    params.stuck = 1.0;
    const double stuck_nm = brake_sensor_step(&params, &state, 40.0).torque_nm;
    TEST_ASSERT_EQUAL_DOUBLE(stuck_nm, brake_sensor_step(&params, &state, 50.0).torque_nm);
}

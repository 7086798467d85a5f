/* SPDX-License-Identifier: Apache-2.0 */
/* A reference without any current. */
#include "monitor/monitor_current.h"

#include <math.h>

#include "monitor_case.h"
#include "paper_vehicle.h"
#include "unity.h"

static config_t config;
static monitor_current_state_t state;

void setUp(void)
{
    const monitor_current_state_t fresh = {.missing_pu = 0};
    config = paper_vehicle();
    config.monitor.current_missing_pu_q15 = 1440;
    state = fresh;
}

void tearDown(void) {}

static const monitor_case_t DEMANDED = {
    .report = {.bridge = BRIDGE_PWM},
    .last = {.reference_pu = {.d = 0, .q = 10000}},
};

static bool step(const monitor_case_t *in)
{
    return monitor_current_step(&state, &config, measured_of(in), in->last.reference_pu);
}

static int time_to_missing(int32_t d_pu, int32_t q_pu, int32_t shown_pu)
{
    const monitor_current_state_t fresh = {.missing_pu = 0};
    monitor_case_t in = DEMANDED;
    state = fresh;
    in.last.reference_pu.d = d_pu;
    in.last.reference_pu.q = q_pu;
    in.now.sampled_pu.d = 0;
    in.now.sampled_pu.q = shown_pu;
    for (int n = 1; n <= 1000; n++) {
        if (step(&in)) {
            return n;
        }
    }
    return -1;
}

/* 1440 LSB ms: the current that flows unseen is the same at every reference. */
void test_missing_current_is_named_when_reference_times_time_is_reached(void)
{
    TEST_ASSERT_EQUAL_INT(3, time_to_missing(0, 2000, 0));
    TEST_ASSERT_EQUAL_INT(3, time_to_missing(0, -480, 0));
    TEST_ASSERT_EQUAL_INT(3, time_to_missing(-480, 0, -20));
    TEST_ASSERT_EQUAL_INT(15, time_to_missing(0, 100, 20));
}

void test_no_current_is_missing_where_some_flows_or_none_is_demanded(void)
{
    TEST_ASSERT_EQUAL_INT(-1, time_to_missing(0, 2000, 40));
    TEST_ASSERT_EQUAL_INT(-1, time_to_missing(0, 2000, -40));
    TEST_ASSERT_EQUAL_INT(-1, time_to_missing(0, 0, 0));
    TEST_ASSERT_EQUAL_INT(-1, time_to_missing(20, -20, 0));
}

/* A current that passes zero once in a while is none that is missing. */
void test_missing_time_begins_again_with_every_current(void)
{
    monitor_case_t in = DEMANDED;
    in.last.reference_pu.q = 480;
    for (int n = 0; n < 1000; n++) {
        in.now.sampled_pu.q = n % 3 == 2 ? 300 : 0;
        TEST_ASSERT_FALSE(step(&in));
    }
}

void test_no_current_is_missing_without_pwm_and_at_the_voltage_limit_none_is_counted(void)
{
    monitor_case_t in = DEMANDED;
    in.report.voltage_limited = true;
    for (int n = 0; n < 1000; n++) {
        TEST_ASSERT_FALSE(step(&in));
    }
    in.report.voltage_limited = false;
    in.report.bridge = BRIDGE_OFF;
    for (int n = 0; n < 1000; n++) {
        TEST_ASSERT_FALSE(step(&in));
    }
}

/* A length from 3 % less to 7 % more than it is. */
void test_length_is_within_its_bounds_in_every_direction(void)
{
    config.monitor.current_missing_pu_q15 = 90000; /* a third is more than any reference */
    for (int degrees = 0; degrees < 360; degrees++) {
        const double angle = degrees * acos(-1.0) / 180.0;
        monitor_case_t in = DEMANDED;
        in.last.reference_pu.d = (int32_t)lround(20000.0 * cos(angle));
        in.last.reference_pu.q = (int32_t)lround(20000.0 * sin(angle));
        state.missing_pu = 0;
        (void)step(&in);
        TEST_ASSERT_TRUE(state.missing_pu >= 19400 && state.missing_pu <= 21400);
    }
}

/* A code and a half are 24, and at least twice as much is to be demanded. */
void test_thresholds_of_current_and_reference_are_exact(void)
{
    TEST_ASSERT_EQUAL_INT(3, time_to_missing(0, 2000, 24));
    TEST_ASSERT_EQUAL_INT(-1, time_to_missing(0, 2000, 25));
    TEST_ASSERT_EQUAL_INT32(0, state.missing_pu);
    TEST_ASSERT_EQUAL_INT(-1, time_to_missing(0, 48, 0));
    TEST_ASSERT_EQUAL_INT(30, time_to_missing(0, 49, 0)); /* 29.4 steps of 49 */
}

/* Not before three steps, also where the sum is no multiple of three, and never more than it. */
void test_three_steps_at_least_are_needed_and_the_sum_is_limited(void)
{
    static const int32_t MOST[] = {3, 5, 1440, 1441, 1442};
    for (int k = 0; k < 5; k++) {
        config.monitor.current_missing_pu_q15 = MOST[k];
        TEST_ASSERT_EQUAL_INT(MOST[k] == 3 ? 2 : 3, time_to_missing(0, 10000, 0));
        monitor_case_t in = DEMANDED;
        TEST_ASSERT_TRUE(step(&in));
        TEST_ASSERT_EQUAL_INT32(MOST[k], state.missing_pu);
    }
}

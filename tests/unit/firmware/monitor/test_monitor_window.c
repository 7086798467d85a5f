/* SPDX-License-Identifier: Apache-2.0 */
/* Lowest and highest of the latest milliseconds, and what qualifies a contradiction. */
#include "monitor/monitor_window.h"

#include "unity.h"

static monitor_window_t window;

void setUp(void)
{
    monitor_window_restart(&window);
}

void tearDown(void) {}

/* Of a value that rises for ever, and of one that falls. */
void test_extremes_are_those_of_one_to_two_windows(void)
{
    for (int32_t ms = 0; ms < 1000; ms++) {
        const bool complete = monitor_window_add(&window, ms - 500);
        const int32_t begin_ms = (ms / MONITOR_WINDOW_STEPS - 1) * MONITOR_WINDOW_STEPS;
        TEST_ASSERT_EQUAL_INT(ms >= MONITOR_WINDOW_STEPS, complete);
        TEST_ASSERT_EQUAL_INT(complete ? 1 : 0, window.windows);
        if (complete) {
            TEST_ASSERT_EQUAL_INT32(begin_ms - 500, monitor_window_lowest(&window));
            TEST_ASSERT_EQUAL_INT32(ms - 500, monitor_window_highest(&window));
        }
    }
    setUp();
    for (int32_t ms = 0; ms < 1000; ms++) {
        const int32_t begin_ms = (ms / MONITOR_WINDOW_STEPS - 1) * MONITOR_WINDOW_STEPS;
        if (monitor_window_add(&window, 500 - ms)) {
            TEST_ASSERT_EQUAL_INT32(500 - ms, monitor_window_lowest(&window));
            TEST_ASSERT_EQUAL_INT32(500 - begin_ms, monitor_window_highest(&window));
        }
    }
}

void test_a_restart_forgets_what_was_before(void)
{
    for (int32_t ms = 0; ms < 1000; ms++) {
        (void)monitor_window_add(&window, ms % 2 == 0 ? INT32_MAX : INT32_MIN);
    }
    monitor_window_restart(&window);
    for (int32_t ms = 0; ms < MONITOR_WINDOW_STEPS; ms++) {
        TEST_ASSERT_FALSE(monitor_window_add(&window, 7));
    }
    TEST_ASSERT_TRUE(monitor_window_add(&window, 7));
    TEST_ASSERT_EQUAL_INT32(7, monitor_window_lowest(&window));
    TEST_ASSERT_EQUAL_INT32(7, monitor_window_highest(&window));
}

void test_contradictions_qualify_and_agreement_heals_one_for_one(void)
{
    for (int k = 1; k < MONITOR_WINDOW_QUALIFY_STEPS; k++) {
        TEST_ASSERT_FALSE(monitor_window_judge(&window, true));
    }
    TEST_ASSERT_FALSE(monitor_window_judge(&window, false));
    TEST_ASSERT_FALSE(monitor_window_judge(&window, true));
    TEST_ASSERT_TRUE(monitor_window_judge(&window, true));
    TEST_ASSERT_TRUE(monitor_window_judge(&window, true)); /* no more than the qualify time */
    for (int k = 1; k < MONITOR_WINDOW_QUALIFY_STEPS; k++) {
        TEST_ASSERT_TRUE(monitor_window_judge(&window, false));
    }
    TEST_ASSERT_FALSE(monitor_window_judge(&window, false));
    TEST_ASSERT_FALSE(monitor_window_judge(&window, false));
}

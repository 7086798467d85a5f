/* SPDX-License-Identifier: Apache-2.0 */
#include "app/supervisor.h"
#include "unity.h"

enum { FAST_Hz = 20000, SLOW_Hz = 1000, FAST_A_SLOW_STEP = FAST_Hz / SLOW_Hz };

static supervisor_t supervisor;
static supervisor_counts_t now;

void setUp(void)
{
    const supervisor_counts_t zero = {0};
    now = zero;
    supervisor_init(&supervisor, FAST_Hz, SLOW_Hz);
}

void tearDown(void) {}

/* One millisecond with these numbers of steps, then one call of the supervisor. */
static bool millisecond(int fast, int slow, int monitor_steps)
{
    now.fast_steps = (uint16_t)(now.fast_steps + fast);
    now.slow_steps = (uint16_t)(now.slow_steps + slow);
    now.monitor_steps = (uint16_t)(now.monitor_steps + monitor_steps);
    return supervisor_may_feed(&supervisor, now);
}

static int feedings(int milliseconds, int fast, int slow, int monitor_steps)
{
    int count = 0;
    for (int i = 0; i < milliseconds; i++) {
        count += millisecond(fast, slow, monitor_steps) ? 1 : 0;
    }
    return count;
}

void test_watchdog_is_fed_once_a_window_also_when_the_counters_wrap(void)
{
    const int milliseconds = 10000; /* the fast count wraps three times */
    TEST_ASSERT_EQUAL_INT(milliseconds / SUPERVISOR_WINDOW_STEPS,
                          feedings(milliseconds, FAST_A_SLOW_STEP, 1, 1));
}

/* 32 kHz are at most 47 kHz (STM32F405 data sheet, LSI oscillator). */
void test_watchdog_timeout_is_longer_than_three_windows_of_its_fastest_clock(void)
{
    TEST_ASSERT_TRUE(SUPERVISOR_TIMEOUT_ms * 32 / 47 >= 3 * SUPERVISOR_WINDOW_STEPS);
}

void test_watchdog_is_not_fed_when_the_fast_loop_stops(void)
{
    (void)feedings(100, FAST_A_SLOW_STEP, 1, 1);
    TEST_ASSERT_EQUAL_INT(0, feedings(1000, 0, 1, 1));
}

void test_watchdog_is_not_fed_when_the_slow_loop_stops(void)
{
    (void)feedings(100, FAST_A_SLOW_STEP, 1, 1);
    TEST_ASSERT_EQUAL_INT(0, feedings(1000, FAST_A_SLOW_STEP, 0, 1));
}

void test_watchdog_is_not_fed_when_the_monitor_stops(void)
{
    (void)feedings(100, FAST_A_SLOW_STEP, 1, 1);
    TEST_ASSERT_EQUAL_INT(0, feedings(1000, FAST_A_SLOW_STEP, 1, 0));
}

void test_watchdog_is_not_fed_when_the_two_clocks_differ_by_half(void)
{
    (void)feedings(100, FAST_A_SLOW_STEP, 1, 1);
    TEST_ASSERT_EQUAL_INT(0, feedings(1000, FAST_A_SLOW_STEP / 2, 1, 1));
    setUp();
    (void)feedings(100, FAST_A_SLOW_STEP, 1, 1);
    TEST_ASSERT_EQUAL_INT(0, feedings(1000, FAST_A_SLOW_STEP * 3 / 2, 1, 1));
}

void test_clocks_may_differ_by_a_tenth(void)
{
    TEST_ASSERT_TRUE(feedings(1000, FAST_A_SLOW_STEP * 9 / 10, 1, 1) > 100);
    TEST_ASSERT_TRUE(feedings(1000, FAST_A_SLOW_STEP * 11 / 10, 1, 1) > 100);
}

void test_watchdog_is_fed_after_a_delayed_background(void)
{
    (void)feedings(100, FAST_A_SLOW_STEP, 1, 1);
    TEST_ASSERT_TRUE(millisecond(17 * FAST_A_SLOW_STEP, 17, 17));
}

void test_slowest_pwm_frequency_is_supervised(void)
{
    supervisor_init(&supervisor, 4000, SLOW_Hz);
    TEST_ASSERT_EQUAL_INT(1000 / SUPERVISOR_WINDOW_STEPS, feedings(1000, 4, 1, 1));
    TEST_ASSERT_EQUAL_INT(0, feedings(1000, 1, 1, 1));
}

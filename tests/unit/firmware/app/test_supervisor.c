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

/* One millisecond, in which the parts step as often as sent; asked once afterwards. */
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

void test_a_healthy_controller_is_fed_once_a_window_also_when_the_counters_wrap(void)
{
    const int milliseconds = 10000; /* the fast count wraps three times */
    TEST_ASSERT_EQUAL_INT(milliseconds / SUPERVISOR_WINDOW_STEPS,
                          feedings(milliseconds, FAST_A_SLOW_STEP, 1, 1));
}

/* 32 kHz are at most 47 kHz (STM32F405 data sheet, LSI oscillator). */
void test_the_watchdog_waits_longer_than_three_windows_of_its_fastest_clock(void)
{
    TEST_ASSERT_TRUE(SUPERVISOR_TIMEOUT_ms * 32 / 47 >= 3 * SUPERVISOR_WINDOW_STEPS);
}

void test_it_starves_when_the_fast_loop_stops(void)
{
    (void)feedings(100, FAST_A_SLOW_STEP, 1, 1);
    TEST_ASSERT_EQUAL_INT(0, feedings(1000, 0, 1, 1));
}

void test_it_starves_when_the_slow_loop_stops(void)
{
    (void)feedings(100, FAST_A_SLOW_STEP, 1, 1);
    TEST_ASSERT_EQUAL_INT(0, feedings(1000, FAST_A_SLOW_STEP, 0, 1));
}

void test_it_starves_when_the_monitor_makes_no_step(void)
{
    (void)feedings(100, FAST_A_SLOW_STEP, 1, 1);
    TEST_ASSERT_EQUAL_INT(0, feedings(1000, FAST_A_SLOW_STEP, 1, 0));
}

void test_it_starves_when_the_two_clocks_disagree_by_half(void)
{
    (void)feedings(100, FAST_A_SLOW_STEP, 1, 1);
    TEST_ASSERT_EQUAL_INT(0, feedings(1000, FAST_A_SLOW_STEP / 2, 1, 1));
    setUp();
    (void)feedings(100, FAST_A_SLOW_STEP, 1, 1);
    TEST_ASSERT_EQUAL_INT(0, feedings(1000, FAST_A_SLOW_STEP * 3 / 2, 1, 1));
}

void test_a_tenth_of_disagreement_is_tolerated(void)
{
    TEST_ASSERT_TRUE(feedings(1000, FAST_A_SLOW_STEP * 9 / 10, 1, 1) > 100);
    TEST_ASSERT_TRUE(feedings(1000, FAST_A_SLOW_STEP * 11 / 10, 1, 1) > 100);
}

void test_a_background_that_was_held_up_still_feeds_afterwards(void)
{
    (void)feedings(100, FAST_A_SLOW_STEP, 1, 1);
    TEST_ASSERT_TRUE(millisecond(17 * FAST_A_SLOW_STEP, 17, 17));
}

void test_the_slowest_pwm_is_supervised_as_well(void)
{
    supervisor_init(&supervisor, 4000, SLOW_Hz);
    TEST_ASSERT_EQUAL_INT(1000 / SUPERVISOR_WINDOW_STEPS, feedings(1000, 4, 1, 1));
    TEST_ASSERT_EQUAL_INT(0, feedings(1000, 1, 1, 1));
}

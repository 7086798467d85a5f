/* SPDX-License-Identifier: Apache-2.0 */
/* The report that the slow step takes is of the latest PWM period, whatever the two timers do. */
#include "app/double_buffer.h"
#include "app/report_timer.h"
#include "unity.h"

void setUp(void) {}

void tearDown(void) {}

typedef struct {
    int copies;
    int oldest_periods; /* of a report that was taken, after the first one */
} run_t;

/* A second of both timers. The slow step comes `phase` of a period after a sample, and up to
 * `late` periods late. */
static run_t run(uint32_t fast_rate_Hz, double phase, double late)
{
    report_timer_t timer;
    double_buffer_t pair;
    int report[2] = {0, 0};
    report_timer_init(&timer, fast_rate_Hz, 1000);
    double_buffer_init(&pair);
    run_t out = {.copies = 0};
    const double periods_per_step = fast_rate_Hz / 1000.0;
    double next = periods_per_step + phase;
    for (int period = 1; period <= (int)fast_rate_Hz; period++) {
        const unsigned high = double_buffer_high(&pair);
        if (report_timer_is_due(&timer, high)) {
            report[high] = period;
            double_buffer_mark(&pair);
            out.copies++;
        }
        if (period + 1 > next) { /* before the next period */
            const int steps = (int)(next / periods_per_step);
            if (double_buffer_take(&pair) && steps > 1) {
                const int age = period - report[double_buffer_low(&pair)];
                out.oldest_periods = age > out.oldest_periods ? age : out.oldest_periods;
            } else {
                TEST_ASSERT_TRUE_MESSAGE(steps <= 1, "every slow step finds a new report");
            }
            next = (steps + 1) * periods_per_step + phase + (steps % 2 == 0 ? late : 0.0);
        }
    }
    return out;
}

void test_the_report_is_that_of_the_latest_period_and_copied_at_most_three_times_a_step(void)
{
    static const uint32_t RATES_Hz[] = {4000, 15500, 16000, 20000, 20001, 24700, 40000};
    for (int k = 0; k < 7; k++) {
        for (double phase = 0.05; phase < 1.0; phase += 0.1) {
            const run_t out = run(RATES_Hz[k], phase, 0.0);
            TEST_ASSERT_EQUAL_INT(0, out.oldest_periods);
            TEST_ASSERT_TRUE(out.copies <= 3 * 1000);
        }
    }
}

void test_a_slow_step_late_by_one_period_reads_the_latest_report(void)
{
    TEST_ASSERT_EQUAL_INT(0, run(20000, 0.3, 0.9).oldest_periods);
}

void test_an_uncopied_report_stays_due(void)
{
    report_timer_t timer;
    report_timer_init(&timer, 20000, 1000);
    for (int period = 1; period < 100; period++) {
        TEST_ASSERT_EQUAL(period >= 19, report_timer_is_due(&timer, 0));
    }
    TEST_ASSERT_FALSE(report_timer_is_due(&timer, 1));
}

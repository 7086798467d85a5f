/* SPDX-License-Identifier: Apache-2.0 */
/* Mean values of the averaging window from the fast loop's sums. */
#include <string.h>

#include "foc/mean_values.h"
#include "unity.h"

static mean_values_state_t state;
static fast_report_t report;

void setUp(void)
{
    memset(&report, 0, sizeof(report));
    mean_values_init(&state, 12345);
}

void tearDown(void) {}

/* One fast step with these values. */
static void add(int32_t d, int32_t q, int32_t power, int32_t v_dc)
{
    report.sums.i_d_pu += (uint32_t)d;
    report.sums.i_q_pu += (uint32_t)q;
    report.sums.power_pu += (uint32_t)power;
    report.sums.v_dc_pu += (uint32_t)v_dc;
    report.sequence++;
}

void test_initial_means_are_the_given_bus_voltage_and_zero_current(void)
{
    const mean_values_t out = mean_values_step(&state, &report);
    TEST_ASSERT_EQUAL_INT32(12345, out.v_dc_pu);
    TEST_ASSERT_EQUAL_INT32(0, out.i_pu.q);
}

void test_each_window_has_the_mean_of_its_own_steps(void)
{
    for (int look = 0; look < 4; look++) {
        int32_t sum = 0;
        for (int n = 0; n < 20; n++) {
            add(-100 * look, 7 * n - 50 * look, 3000 * look, 28000 + n);
            sum += 7 * n - 50 * look;
        }
        const mean_values_t out = mean_values_step(&state, &report);
        TEST_ASSERT_EQUAL_INT32(-100 * look, out.i_pu.d);
        TEST_ASSERT_EQUAL_INT32(sum / 20, out.i_pu.q);
        TEST_ASSERT_EQUAL_INT32(3000 * look, out.power_pu);
        TEST_ASSERT_EQUAL_INT32(28009, out.v_dc_pu); /* 28000 + 9.5, towards zero */
    }
}

void test_mean_is_unchanged_without_a_new_step(void)
{
    add(-300, 400, 500, 28000);
    (void)mean_values_step(&state, &report);
    const mean_values_t out = mean_values_step(&state, &report);
    TEST_ASSERT_EQUAL_INT32(-300, out.i_pu.d);
    TEST_ASSERT_EQUAL_INT32(28000, out.v_dc_pu);
}

void test_sums_and_counter_may_wrap_in_either_direction(void)
{
    for (int sign = -1; sign <= 1; sign += 2) {
        setUp();
        for (int look = 0; look < 10000;
             look++) { /* 200 000 steps: the sums wrap twice, the counter three times */
            for (int n = 0; n < 20; n++) {
                add(sign * 50000, -sign * 50000, sign * 40000, 32760);
            }
            const mean_values_t out = mean_values_step(&state, &report);
            TEST_ASSERT_EQUAL_INT32(sign * 50000, out.i_pu.d);
            TEST_ASSERT_EQUAL_INT32(-sign * 50000, out.i_pu.q);
            TEST_ASSERT_EQUAL_INT32(sign * 40000, out.power_pu);
            TEST_ASSERT_EQUAL_INT32(32760, out.v_dc_pu);
        }
    }
}

void test_the_largest_values_over_the_most_steps_do_not_overflow(void)
{
    for (int32_t n = 0; n < 40000; n++) {
        add(-50200, 50200, -50200, 32760);
    }
    const mean_values_t out = mean_values_step(&state, &report);
    TEST_ASSERT_EQUAL_INT32(-50200, out.i_pu.d);
    TEST_ASSERT_EQUAL_INT32(50200, out.i_pu.q);
}

/* SPDX-License-Identifier: Apache-2.0 */
/* The low-pass against the exponential step response. */
#include <math.h>

#include "core/filter.h"
#include "unity.h"

void setUp(void) {}

void tearDown(void) {}

void test_a_step_follows_the_exponential(void)
{
    /* y_n = x (1 - (1 - 2^-shift)^n); the state is rounded by less than one step of y. */
    for (unsigned shift = 1; shift <= 10; shift++) {
        filter_t filter = {0};
        for (int n = 1; n <= 4000; n++) {
            const double exact = 20000.0 * (1.0 - pow(1.0 - ldexp(1.0, -(int)shift), n));
            TEST_ASSERT_DOUBLE_WITHIN(1.0, exact, filter_step(&filter, 20000, shift));
        }
    }
}

void test_output_settles_exactly_on_any_constant_from_both_sides(void)
{
    static const int32_t TARGETS[] = {-32768, -777, -1, 0, 1, 5, 12345, 32767};
    for (unsigned i = 0; i < sizeof(TARGETS) / sizeof(TARGETS[0]); i++) {
        for (int32_t start = -32768; start <= 32768; start += 65536) {
            filter_t filter;
            filter_reset(&filter, start, 4);
            int32_t y = 0;
            for (int n = 0; n < 1000; n++) {
                y = filter_step(&filter, TARGETS[i], 4);
            }
            TEST_ASSERT_EQUAL_INT32(TARGETS[i], y);
        }
    }
}

void test_reset_sets_the_output(void)
{
    filter_t filter;
    for (int32_t x = -32768; x <= 32767; x++) {
        filter_reset(&filter, x, 6);
        TEST_ASSERT_EQUAL_INT32(x, filter_step(&filter, x, 6));
    }
}

void test_the_largest_documented_input_does_not_overflow(void)
{
    /* |x| 2^shift < 2^30 */
    filter_t filter;
    filter_reset(&filter, (1 << 26) - 1, 4);
    for (int n = 0; n < 1000; n++) {
        const int32_t y = filter_step(&filter, n % 2 == 0 ? -((1 << 26) - 1) : (1 << 26) - 1, 4);
        TEST_ASSERT_TRUE(y <= (1 << 26) - 1 && y >= -(1 << 26));
    }
}

void test_the_output_never_overshoots(void)
{
    filter_t filter = {0};
    int32_t before = 0;
    for (int n = 0; n < 500; n++) {
        const int32_t y = filter_step(&filter, 30000, 5);
        TEST_ASSERT_TRUE(y >= before && y <= 30000);
        before = y;
    }
}

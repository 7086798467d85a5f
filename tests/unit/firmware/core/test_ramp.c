/* SPDX-License-Identifier: Apache-2.0 */
/* The rate limiter, also at the ends of int32. */
#include "core/ramp.h"
#include "unity.h"

void setUp(void) {}

void tearDown(void) {}

void test_output_moves_by_the_step_and_ends_exactly_at_the_target(void)
{
    TEST_ASSERT_EQUAL_INT32(13, ramp_step(10, 20, 3));
    TEST_ASSERT_EQUAL_INT32(7, ramp_step(10, -20, 3));
    TEST_ASSERT_EQUAL_INT32(20, ramp_step(19, 20, 3)); /* never past the target */
    TEST_ASSERT_EQUAL_INT32(20, ramp_step(17, 20, 3));
    TEST_ASSERT_EQUAL_INT32(-20, ramp_step(-18, -20, 3));
    TEST_ASSERT_EQUAL_INT32(5, ramp_step(5, 5, 3));
}

void test_output_is_constant_with_a_step_of_zero(void)
{
    TEST_ASSERT_EQUAL_INT32(10, ramp_step(10, 20, 0));
    TEST_ASSERT_EQUAL_INT32(10, ramp_step(10, -20, 0));
}

void test_ramp_between_the_ends_of_int32_does_not_overflow(void)
{
    TEST_ASSERT_EQUAL_INT32(INT32_MIN + 100, ramp_step(INT32_MIN, INT32_MAX, 100));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX - 100, ramp_step(INT32_MAX, INT32_MIN, 100));
    TEST_ASSERT_EQUAL_INT32(-1, ramp_step(INT32_MIN, INT32_MAX, INT32_MAX)); /* -2^31 + 2^31 - 1 */
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, ramp_step(INT32_MAX - 1, INT32_MAX, INT32_MAX));
}

void test_number_of_steps_is_the_distance_over_the_step_rounded_up(void)
{
    for (int32_t step = 1; step < 50; step += 7) {
        int32_t value = -317;
        int steps = 0;
        while (value != 500) {
            const int32_t next = ramp_step(value, 500, step);
            TEST_ASSERT_TRUE(next > value && next - value <= step && next <= 500);
            value = next;
            steps++;
        }
        TEST_ASSERT_EQUAL_INT((817 + step - 1) / step, steps);
    }
}

/* SPDX-License-Identifier: Apache-2.0 */
#include "core/fade.h"
#include "unity.h"

void setUp(void) {}

void tearDown(void) {}

void test_fade_is_one_on_one_side_zero_on_the_other_and_linear_between(void)
{
    /* Falling with x, as for temperature: one at 100, zero at 200. At 125: 0.75 * 32768. */
    TEST_ASSERT_EQUAL_INT32(Q15_ONE, fade_q15(100, 100, 200));
    TEST_ASSERT_EQUAL_INT32(Q15_ONE, fade_q15(INT32_MIN, 100, 200));
    TEST_ASSERT_EQUAL_INT32(24576, fade_q15(125, 100, 200));
    TEST_ASSERT_EQUAL_INT32(0, fade_q15(200, 100, 200));
    TEST_ASSERT_EQUAL_INT32(0, fade_q15(INT32_MAX, 100, 200));
    /* Rising with x, as for speed: one at 200, zero at 100. */
    TEST_ASSERT_EQUAL_INT32(Q15_ONE, fade_q15(200, 200, 100));
    TEST_ASSERT_EQUAL_INT32(Q15_ONE, fade_q15(INT32_MAX, 200, 100));
    TEST_ASSERT_EQUAL_INT32(24576, fade_q15(175, 200, 100));
    TEST_ASSERT_EQUAL_INT32(0, fade_q15(100, 200, 100));
    TEST_ASSERT_EQUAL_INT32(0, fade_q15(INT32_MIN, 200, 100));
}

void test_fade_is_monotonic(void)
{
    for (int32_t x = 90; x < 210; x++) {
        TEST_ASSERT_GREATER_OR_EQUAL_INT32(fade_q15(x + 1, 100, 200), fade_q15(x, 100, 200));
        TEST_ASSERT_GREATER_OR_EQUAL_INT32(fade_q15(x, 200, 100), fade_q15(x + 1, 200, 100));
    }
}

void test_fade_of_zero_width_is_a_step_that_includes_its_end(void)
{
    TEST_ASSERT_EQUAL_INT32(Q15_ONE, fade_q15(100, 100, 100));
    TEST_ASSERT_EQUAL_INT32(0, fade_q15(101, 100, 100));
}

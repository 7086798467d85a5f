/* SPDX-License-Identifier: Apache-2.0 */
#include "random_values.h"
#include "torque/limit.h"
#include "unity.h"

void setUp(void) {}

void tearDown(void) {}

void test_a_limit_below_zero_counts_as_zero(void)
{
    TEST_ASSERT_EQUAL_INT32(0, limit_init(-1, REASON_MAX_TORQUE).torque_mNm);
    TEST_ASSERT_EQUAL_INT32(0, limit_init(INT32_MIN, REASON_MAX_TORQUE).torque_mNm);
    limit_t limit = limit_init(1000, REASON_MAX_TORQUE);
    limit_tighten(&limit, INT32_MIN, REASON_MAX_POWER);
    TEST_ASSERT_EQUAL_INT32(0, limit.torque_mNm);
    TEST_ASSERT_EQUAL_INT(REASON_MAX_POWER, limit.reason);
}

void test_tightest_bound_wins_and_sets_the_reason(void)
{
    limit_t limit = limit_init(1000, REASON_MAX_TORQUE);
    limit_tighten(&limit, 800, REASON_MAX_POWER);
    limit_tighten(&limit, 900, REASON_PHASE_CURRENT);
    TEST_ASSERT_EQUAL_INT32(800, limit.torque_mNm);
    TEST_ASSERT_EQUAL_INT(REASON_MAX_POWER, limit.reason);
}

void test_earlier_reason_wins_on_a_tie(void)
{
    limit_t limit = limit_init(1000, REASON_MAX_TORQUE);
    limit_tighten(&limit, 1000, REASON_MAX_POWER);
    TEST_ASSERT_EQUAL_INT(REASON_MAX_TORQUE, limit.reason);
}

void test_the_order_of_bounds_does_not_change_the_torque(void)
{
    random_t random = random_seeded(1);
    for (int n = 0; n < 1000; n++) {
        const int32_t a = random_between(&random, -1000, 100000);
        const int32_t b = random_between(&random, -1000, 100000);
        limit_t one = limit_init(50000, REASON_MAX_TORQUE);
        limit_t other = one;
        limit_tighten(&one, a, REASON_MAX_POWER);
        limit_tighten(&one, b, REASON_PHASE_CURRENT);
        limit_tighten(&other, b, REASON_PHASE_CURRENT);
        limit_tighten(&other, a, REASON_MAX_POWER);
        TEST_ASSERT_EQUAL_INT32(one.torque_mNm, other.torque_mNm);
    }
}

void test_fade_is_one_on_one_side_zero_on_the_other_and_linear_between(void)
{
    /* Falling with x, as for temperature: one at 100, zero at 200. At 125: 0.75 * 32768. */
    TEST_ASSERT_EQUAL_INT32(Q15_ONE, limit_fade_q15(100, 100, 200));
    TEST_ASSERT_EQUAL_INT32(Q15_ONE, limit_fade_q15(INT32_MIN, 100, 200));
    TEST_ASSERT_EQUAL_INT32(24576, limit_fade_q15(125, 100, 200));
    TEST_ASSERT_EQUAL_INT32(0, limit_fade_q15(200, 100, 200));
    TEST_ASSERT_EQUAL_INT32(0, limit_fade_q15(INT32_MAX, 100, 200));
    /* Rising with x, as for speed: one at 200, zero at 100. */
    TEST_ASSERT_EQUAL_INT32(Q15_ONE, limit_fade_q15(200, 200, 100));
    TEST_ASSERT_EQUAL_INT32(Q15_ONE, limit_fade_q15(INT32_MAX, 200, 100));
    TEST_ASSERT_EQUAL_INT32(24576, limit_fade_q15(175, 200, 100));
    TEST_ASSERT_EQUAL_INT32(0, limit_fade_q15(100, 200, 100));
    TEST_ASSERT_EQUAL_INT32(0, limit_fade_q15(INT32_MIN, 200, 100));
}

void test_fade_is_monotonic(void)
{
    for (int32_t x = 90; x < 210; x++) {
        TEST_ASSERT_GREATER_OR_EQUAL_INT32(limit_fade_q15(x + 1, 100, 200),
                                           limit_fade_q15(x, 100, 200));
        TEST_ASSERT_GREATER_OR_EQUAL_INT32(limit_fade_q15(x, 200, 100),
                                           limit_fade_q15(x + 1, 200, 100));
    }
}

void test_fade_of_zero_width_is_a_step_that_includes_its_end(void)
{
    TEST_ASSERT_EQUAL_INT32(Q15_ONE, limit_fade_q15(100, 100, 100));
    TEST_ASSERT_EQUAL_INT32(0, limit_fade_q15(101, 100, 100));
}

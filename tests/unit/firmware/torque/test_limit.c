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

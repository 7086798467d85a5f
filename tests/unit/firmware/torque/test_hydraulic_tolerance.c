/* SPDX-License-Identifier: Apache-2.0 */
/* What a healthy brake may do without a finding, in whole numbers. */
#include <stdint.h>
#include <string.h>

#include "../../../../firmware/torque/hydraulic_tolerance.h"
#include "unity.h"

static hydraulic_watch_t watch;

void setUp(void)
{
    memset(&watch, 0, sizeof watch);
}

void tearDown(void) {}

/* A fifth of the brake's torque and a tenth of the known one, of either sign. */
void test_a_torque_that_comes_at_once_counts_by_its_parts(void)
{
    TEST_ASSERT_EQUAL_INT32(200 + 100, hydraulic_unfollowed_mNm(&watch, 1000, 1000, 0));
    TEST_ASSERT_EQUAL_INT32(200 + 200, hydraulic_unfollowed_mNm(&watch, -1000, -2000, 0));
    TEST_ASSERT_EQUAL_INT32(0, watch.hydraulic_q4_mNm);
    TEST_ASSERT_EQUAL_INT32(0, watch.known_q4_mNm);
}

/* A road that changes by 1 mN m in a millisecond takes up as much of either part in each. */
void test_a_road_takes_up_both_parts_at_its_own_rate(void)
{
    for (int32_t ms = 1; ms <= 100; ms++) {
        TEST_ASSERT_EQUAL_INT32(300 - 2 * ms, hydraulic_unfollowed_mNm(&watch, 1000, 1000, 256));
    }
    TEST_ASSERT_EQUAL_INT32(16 * 500, watch.hydraulic_q4_mNm);
    TEST_ASSERT_EQUAL_INT32(16 * 1000, watch.known_q4_mNm);
    for (int32_t ms = 1; ms <= 100; ms++) {
        TEST_ASSERT_EQUAL_INT32(100 - ms, hydraulic_unfollowed_mNm(&watch, 1000, 1000, 256));
    }
    TEST_ASSERT_EQUAL_INT32(200 - 1, hydraulic_unfollowed_mNm(&watch, 0, 1000, 256));
}

/* 2^15 mN m a millisecond at most, five times that of the brake's torque: 2^24 need 103 ms. */
void test_the_fastest_road_is_limited_and_needs_no_wider_numbers(void)
{
    const int32_t torque_mNm = (1 << 24) - 1;
    TEST_ASSERT_EQUAL_INT32((torque_mNm - 5 * (1 << 15)) / 5 + (torque_mNm - 10 * (1 << 15)) / 10,
                            hydraulic_unfollowed_mNm(&watch, torque_mNm, torque_mNm, INT32_MAX));
    for (int32_t ms = 2; ms <= 103; ms++) {
        (void)hydraulic_unfollowed_mNm(&watch, torque_mNm, -torque_mNm, INT32_MAX);
    }
    TEST_ASSERT_EQUAL_INT32(16 * torque_mNm, watch.hydraulic_q4_mNm);
    TEST_ASSERT_EQUAL_INT32(-16 * torque_mNm, watch.known_q4_mNm);
}

void test_three_quarters_of_the_spread_may_be_late(void)
{
    TEST_ASSERT_EQUAL_INT32(300, hydraulic_late_mNm(400));
    TEST_ASSERT_EQUAL_INT32(3, hydraulic_late_mNm(3));
    TEST_ASSERT_EQUAL_INT32(0, hydraulic_late_mNm(0));
}

void test_a_finding_without_reports_needs_a_sixteenth_more(void)
{
    TEST_ASSERT_EQUAL_INT32(1700, hydraulic_end_mNm_ms(1600));
    TEST_ASSERT_EQUAL_INT32(((1 << 26) - 1) * 17, hydraulic_end_mNm_ms(INT32_MAX));
}

void test_the_sum_stays_between_zero_and_its_end(void)
{
    TEST_ASSERT_EQUAL_INT32(70, hydraulic_summed(50, 20, 100));
    TEST_ASSERT_EQUAL_INT32(100, hydraulic_summed(50, 51, 100));
    TEST_ASSERT_EQUAL_INT32(0, hydraulic_summed(50, -51, 100));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, hydraulic_summed(INT32_MAX, INT32_MAX, INT32_MAX));
}

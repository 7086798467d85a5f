/* SPDX-License-Identifier: Apache-2.0 */
/* Reports of less torque than the hydraulic brake makes by the gain that is learned, beside single
 * states of its model. */
#include "hydraulic_feedback_states.h"

void setUp(void)
{
    states_up();
}

void tearDown(void) {}

/* A gain of one has been learned to 39900/40000, 32686, less three: 39896 mN m, and 5 N m less. */
void test_a_report_short_of_the_learned_gain_is_outside_and_leaves_that_to_the_motor(void)
{
    settled(40000, 40000, 60);
    settled(40000, 34896, 1);
    TEST_ASSERT_EQUAL_INT32(0, state.outside_ms);
    TEST_ASSERT_EQUAL_INT32(34896, out.torque_mNm);
    begin();
    settled(40000, 40000, 60);
    settled(40000, 34895, 1);
    TEST_ASSERT_EQUAL_INT32(-1, state.outside_ms);
    settled(40000, 20000, 1);
    TEST_ASSERT_TRUE(out.used);
    TEST_ASSERT_INT32_WITHIN(500, 40000 - 5000, out.torque_mNm);
    state.confirmed = true;
    settled(40000, 20000, 1);
    TEST_ASSERT_EQUAL_INT32(20000, out.torque_mNm);
}

/* While no gain above the lowest has been learned, what is short of the band teaches none either:
 * less than the timeout long the gain stays, then it is one again. */
void test_reports_short_of_the_band_from_the_beginning_teach_no_gain(void)
{
    settled(40000, 30000, 3); /* the lowest gain: allowed */
    const int32_t gain_q15 = state.gain_q15;
    TEST_ASSERT_LESS_THAN_INT32(ONE_q15, gain_q15);
    settled(40000, 20000, TIMEOUT_ms);
    TEST_ASSERT_EQUAL_INT32(gain_q15, state.gain_q15);
    settled(40000, 20000, 1);
    assert_interval(LOWEST_q15, HIGHEST_q15);
    TEST_ASSERT_EQUAL_INT32(ONE_q15, state.gain_q15);
}

/* 34995/40000 is 28667: a quarter of the way down from 40100/40000, 32849, and three, and a 16th of
 * what is left between the ends for the other one. The timeout changes none of it. */
void test_reports_short_of_the_learned_gain_teach_it_slowly(void)
{
    settled(40000, 40000, 60);
    settled(40000, 34895, 1);
    TEST_ASSERT_EQUAL_INT32(-1, state.outside_ms);
    const int32_t most_q15 = 32852 - (32852 - 28667) / 4;
    const int32_t both_q15 = 32683 - (32683 - most_q15) / 16;
    assert_interval(both_q15, both_q15);
    settled(40000, 20000, TIMEOUT_ms + 1);
    TEST_ASSERT_LESS_THAN_INT32(-TIMEOUT_ms, state.outside_ms);
    TEST_ASSERT_LESS_THAN_INT32(both_q15, state.most_q15);
    TEST_ASSERT_GREATER_THAN_INT32(LOWEST_q15, state.least_q15);
}

/* A learned gain of one unit above the lowest is one, and so is any that is confirmed. */
void test_the_lowest_gain_is_no_learned_one_until_it_is_confirmed(void)
{
    for (int way = 0; way < 3; way++) {
        begin();
        state.least_q15 = way == 1 ? LOWEST_q15 + 1 : LOWEST_q15;
        state.confirmed = way == 2;
        settled(40000, 20000, 1);
        TEST_ASSERT_EQUAL_INT32(-1, state.outside_ms);
        TEST_ASSERT_EQUAL_INT32(way == 0 ? HIGHEST_q15 : HIGHEST_q15 - 4096, state.most_q15);
        settled(40000, 20000, TIMEOUT_ms + 1);
        TEST_ASSERT_EQUAL_INT32(way == 0 ? ONE_q15 : state.most_q15, state.gain_q15);
    }
}

/* The first report is 15 N m below the model's 40 and just within what the lowest gain makes; the
 * second is 1 mN m below, and counts as the model less 5 N m. */
void test_only_a_report_short_of_the_learned_gain_is_replaced(void)
{
    settled(40000, 25000, 1);
    TEST_ASSERT_EQUAL_INT32(0, state.outside_ms);
    TEST_ASSERT_EQUAL_INT32(25000, out.torque_mNm);
    begin();
    settled(40000, 24999, 1);
    TEST_ASSERT_EQUAL_INT32(-1, state.outside_ms);
    TEST_ASSERT_EQUAL_INT32(35000, out.torque_mNm);
}

/* Reports that fall by 10 N m each, of a torque that has left since: below zero as its model less
 * 5 N m, and as its slope. */
void test_a_replaced_report_is_no_torque_below_zero(void)
{
    settled(40000, 20000, 1);
    settled(40000, 10000, 1);
    modelled(0, 0, 0);
    silent();
    silent();
    TEST_ASSERT_EQUAL_INT32(-2, state.outside_ms);
    TEST_ASSERT_EQUAL_INT32(0, out.torque_mNm);
}

/* Refuted reports are not used until they have agreed with the commands for the heal time, although
 * they are within the tolerance; meanwhile they teach nothing. */
void test_refuted_reports_heal_only_by_agreeing(void)
{
    settled(10000, 10000, 60);
    state.refuted = true;
    state.heal_ms = HYDRAULIC_FEEDBACK_HEAL_ms;
    settled(10000, 2000, 2 * HYDRAULIC_FEEDBACK_HEAL_ms);
    TEST_ASSERT_TRUE(out.lost);
    assert_interval(LOWEST_q15, HIGHEST_q15);
    settled(10000, 9000, HYDRAULIC_FEEDBACK_HEAL_ms - 1);
    TEST_ASSERT_TRUE(out.lost && state.refuted);
    assert_interval(LOWEST_q15, HIGHEST_q15);
    settled(10000, 9000, 1);
    TEST_ASSERT_TRUE(out.used);
    TEST_ASSERT_FALSE(state.refuted);
}

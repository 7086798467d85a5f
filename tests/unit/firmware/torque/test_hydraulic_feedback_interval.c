/* SPDX-License-Identifier: Apache-2.0 */
/* Single reports beside single states of the model of the hydraulic brake: what each leaves of the
 * interval of gains, and every limit of the bookkeeping. Reports short of that interval:
 * test_hydraulic_feedback_short.c; whole stops: test_hydraulic_feedback.c. */
#include "hydraulic_feedback_states.h"

void setUp(void)
{
    states_up();
}

void tearDown(void) {}

/* ---- the interval of gains ---- */

void test_the_gain_begins_with_one_in_the_whole_band(void)
{
    assert_interval(LOWEST_q15, HIGHEST_q15);
    TEST_ASSERT_EQUAL_INT32(ONE_q15, state.gain_q15);
    TEST_ASSERT_EQUAL_INT32(1, state.between_ms);
}

void test_a_torque_below_a_64th_of_the_largest_changes_no_gain(void)
{
    settled(SIGNIFICANT_mNm - 1, SIGNIFICANT_mNm - 1, 10);
    assert_interval(LOWEST_q15, HIGHEST_q15);
    /* 700/800 is 28672, 900/800 36864. */
    settled(SIGNIFICANT_mNm, SIGNIFICANT_mNm, 1);
    assert_interval(24576 + (28672 - 24576) / 4, 40960 - (40960 - 36864) / 4);
}

/* The last steps of a quarter are whole numbers: three units before the end they are zero. An end
 * that passes the other one takes it along, a 16th as fast, the last time 64 units before; beyond
 * the band as fast as itself. */
void test_lasting_reports_close_the_interval_and_leave_the_band_never(void)
{
    settled(10000, 10000, 60);
    assert_interval(32440 - 3, 33095 + 3);
    settled(10000, 5000, 800);
    assert_interval(LOWEST_q15 + 63, LOWEST_q15 + 63);
    settled(10000, 20000, 60);
    assert_interval(HIGHEST_q15 - 3, HIGHEST_q15 - 3);
    begin();
    settled(10000, 10000, 60); /* beyond 33095 + 3, which goes there in one step */
    settled(10000, 20000, 1);
    const int32_t least_q15 = 32440 - 3 + (HIGHEST_q15 - (32440 - 3)) / 4;
    assert_interval(least_q15, least_q15);
}

/* A brake of 64 mN m, whose noise is zero: the least a ratio is made of. */
void test_ratios_of_single_units_are_whole(void)
{
    config.brake.max_hydraulic_torque_mNm = 64;
    settled(1, 0, 1); /* no torque of 1 mN m: the lowest gain */
    assert_interval(LOWEST_q15, HIGHEST_q15 - (HIGHEST_q15 - LOWEST_q15) / 4);
    begin();
    modelled(0, 1, 0); /* of a model that may be zero it says nothing */
    reported(0, 0);
    assert_interval(LOWEST_q15, HIGHEST_q15);
    config.brake.max_hydraulic_torque_mNm = 0;
    begin();
    settled(0, 1, 1); /* a ratio to zero counts as one to 1 mN m */
    assert_interval(LOWEST_q15 + (ONE_q15 - LOWEST_q15) / 4, HIGHEST_q15);
}

/* ---- plausibility ---- */

/* 64 * 2^15 mN m: gains of 3/4 and 5/4 explain 64 * 24576 to 64 * 40960. */
void test_what_no_gain_in_the_band_explains_contradicts_beyond_the_tolerance(void)
{
    config.brake.max_hydraulic_torque_mNm = 20000000;
    const int32_t least_mNm = 64 * LOWEST_q15 - config.brake.hydraulic_tolerance_mNm;
    const int32_t most_mNm = 64 * HIGHEST_q15 + config.brake.hydraulic_tolerance_mNm;
    const int32_t cases[][2] = {{least_mNm, 0},
                                {least_mNm - 5, -5},
                                {most_mNm, 0},
                                {most_mNm + 7, 7},
                                {INT32_MIN, INT32_MIN}};
    for (int n = 0; n < 5; n++) {
        settled(64 * ONE_q15, cases[n][0], 1);
        TEST_ASSERT_EQUAL_INT32(cases[n][1], state.contradicts_mNm);
        TEST_ASSERT_TRUE(state.good == (cases[n][1] == 0));
    }
}

/* A quarter of the tolerance, 5 N m, is what a gain outside the band has to exceed. */
void test_the_time_outside_the_band_is_counted_to_either_side(void)
{
    const int32_t most_mNm = 12500 + 5000;
    const int32_t least_mNm = 7500 - 5000;
    settled(10000, most_mNm, 3);
    TEST_ASSERT_EQUAL_INT32(0, state.outside_ms);
    settled(10000, most_mNm + 1, 3);
    TEST_ASSERT_EQUAL_INT32(3, state.outside_ms);
    state.least_q15 = LOWEST_q15;
    settled(10000, least_mNm - 1, 5);
    TEST_ASSERT_EQUAL_INT32(-5, state.outside_ms);
    settled(10000, most_mNm + 1, 1);
    TEST_ASSERT_EQUAL_INT32(1, state.outside_ms);
    state.least_q15 = LOWEST_q15;
    settled(10000, least_mNm, 1);
    TEST_ASSERT_EQUAL_INT32(0, state.outside_ms);
    settled(10000, most_mNm + 1, INT16_MAX + 10);
    TEST_ASSERT_EQUAL_INT32(INT16_MAX, state.outside_ms);
    state.least_q15 = LOWEST_q15;
    settled(10000, least_mNm - 1, INT16_MAX + 10);
    TEST_ASSERT_EQUAL_INT32(-INT16_MAX, state.outside_ms);
}

/* ---- the age of reports ---- */

void test_reports_are_ignored_without_a_timeout(void)
{
    config.brake.hydraulic_timeout_ms = 0;
    reported(1000, 0);
    TEST_ASSERT_FALSE(state.seen);
    TEST_ASSERT_FALSE(out.used || out.lost);
    config.brake.hydraulic_timeout_ms = 1;
    reported(1000, 0);
    TEST_ASSERT_TRUE(state.seen);
}

/* ---- qualify and heal time ---- */

void test_reports_may_be_missing_for_the_timeout(void)
{
    settled(10000, 10000, 1);
    TEST_ASSERT_TRUE(out.used && !out.lost);
    for (int n = 0; n < TIMEOUT_ms; n++) {
        silent();
        TEST_ASSERT_TRUE(out.used);
    }
    silent();
    TEST_ASSERT_TRUE(out.lost && !out.used);
    /* What the brake made before says something of it still. */
    TEST_ASSERT_EQUAL_INT32(24576 + (32440 - 24576) / 4, state.least_q15);
}

enum { IMPLAUSIBLE_mNm = 100000 };

void test_reports_may_be_implausible_for_the_timeout_as_often_as_a_good_one_comes_between(void)
{
    for (int n = 0; n < 3; n++) {
        settled(10000, 10000, 1);
        settled(10000, IMPLAUSIBLE_mNm, TIMEOUT_ms);
        TEST_ASSERT_TRUE(out.used);
    }
    settled(10000, IMPLAUSIBLE_mNm, 1);
    TEST_ASSERT_TRUE(out.lost);
    assert_interval(LOWEST_q15, HIGHEST_q15); /* the gain is forgotten */
    TEST_ASSERT_EQUAL_INT32(10000, out.torque_mNm);
    state.bad_ms = INT32_MAX - 1; /* 24 days later */
    settled(10000, IMPLAUSIBLE_mNm, 2);
    TEST_ASSERT_EQUAL_INT32(INT32_MAX - 1, state.bad_ms);
}

void test_an_implausible_report_begins_the_heal_time_anew_to_its_last_millisecond(void)
{
    settled(10000, IMPLAUSIBLE_mNm, TIMEOUT_ms + 1);
    settled(10000, 10000, HYDRAULIC_FEEDBACK_HEAL_ms - 1);
    TEST_ASSERT_FALSE(out.used);
    settled(10000, IMPLAUSIBLE_mNm, 1);
    settled(10000, 10000, HYDRAULIC_FEEDBACK_HEAL_ms - 1);
    TEST_ASSERT_FALSE(out.used);
    settled(10000, 10000, 1);
    TEST_ASSERT_TRUE(out.used);
}

/* ---- the torque since the report ---- */

/* A torque of the model that changes each millisecond, gain one; two reports at the given slope,
 * and the torque some milliseconds after the second. */
static int32_t carried_mNm(int32_t model_slope, int32_t report_mNm, int32_t report_slope,
                           int32_t later_ms)
{
    const int32_t first_mNm = 20000;
    config.brake.hydraulic_timeout_ms = 200;
    config.brake.hydraulic_gain_band_q15 = 0;
    config.brake.hydraulic_tolerance_mNm = 1000000;
    begin();
    for (int32_t ms = 0; ms <= 70 + later_ms; ms++) {
        const int32_t now_mNm = first_mNm + model_slope * ms;
        modelled(now_mNm, now_mNm, now_mNm);
        if (ms == 60) {
            reported(report_mNm - 10 * report_slope, 0);
        } else if (ms == 70) {
            reported(report_mNm, 0);
        } else {
            silent();
        }
    }
    TEST_ASSERT_TRUE(out.used);
    return out.torque_mNm;
}

void test_torque_since_the_report_follows_the_smaller_of_both_slopes(void)
{
    for (int32_t later_ms = 0; later_ms <= 63; later_ms++) {
        TEST_ASSERT_EQUAL_INT32(20000 + 50 * later_ms, carried_mNm(100, 20000, 50, later_ms));
        TEST_ASSERT_EQUAL_INT32(20000 + 100 * later_ms, carried_mNm(100, 20000, 250, later_ms));
        TEST_ASSERT_EQUAL_INT32(20000 - 50 * later_ms, carried_mNm(-100, 20000, -50, later_ms));
        TEST_ASSERT_EQUAL_INT32(20000 - 100 * later_ms, carried_mNm(-100, 20000, -250, later_ms));
    }
}

void test_torque_since_the_report_stays_where_the_slopes_disagree(void)
{
    TEST_ASSERT_EQUAL_INT32(20000, carried_mNm(100, 20000, -50, 10));
    TEST_ASSERT_EQUAL_INT32(20000, carried_mNm(100, 20000, 0, 10));
    TEST_ASSERT_EQUAL_INT32(20000, carried_mNm(-100, 20000, 50, 10));
    TEST_ASSERT_EQUAL_INT32(20000, carried_mNm(0, 20000, 50, 10));
    TEST_ASSERT_EQUAL_INT32(20000, carried_mNm(0, 20000, -50, 10));
    TEST_ASSERT_EQUAL_INT32(20001, carried_mNm(1, 20000, 50, 1));
    TEST_ASSERT_EQUAL_INT32(19999, carried_mNm(-1, 20000, -50, 1));
}

void test_torque_is_carried_forward_for_63_ms_at_most_and_not_below_zero(void)
{
    TEST_ASSERT_EQUAL_INT32(20000 + 63 * 50, carried_mNm(100, 20000, 50, 64));
    TEST_ASSERT_EQUAL_INT32(20000 + 63 * 50, carried_mNm(100, 20000, 50, 150));
    TEST_ASSERT_EQUAL_INT32(20000 + 63 * 100, carried_mNm(100, 20000, 150, 150));
    TEST_ASSERT_EQUAL_INT32(0, carried_mNm(-100, 400, -100, 10));
    TEST_ASSERT_EQUAL_INT32(0, carried_mNm(0, 0, 0, 10));
}

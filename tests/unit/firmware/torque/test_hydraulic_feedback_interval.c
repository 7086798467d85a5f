/* SPDX-License-Identifier: Apache-2.0 */
/* Single reports beside single states of the model of the hydraulic brake: what each leaves of the
 * interval of gains, what it shows of the brake, and every limit of the bookkeeping. Whole stops:
 * test_hydraulic_feedback.c. */
#include "core/q15.h"
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
 * that passes the other one takes it along, a 16th as fast, the last time 64 units before. */
void test_lasting_reports_close_the_interval_and_leave_the_band_never(void)
{
    settled(10000, 10000, 60);
    assert_interval(32440 - 3, 33095 + 3);
    settled(10000, 5000, 800);
    assert_interval(LOWEST_q15 + 63, LOWEST_q15 + 63);
    settled(10000, 15000, 800);
    settled(10000, 20000, 800);
    assert_interval(HIGHEST_q15 - 63, HIGHEST_q15 - 63);
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

/* ---- what contradicts the commands ---- */

static void assert_shows(reason_t reason, int32_t counted_mNm)
{
    TEST_ASSERT_EQUAL_INT(reason, state.shows);
    TEST_ASSERT_EQUAL_INT32(counted_mNm, state.report_mNm);
}

/* 64 * 2^15 mN m: gains of 3/4 and 5/4 explain 64 * 24576 to 64 * 40960. */
void test_what_no_gain_in_the_band_explains_shows_a_wrong_brake_and_counts_as_the_end(void)
{
    config.brake.max_hydraulic_torque_mNm = 20000000;
    const int32_t least_mNm = 64 * LOWEST_q15 - TOLERANCE_mNm;
    const int32_t most_mNm = 64 * HIGHEST_q15 + TOLERANCE_mNm;
    const int32_t quarter_mNm = 64 * ONE_q15 / 4;
    settled(64 * ONE_q15, least_mNm, 1);
    assert_shows(REASON_NONE, least_mNm);
    settled(64 * ONE_q15, least_mNm - 1, 1);
    assert_shows(REASON_HYDRAULIC_WEAK, 64 * LOWEST_q15);
    settled(64 * ONE_q15, quarter_mNm, 1);
    assert_shows(REASON_HYDRAULIC_WEAK, 64 * LOWEST_q15);
    settled(64 * ONE_q15, quarter_mNm - 1, 1);
    assert_shows(REASON_HYDRAULIC_DEAD, 64 * LOWEST_q15);
    settled(64 * ONE_q15, INT32_MIN, 1);
    assert_shows(REASON_HYDRAULIC_DEAD, 64 * LOWEST_q15);
    settled(64 * ONE_q15, most_mNm, 1);
    assert_shows(REASON_NONE, most_mNm);
    settled(64 * ONE_q15, most_mNm + 1, 1);
    assert_shows(REASON_HYDRAULIC_STRONG, 64 * HIGHEST_q15);
    settled(64 * ONE_q15, INT32_MAX, 1);
    assert_shows(REASON_HYDRAULIC_STRONG, 64 * HIGHEST_q15);
}

/* Commands up to the tolerance are next to none. */
void test_too_much_torque_beside_next_to_no_command_is_a_brake_that_is_stuck(void)
{
    const int32_t most_mNm = TOLERANCE_mNm + TOLERANCE_mNm / 4 + TOLERANCE_mNm;
    settled(TOLERANCE_mNm, most_mNm + 1, 1);
    assert_shows(REASON_HYDRAULIC_STUCK, TOLERANCE_mNm + TOLERANCE_mNm / 4);
    settled(TOLERANCE_mNm + 4, most_mNm + 6, 1);
    assert_shows(REASON_HYDRAULIC_STRONG, TOLERANCE_mNm + TOLERANCE_mNm / 4 + 5);
    settled(0, 0, 1);
    assert_shows(REASON_NONE, 0);
}

/* Where early, nominal and late brakes differ the contradiction is with all of them, and the
 * nominal one counts. */
void test_a_report_that_contradicts_counts_as_that_of_a_brake_as_late_as_configured(void)
{
    modelled(40000, 80000, 20000);
    reported(20000 * 3 / 4 - TOLERANCE_mNm - 1, 0);
    assert_shows(REASON_HYDRAULIC_WEAK, 30000);
    begin();
    modelled(40000, 80000, 20000);
    reported(80000 * 5 / 4 + TOLERANCE_mNm + 1, 0);
    assert_shows(REASON_HYDRAULIC_STRONG, 50000);
}

/* ---- what is faster than the brake's lag ---- */

enum { BRAKE_mNm = 40000, HALF_LAG_ms = 30 };

/* A brake that has made its command for long, and its report after the one of 40 N m. */
static bool is_used(int32_t report_mNm, int32_t after_ms)
{
    const hydraulic_range_t steady = {BRAKE_mNm, BRAKE_mNm};
    begin();
    settled(BRAKE_mNm, BRAKE_mNm, 1);
    model.recent = model.before = steady;
    for (int ms = 1; ms < after_ms; ms++) {
        silent();
    }
    reported(report_mNm, 0);
    TEST_ASSERT_TRUE(out.used || (out.lost && state.heal_ms == HYDRAULIC_FEEDBACK_HEAL_ms));
    return out.used;
}

/* A gain of 3/4 or 5/4 is 10 N m away, of which a brake with a lag of 30 ms makes a 30th in each
 * millisecond; noise is twice the tolerance. */
void test_a_report_that_changes_faster_than_half_the_lag_permits_is_not_used(void)
{
    config.brake.hydraulic_time_constant_ms = 2 * HALF_LAG_ms;
    config.brake.hydraulic_timeout_ms = 1000;
    for (int32_t delay_ms = 0; delay_ms <= 10; delay_ms += 10) {
        config.brake.hydraulic_report_delay_ms = delay_ms;
        const int32_t times_ms[] = {1, 15, 19, 29, 62};
        for (int k = 0; k < 5; k++) {
            const int32_t whole_mNm = BRAKE_mNm / 4;
            const int32_t part_mNm = whole_mNm * (times_ms[k] + delay_ms) / HALF_LAG_ms;
            const int32_t most_mNm =
                (part_mNm < whole_mNm ? part_mNm : whole_mNm) + 2 * TOLERANCE_mNm;
            TEST_ASSERT_TRUE(is_used(BRAKE_mNm - most_mNm, times_ms[k]));
            TEST_ASSERT_FALSE(is_used(BRAKE_mNm - most_mNm - 1, times_ms[k]));
            TEST_ASSERT_TRUE(is_used(BRAKE_mNm + most_mNm, times_ms[k]));
            TEST_ASSERT_FALSE(is_used(BRAKE_mNm + most_mNm + 1, times_ms[k]));
        }
        TEST_ASSERT_TRUE(is_used(0, 63)); /* or longer, nobody knows */
    }
}

/* Beyond the band already, it may come back by what the noise is only. */
void test_a_report_beyond_the_band_may_change_towards_the_commands_alone(void)
{
    config.brake.hydraulic_time_constant_ms = 2 * HALF_LAG_ms;
    const hydraulic_range_t steady = {BRAKE_mNm, BRAKE_mNm};
    for (int more = 0; more <= 1; more++) {
        begin();
        settled(BRAKE_mNm, 60000, 1);
        model.recent = model.before = steady;
        reported(60000 + 2 * TOLERANCE_mNm + more, 0);
        TEST_ASSERT_EQUAL_INT(more == 0, out.used);
        begin();
        settled(BRAKE_mNm, 20000, 1);
        model.recent = model.before = steady;
        reported(20000 - 2 * TOLERANCE_mNm - more, 0);
        TEST_ASSERT_EQUAL_INT(more == 0, out.used);
    }
}

void test_neither_the_first_report_nor_one_beside_an_anti_lock_system_is_too_fast(void)
{
    const hydraulic_range_t none = {0, 0};
    model.recent = model.before = none;
    reported(200000, 0);
    TEST_ASSERT_TRUE(out.used);
    report.torque_mNm = 0;
    out = hydraulic_feedback_step(&state, &config, &model, &report, false);
    TEST_ASSERT_TRUE(out.used);
    reported(200000, 0);
    TEST_ASSERT_TRUE(out.lost);
}

void test_a_report_that_is_too_fast_begins_the_heal_time_anew_and_teaches_nothing_in_it(void)
{
    settled(BRAKE_mNm, BRAKE_mNm, 60);
    const int32_t least_q15 = state.least_q15, most_q15 = state.most_q15;
    settled(BRAKE_mNm, 200000, 1);
    TEST_ASSERT_TRUE(out.lost);
    settled(BRAKE_mNm, 0, HYDRAULIC_FEEDBACK_HEAL_ms);
    TEST_ASSERT_TRUE(out.lost); /* the first of them was too fast as well */
    assert_interval(least_q15, most_q15);
    settled(BRAKE_mNm, 0, 1);
    TEST_ASSERT_TRUE(out.used);
    TEST_ASSERT_LESS_THAN_INT32(least_q15, state.least_q15);
}

/* Reports that come 5 ms apart. */
static void every_5_ms(int32_t torque_mNm, int32_t report_mNm, int reports)
{
    modelled(torque_mNm, torque_mNm, torque_mNm);
    for (int n = 0; n < reports; n++) {
        for (int ms = 0; ms < 4; ms++) {
            silent();
        }
        reported(report_mNm, 0);
    }
}

void test_the_time_that_a_brake_is_short_is_from_the_first_such_report_to_the_last(void)
{
    every_5_ms(40000, 40000, 2);
    every_5_ms(40000, 10000, 4);
    TEST_ASSERT_EQUAL_INT32(15, state.short_ms);
    every_5_ms(0, 0, 2); /* nothing is commanded: it is still short */
    TEST_ASSERT_EQUAL_INT32(25, state.short_ms);
    every_5_ms(40000, 40000, 3);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, state.shows);
    TEST_ASSERT_EQUAL_INT32(25, state.short_ms);
    every_5_ms(40000, 10000, 1);
    TEST_ASSERT_EQUAL_INT32(0, state.short_ms);
    every_5_ms(40000, 10000, INT16_MAX / 5 + 2);
    TEST_ASSERT_EQUAL_INT32(INT16_MAX, state.short_ms);
}

/* An anti-lock system makes of the torque what it wants. */
void test_beside_an_anti_lock_system_a_report_is_the_torque_and_shows_nothing(void)
{
    settled(40000, 40000, 60);
    const int32_t least_q15 = state.least_q15, most_q15 = state.most_q15;
    const int32_t torques_mNm[] = {0, 40000, 200000};
    for (int n = 0; n < 3; n++) {
        report.torque_mNm = torques_mNm[n];
        out = hydraulic_feedback_step(&state, &config, &model, &report, false);
        assert_shows(REASON_NONE, torques_mNm[n]);
        TEST_ASSERT_EQUAL_INT32(torques_mNm[n], out.torque_mNm);
    }
    assert_interval(least_q15, most_q15);
    settled(40000, 0, 1);
    out = hydraulic_feedback_step(&state, &config, &model, &report, false);
    TEST_ASSERT_EQUAL_INT(REASON_HYDRAULIC_DEAD, state.shows); /* neither does it end anything */
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

void test_reports_that_return_are_used_after_the_heal_time_and_show_what_is_wrong_at_once(void)
{
    settled(10000, 0, 1);
    TEST_ASSERT_EQUAL_INT(REASON_HYDRAULIC_DEAD, state.shows);
    for (int n = 0; n <= TIMEOUT_ms; n++) {
        silent();
    }
    TEST_ASSERT_EQUAL_INT(REASON_NONE, state.shows);
    TEST_ASSERT_EQUAL_INT32(q15_product(10000, state.gain_q15), out.torque_mNm);
    settled(10000, 0, HYDRAULIC_FEEDBACK_HEAL_ms - 1);
    TEST_ASSERT_EQUAL_INT(REASON_HYDRAULIC_DEAD, state.shows);
    TEST_ASSERT_TRUE(out.lost);
    silent();
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

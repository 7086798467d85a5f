/* SPDX-License-Identifier: Apache-2.0 */
/* Bookkeeping of the watch of the hydraulic brake, in single steps from given states: what a start,
 * an acknowledgement, a pause and a finding leave, and where its counters and sums end. */
#include "hydraulic_watch_states.h"

/* A finding without reports needs a sixteenth more. */
enum { ONE_q15 = 32768, HEAVY_mNm_ms = 10300 * 480, END_mNm_ms = HEAVY_mNm_ms / 16 * 17 };

void setUp(void)
{
    heavy_up();
}

void tearDown(void) {}

static void sums_of(int32_t missing, int32_t excess, int32_t report)
{
    watch.missing_mNm_ms = missing;
    watch.excess_mNm_ms = excess;
    watch.report_mNm_ms = report;
}

static void assert_no_sums(void)
{
    TEST_ASSERT_EQUAL_INT32(0, watch.missing_mNm_ms);
    TEST_ASSERT_EQUAL_INT32(0, watch.excess_mNm_ms);
    TEST_ASSERT_EQUAL_INT32(0, watch.report_mNm_ms);
}

/* A wheel that rolls at a constant speed with a known road, beside a modelled torque of which so
 * much is missing: the rest is the road's. */
static void rolling(int32_t modelled_mNm, int32_t lacking_mNm)
{
    hydraulic_watch_init(&watch);
    in.modelled_mNm = modelled_mNm;
    in.commanded_mNm = modelled_mNm;
    watch.rolls = true;
    watch.acquired_ms = HYDRAULIC_WATCH_ACQUIRE_ms;
    watch.speed_lp_q8_mrad_s = FAST_mrad_s * 256;
    watch.known_lp_mNm.accumulator = -modelled_mNm * 64;
    watch.road_q8_mNm = (modelled_mNm - lacking_mNm) * 256;
    config.brake.hydraulic_watch_road_mrad_s2 = 0;
}

/* ---- starts and ends ---- */

void test_an_acknowledgement_ends_a_finding_with_all_that_belongs_to_it(void)
{
    watch.reason = REASON_HYDRAULIC_STUCK;
    watch.gain_q15 = 5;
    watch.extra_mNm = 6;
    watch.by_report = true;
    watch.confirms_report = true;
    watch.agrees_ms = 7;
    sums_of(8, 9, 10);
    in.acknowledged = true;
    in.trusted = false;
    step();
    TEST_ASSERT_EQUAL_INT(REASON_NONE, watch.reason);
    TEST_ASSERT_EQUAL_INT32(ONE_q15, watch.gain_q15);
    TEST_ASSERT_EQUAL_INT32(0, watch.extra_mNm);
    TEST_ASSERT_FALSE(watch.by_report || watch.confirms_report);
    TEST_ASSERT_EQUAL_INT32(0, watch.agrees_ms);
    assert_no_sums();
}

void test_a_wheel_that_begins_to_roll_starts_its_filters_and_waits(void)
{
    for (int sign = -1; sign <= 1; sign += 2) {
        hydraulic_watch_init(&watch);
        watch.backwards = sign < 0;
        in.speed_mrad_s = sign * FAST_mrad_s;
        in.motor_mNm = sign * -2000;
        in.modelled_mNm = 10000;
        sums_of(8, 9, 10);
        watch.pause_ms = 5;
        watch.quiet_ms = 100;
        step();
        TEST_ASSERT_TRUE(watch.rolls && watch.stale);
        TEST_ASSERT_EQUAL_INT32(FAST_mrad_s * 256, watch.speed_lp_q8_mrad_s);
        TEST_ASSERT_EQUAL_INT32(-12000 * 64, watch.known_lp_mNm.accumulator);
        TEST_ASSERT_EQUAL_INT32(12000, watch.road_mNm); /* of a speed that is constant */
        TEST_ASSERT_EQUAL_INT32(HYDRAULIC_WATCH_SETTLE_ms, watch.pause_ms);
        TEST_ASSERT_EQUAL_INT32(0, watch.quiet_ms);
        assert_no_sums();
    }
    watch.rolls = false;
    watch.pause_ms = HYDRAULIC_WATCH_PAUSE_ms;
    watch.quiet_ms = 100;
    in.modelled_mNm = 0;
    step();
    TEST_ASSERT_EQUAL_INT32(HYDRAULIC_WATCH_PAUSE_ms - 1, watch.pause_ms);
    TEST_ASSERT_EQUAL_INT32(1, watch.quiet_ms);
}

void test_confirmed_reports_are_the_torque_that_is_known(void)
{
    watch.confirms_report = true;
    in.modelled_mNm = 10000;
    in.reported_mNm = 3000;
    step();
    TEST_ASSERT_EQUAL_INT32(-3000 * 64, watch.known_lp_mNm.accumulator);
}

void test_a_wheel_without_trust_or_watch_does_not_roll(void)
{
    rolling(0, 0);
    in.trusted = false;
    step();
    TEST_ASSERT_FALSE(watch.rolls);
    TEST_ASSERT_EQUAL_INT32(HYDRAULIC_WATCH_PAUSE_ms, watch.pause_ms);
    rolling(0, 5000);
    in.trusted = true;
    config.brake.hydraulic_watch_inertia_g_m2 = 0;
    step();
    TEST_ASSERT_FALSE(watch.rolls);
    TEST_ASSERT_EQUAL_INT32(0, watch.road_mNm);
}

/* The other way the road is another one; a wheel at standstill turns to neither. */
void test_a_wheel_that_turns_round_acquires_its_road_anew(void)
{
    rolling(0, 0);
    in.speed_mrad_s = -1;
    step();
    TEST_ASSERT_FALSE(watch.rolls || watch.backwards);
    TEST_ASSERT_EQUAL_INT32(HYDRAULIC_WATCH_ACQUIRE_ms, watch.acquired_ms);
    rolling(0, 0);
    in.speed_mrad_s = -FAST_mrad_s;
    step();
    TEST_ASSERT_TRUE(watch.rolls && watch.backwards && watch.stale);
    TEST_ASSERT_EQUAL_INT32(0, watch.acquired_ms);
    TEST_ASSERT_EQUAL_INT32(HYDRAULIC_WATCH_SETTLE_ms, watch.pause_ms);
}

/* ---- pauses and counters ---- */

void test_a_pause_clears_the_sums_and_leaves_the_road(void)
{
    rolling(40000, 30000);
    config.brake.hydraulic_watch_road_mrad_s2 = 10;
    sums_of(8, 9, 10);
    watch.pause_ms = 2; /* its last millisecond but one */
    const int32_t road_q8_mNm = watch.road_q8_mNm;
    step();
    assert_no_sums();
    TEST_ASSERT_EQUAL_INT32(road_q8_mNm, watch.road_q8_mNm);
    step();
    TEST_ASSERT_NOT_EQUAL_INT32(road_q8_mNm, watch.road_q8_mNm);
}

void test_a_road_that_is_provisional_is_acquired_anew_without_hydraulic_torque(void)
{
    rolling(0, 0);
    watch.provisional = true;
    watch.pause_ms = 10;
    step();
    TEST_ASSERT_FALSE(watch.provisional);
    TEST_ASSERT_EQUAL_INT32(0, watch.acquired_ms);
}

/* ---- the age of a finding ---- */

static reason_t aged(reason_t reason, int32_t gain_q15, int32_t found_ms)
{
    hydraulic_watch_init(&watch);
    watch.reason = reason;
    watch.gain_q15 = gain_q15;
    watch.found_ms = found_ms - 1;
    in.trusted = false;
    step();
    return watch.reason;
}

void test_a_weak_brake_of_less_than_a_quarter_is_dead_after_its_time(void)
{
    const int32_t quarter_q15 = ONE_q15 / 4;
    const int32_t dead_ms = HYDRAULIC_WATCH_DEAD_ms;
    TEST_ASSERT_EQUAL_INT(REASON_HYDRAULIC_WEAK, aged(REASON_HYDRAULIC_WEAK, 0, dead_ms - 1));
    TEST_ASSERT_EQUAL_INT(REASON_HYDRAULIC_DEAD,
                          aged(REASON_HYDRAULIC_WEAK, quarter_q15 - 1, dead_ms));
    TEST_ASSERT_EQUAL_INT(REASON_HYDRAULIC_WEAK, aged(REASON_HYDRAULIC_WEAK, quarter_q15, dead_ms));
    TEST_ASSERT_EQUAL_INT(REASON_HYDRAULIC_LATE, aged(REASON_HYDRAULIC_LATE, 0, dead_ms));
}

static reason_t after_slip(reason_t reason, int32_t found_ms)
{
    rolling(0, 0);
    in.trusted = true;
    watch.reason = reason;
    watch.found_ms = found_ms - 1;
    watch.speed_lp_q8_mrad_s = 2 * FAST_mrad_s * 256;
    step();
    TEST_ASSERT_EQUAL_INT32(HYDRAULIC_WATCH_PAUSE_ms, watch.pause_ms);
    return watch.reason;
}

void test_a_slip_ends_an_excess_that_is_younger_than_its_pause(void)
{
    const int32_t pause_ms = HYDRAULIC_WATCH_PAUSE_ms;
    TEST_ASSERT_EQUAL_INT(REASON_NONE, after_slip(REASON_HYDRAULIC_STRONG, pause_ms - 1));
    TEST_ASSERT_EQUAL_INT(REASON_HYDRAULIC_STRONG, after_slip(REASON_HYDRAULIC_STRONG, pause_ms));
    TEST_ASSERT_EQUAL_INT(REASON_HYDRAULIC_WEAK, after_slip(REASON_HYDRAULIC_WEAK, 10));
}

/* ---- the torque of a finding ---- */

/* The last millisecond of a sum: what is missing of the modelled torque is missing of the gain. */
static void found_missing(int32_t modelled_mNm, int32_t lacking_mNm)
{
    rolling(modelled_mNm, lacking_mNm);
    sums_of(END_mNm_ms - 1, 9, 10);
}

void test_missing_torque_is_taken_from_the_gain_down_to_zero(void)
{
    found_missing(40000, 30000);
    watch.found_ms = 500;
    step();
    TEST_ASSERT_EQUAL_INT(REASON_HYDRAULIC_WEAK, watch.reason);
    TEST_ASSERT_EQUAL_INT32(ONE_q15 / 4, watch.gain_q15);
    TEST_ASSERT_EQUAL_INT32(0, watch.found_ms);
    TEST_ASSERT_EQUAL_INT32(HYDRAULIC_WATCH_SETTLE_ms, watch.pause_ms);
    assert_no_sums();
    found_missing(40000, 60000);
    watch.reason = REASON_HYDRAULIC_WEAK; /* found before, and weaker now */
    watch.found_ms = 500;
    step();
    TEST_ASSERT_EQUAL_INT32(0, watch.gain_q15);
    TEST_ASSERT_EQUAL_INT32(501, watch.found_ms);
}

/* Less of a brake that was thought to make torque by itself, without a command. */
void test_missing_torque_without_a_command_is_all_of_the_gain(void)
{
    static const int32_t LACKING_mNm[] = {1, 70000};
    for (int n = 0; n < 2; n++) {
        found_missing(0, LACKING_mNm[n]);
        config.brake.hydraulic_watch_floor_mrad_s2 = 0;
        watch.extra_mNm = 1;
        watch.known_lp_mNm.accumulator = -64;
        watch.road_q8_mNm = (1 - LACKING_mNm[n]) * 256;
        step();
        TEST_ASSERT_EQUAL_INT(REASON_HYDRAULIC_WEAK, watch.reason);
        TEST_ASSERT_EQUAL_INT32(0, watch.gain_q15);
    }
}

static reason_t found_excess(int32_t modelled_mNm, int32_t excess_mNm, reason_t before)
{
    rolling(modelled_mNm, -excess_mNm);
    sums_of(8, END_mNm_ms - 1, 10);
    watch.reason = before;
    step();
    TEST_ASSERT_EQUAL_INT32(0, watch.found_ms);
    TEST_ASSERT_EQUAL_INT32(HYDRAULIC_WATCH_SETTLE_ms, watch.pause_ms);
    assert_no_sums();
    return watch.reason;
}

void test_an_excess_beyond_a_command_is_added_to_the_gain_up_to_two(void)
{
    TEST_ASSERT_EQUAL_INT(REASON_HYDRAULIC_STRONG, found_excess(40000, 30000, REASON_NONE));
    TEST_ASSERT_EQUAL_INT32(ONE_q15 + ONE_q15 / 4 * 3, watch.gain_q15);
    (void)found_excess(40000, 60000, REASON_NONE);
    TEST_ASSERT_EQUAL_INT32(2 * ONE_q15, watch.gain_q15);
    config.brake.hydraulic_watch_floor_mrad_s2 = 0;
    (void)found_excess(1, 70000, REASON_NONE);
    TEST_ASSERT_EQUAL_INT32(2 * ONE_q15, watch.gain_q15);
    (void)found_excess(1, 1, REASON_NONE);
    TEST_ASSERT_EQUAL_INT32(2 * ONE_q15, watch.gain_q15);
}

void test_an_excess_without_a_command_is_torque_by_itself(void)
{
    TEST_ASSERT_EQUAL_INT(REASON_HYDRAULIC_STUCK, found_excess(0, 30000, REASON_NONE));
    TEST_ASSERT_EQUAL_INT32(30000, watch.extra_mNm);
    TEST_ASSERT_EQUAL_INT32(ONE_q15, watch.gain_q15);
}

void test_a_brake_that_does_not_release_stays_that_with_a_command(void)
{
    TEST_ASSERT_EQUAL_INT(REASON_HYDRAULIC_STUCK,
                          found_excess(40000, 30000, REASON_HYDRAULIC_STUCK));
    TEST_ASSERT_EQUAL_INT(REASON_HYDRAULIC_STRONG,
                          found_excess(40000, 30000, REASON_HYDRAULIC_STRONG));
    TEST_ASSERT_EQUAL_INT(REASON_HYDRAULIC_STRONG,
                          found_excess(40000, 30000, REASON_HYDRAULIC_LATE));
}

static reason_t excess_of_a_short_brake(int32_t found_ms)
{
    rolling(40000, -30000);
    sums_of(8, END_mNm_ms - 1, 10);
    watch.reason = REASON_HYDRAULIC_WEAK;
    watch.found_ms = found_ms - 1;
    step();
    return watch.reason;
}

void test_a_short_brake_that_makes_its_torque_again_in_time_was_late(void)
{
    const int32_t late_ms = HYDRAULIC_WATCH_LATE_ms;
    TEST_ASSERT_EQUAL_INT(REASON_HYDRAULIC_LATE, excess_of_a_short_brake(late_ms - 1));
    TEST_ASSERT_EQUAL_INT(REASON_NONE, excess_of_a_short_brake(late_ms));
}

/* ---- reports ---- */

/* A brake that its reports show to be short, and a report that agrees with its command. */
static reason_t agreed(int32_t found_ms, int32_t agrees_ms, int32_t reported_mNm)
{
    rolling(3276800, 0);
    in.reported = true;
    in.reported_mNm = reported_mNm;
    watch.by_report = true;
    watch.reason = REASON_HYDRAULIC_WEAK;
    watch.found_ms = found_ms - 1;
    watch.agrees_ms = agrees_ms - 1;
    step();
    return watch.reason;
}

/* Three quarters of 100 * 2^15 mN m are 100 * 24576. */
void test_a_report_of_the_whole_band_agrees_with_its_command(void)
{
    TEST_ASSERT_EQUAL_INT(REASON_HYDRAULIC_WEAK, agreed(10, 50, 2457600));
    TEST_ASSERT_EQUAL_INT32(50, watch.agrees_ms);
    TEST_ASSERT_EQUAL_INT(REASON_HYDRAULIC_WEAK, agreed(10, 50, 2457599));
    TEST_ASSERT_EQUAL_INT32(0, watch.agrees_ms);
}

void test_a_brake_whose_reports_agree_in_time_was_late(void)
{
    const int32_t late_ms = HYDRAULIC_WATCH_LATE_ms;
    TEST_ASSERT_EQUAL_INT(REASON_HYDRAULIC_LATE, agreed(late_ms - 1, 51, 3276800));
    TEST_ASSERT_EQUAL_INT(REASON_NONE, agreed(late_ms, 51, 3276800));
}

/* What the deceleration shows of a difference, less half of it. */
static int32_t decided_mNm_ms(int32_t reported_mNm, int32_t contradicts_mNm, bool come)
{
    rolling(40000, 30000);
    in.reported = come;
    in.reported_mNm = reported_mNm;
    in.contradicts_mNm = contradicts_mNm;
    watch.report_mNm_ms = 100;
    step();
    return watch.report_mNm_ms;
}

void test_reports_that_contradict_are_weighed_against_the_deceleration(void)
{
    TEST_ASSERT_EQUAL_INT32(100 + 30000 - 18000, decided_mNm_ms(4000, -1, true));
    TEST_ASSERT_EQUAL_INT32(100 + 30000, decided_mNm_ms(40000, 1, true));
    TEST_ASSERT_EQUAL_INT32(100 - 30000, decided_mNm_ms(40001, 1, true));
    TEST_ASSERT_EQUAL_INT32(0, decided_mNm_ms(4000, 0, true));
    TEST_ASSERT_EQUAL_INT32(0, decided_mNm_ms(4000, -1, false));
}

/* SPDX-License-Identifier: Apache-2.0 */
/* What brake blending tells the watch of the hydraulic brake, and takes from it, in single steps
 * from given states. */
#include <string.h>

#include "blending_rig.h"

void setUp(void)
{
    memset(&in, 0, sizeof in);
    rig_up();
    config.brake.hydraulic_timeout_ms = 0;
    config.brake.hydraulic_report_delay_ms = 0;
    in.demand_mNm = 60000;
}

void tearDown(void) {}

enum { FLOOR_mNm = 4023 /* 10300 g m2 * 400 mrad/s2, over 1024 */ };

/* A wheel that rolls at a constant speed, and a road that is known. */
static void rolling(void)
{
    brake_blending_init(&state, &config);
    config.brake.hydraulic_watch_inertia_g_m2 = 10300;
    config.brake.hydraulic_watch_speed_mrad_s = 480;
    config.brake.hydraulic_watch_floor_mrad_s2 = 400;
    config.vehicle.wheel_radius_um = 250000;
    config.brake.hydraulic_watch_drag_uNm_s2 = 0;
    config.monitor.tyre_grip_mm_s2 = 11768;
    in.watched = true;
    state.watch.rolls = true;
    state.watch.speed_lp_q8_mrad_s = FAST_mrad_s * 256;
    state.watch.acquired_ms = HYDRAULIC_WATCH_ACQUIRE_ms;
}

/* All known torque that brakes, of the first step. */
static int32_t known_mNm(void)
{
    state.watch.rolls = false;
    in.motor_achieved_mNm = -2000;
    (void)step();
    return -state.watch.known_lp_mNm.accumulator / 64;
}

void test_the_watch_gets_the_modelled_torque_or_the_measured_one_while_it_is_used(void)
{
    rolling();
    slow_brake(10000);
    state.feedback.gain_q15 = 29491; /* learned before the reports ended */
    TEST_ASSERT_EQUAL_INT32(12000, known_mNm());
    rolling();
    slow_brake(10000);
    measured(7000, ONE_q15, ONE_q15, ONE_q15);
    TEST_ASSERT_EQUAL_INT32(9000, known_mNm());
    for (int confirmed = 0; confirmed < 2; confirmed++) {
        rolling();
        slow_brake(40000);
        measured(0, ONE_q15, ONE_q15, ONE_q15);
        state.watch.provisional = true; /* until there is no hydraulic torque */
        state.feedback.confirmed = confirmed != 0;
        state.watch.confirms_report = confirmed != 0;
        (void)step();
        TEST_ASSERT_TRUE(state.watch.provisional == (confirmed != 0));
    }
}

/* Without torque, uncertain by the models, and by the last change of reports. */
static bool is_quiet(int32_t early_mNm, int32_t late_mNm, int32_t change_mNm, bool used)
{
    config.brake.hydraulic_timeout_ms = 0;
    rolling();
    slow_brake(0);
    state.hydraulic.early_q6_mNm = early_mNm * 64 + 32;
    state.hydraulic.late_q6_mNm = late_mNm * 64 + 32;
    if (used) {
        measured(0, ONE_q15, ONE_q15, ONE_q15);
    }
    state.feedback.change_mNm = change_mNm;
    (void)step();
    return state.watch.quiet_ms == 1;
}

void test_hydraulic_torque_is_uncertain_by_its_models_and_the_change_of_its_reports(void)
{
    TEST_ASSERT_TRUE(is_quiet(FLOOR_mNm, 0, 9999, false));
    TEST_ASSERT_FALSE(is_quiet(FLOOR_mNm + 1, 0, 0, false));
    TEST_ASSERT_FALSE(is_quiet(0, FLOOR_mNm + 1, 0, false));
    for (int sign = -1; sign <= 1; sign += 2) {
        TEST_ASSERT_TRUE(is_quiet(3000, 1000, sign * (FLOOR_mNm - 2000), true));
        TEST_ASSERT_FALSE(is_quiet(3000, 1000, sign * (FLOOR_mNm - 1999), true));
    }
}

void test_reports_that_are_not_used_are_outside_no_band(void)
{
    rolling();
    (void)step();
    TEST_ASSERT_EQUAL_INT32(0, state.watch.pause_ms); /* a finding that ends pauses */
}

/* A brake found by its reports stays found as long as they come. */
static reason_t found_with(bool seen, int32_t since_ms)
{
    rolling();
    slow_brake(10000);
    measured(0, ONE_q15, ONE_q15, ONE_q15);
    in.hydraulic.valid = false;
    state.feedback.seen = seen;
    state.feedback.since_ms = since_ms - 1;
    state.feedback.outside_ms = -1;
    state.watch.by_report = true;
    state.watch.reason = REASON_HYDRAULIC_WEAK;
    (void)step();
    return state.watch.reason;
}

void test_a_brake_counts_as_reported_for_the_timeout(void)
{
    TEST_ASSERT_EQUAL_INT(REASON_HYDRAULIC_WEAK, found_with(true, 50));
    TEST_ASSERT_EQUAL_INT(REASON_NONE, found_with(true, 51));
    TEST_ASSERT_EQUAL_INT(REASON_NONE, found_with(false, 1));
}

/* Reports of half of 40 N m, in use and short of the band, of a brake that makes all of it: the sum
 * lacks what they differ by, or one more, of a third of 10300 * 480. */
void test_refuted_reports_are_not_used_until_they_heal(void)
{
    for (int32_t short_mNm_ms = 0; short_mNm_ms <= 1; short_mNm_ms++) {
        rolling();
        slow_brake(40000);
        measured(20000, ONE_q15, ONE_q15, ONE_q15);
        state.feedback.outside_ms = -1;
        state.watch.known_lp_mNm.accumulator = -40000 * 64;
        state.watch.road_q8_mNm = 40000 * 256;
        state.watch.report_mNm_ms = -(10300 * 480 / 3) + 10000 + short_mNm_ms;
        (void)step();
        const bool refuted = short_mNm_ms == 0;
        TEST_ASSERT_TRUE(state.feedback.refuted == refuted);
        TEST_ASSERT_TRUE(state.feedback.good == !refuted);
        TEST_ASSERT_EQUAL_INT32(refuted ? HYDRAULIC_FEEDBACK_HEAL_ms : 0, state.feedback.heal_ms);
        TEST_ASSERT_TRUE(hydraulic_feedback_used(&state.feedback) == !refuted);
    }
}

/* Reports that agree with the commands leave what is missing to the road. Refuted ones leave it to
 * the brake. */
void test_refuted_reports_do_not_keep_the_deceleration_from_finding_the_brake(void)
{
    for (int refuted = 0; refuted < 2; refuted++) {
        rolling();
        slow_brake(40000);
        measured(40000, ONE_q15, ONE_q15, ONE_q15);
        state.feedback.refuted = refuted != 0;
        state.feedback.heal_ms = 500;
        state.watch.known_lp_mNm.accumulator = -40000 * 64; /* all of it, of a steady speed */
        (void)step();
        if (refuted != 0) {
            TEST_ASSERT_GREATER_THAN_INT32(10000, state.watch.missing_mNm_ms);
        } else {
            TEST_ASSERT_EQUAL_INT32(0, state.watch.missing_mNm_ms);
        }
    }
}

/* 40 N m are missing of a deceleration that is zero: more than half of what the reports differ by.
 * The sum lacks 1 of a third of 10300 * 480. Reports that were confirmed before heal as others do.
 */
void test_confirmed_reports_are_used_at_once(void)
{
    for (int before = 0; before < 2; before++) {
        rolling();
        slow_brake(40000);
        measured(0, ONE_q15, ONE_q15, ONE_q15);
        state.feedback.good = before != 0;
        state.feedback.heal_ms = 500;
        state.feedback.contradicts_mNm = -30000;
        state.feedback.confirmed = before != 0;
        state.watch.confirms_report = before != 0;
        state.watch.known_lp_mNm.accumulator = -40000 * 64;
        state.watch.report_mNm_ms = 10300 * 480 / 3 - 1;
        (void)step();
        TEST_ASSERT_TRUE(state.watch.confirms_report && state.feedback.confirmed);
        TEST_ASSERT_EQUAL_INT32(before != 0 ? 499 : 0, state.feedback.heal_ms);
    }
}

/* SPDX-License-Identifier: Apache-2.0 */
/* What brake blending tells the watch of the hydraulic brake, and takes from it. The wheel rolls at
 * a constant speed, which shows a brake that makes what the road drives, or none. */
#include <string.h>

#include "blending_rig.h"

enum {
    FLOOR_mNm = 4023, /* 10300 g m2 * 400 mrad/s2, over 1024 */
    TIMEOUT_ms = 50,
    LONG_ms = 1000
};

void setUp(void)
{
    memset(&in, 0, sizeof in);
    rig_up();
    config.brake.hydraulic_timeout_ms = 0;
    config.brake.hydraulic_report_delay_ms = 0;
    in.brake_torque_mNm = 60000;
    in.seen = true;
}

void tearDown(void) {}

/* A road that drives with the torque that the brake has made on it. */
static void rolling(int32_t made_mNm)
{
    brake_blending_init(&state, &config);
    config = watching();
    rolls(LONG_ms, 0, made_mNm);
    TEST_ASSERT_EQUAL_INT32(HYDRAULIC_WATCH_ACQUIRE_ms, state.watch.acquired_ms);
}

/* Reports in every step from now on, which a tolerance makes a contradiction or not. */
static void reports(int32_t report_mNm, int32_t tolerance_mNm)
{
    reported(report_mNm, 0);
    config.brake.hydraulic_tolerance_mNm = tolerance_mNm;
}

static void reports_end(void)
{
    in.hydraulic.valid = false;
    for (int ms = 0; ms <= TIMEOUT_ms; ms++) {
        (void)hydraulic_feedback_step(&state.feedback, &config, &state.hydraulic, &in.hydraulic);
    }
    TEST_ASSERT_FALSE(hydraulic_feedback_used(&state.feedback));
}

/* ---- what it is told ---- */

/* All known torque that brakes, of the first step. */
static int32_t known_mNm(void)
{
    hydraulic_watch_init(&state.watch);
    in.motor_achieved_mNm = -2000;
    (void)step();
    return -state.watch.known_lp_mNm.accumulator / 64;
}

void test_the_watch_gets_the_measured_torque_while_it_is_used(void)
{
    rolling(0);
    slow_brake(10000);
    learned(16384, 32768, 32768, 29491); /* a gain of 0.9 */
    reports_end();
    TEST_ASSERT_EQUAL_INT32(12000, known_mNm());
    rolling(0);
    slow_brake(10000);
    measured(7000, 0);
    TEST_ASSERT_EQUAL_INT32(9000, known_mNm());
}

/* A road that was acquired beside 5 N m is acquired anew once there is no torque. */
void test_the_watch_gets_the_modelled_torque_beside_reports_that_are_confirmed(void)
{
    rolling(5000);
    slow_brake(40000);
    measured(0, 0);
    TEST_ASSERT_TRUE(state.watch.provisional);
    (void)step();
    TEST_ASSERT_FALSE(state.watch.provisional);
    rolling(5000);
    slow_brake(40000);
    reports(0, 15000);
    for (int ms = 0; !state.watch.confirms_report; ms++) {
        TEST_ASSERT_LESS_THAN_INT(LONG_ms, ms);
        (void)step();
    }
    config.brake.hydraulic_tolerance_mNm = 20000000; /* within the band again */
    (void)step();
    TEST_ASSERT_TRUE(state.watch.provisional);
}

static int32_t more(int32_t torque_mNm)
{
    return torque_mNm > 0 ? torque_mNm + 1 : 0; /* slow_brake() */
}

/* Without torque: uncertain by the models, and by the last change of reports. */
static bool is_quiet(int32_t early_mNm, int32_t late_mNm, int32_t report_mNm, int32_t next_mNm,
                     bool ends)
{
    const hydraulic_model_t released = {.next = 0};
    const int32_t commands_mNm[5] = {more(late_mNm), 0, 0, more(early_mNm), 0};
    rolling(0);
    slow_brake(0);
    model_after(&state.hydraulic, commands_mNm);
    measured(report_mNm, 0);
    in.hydraulic.torque_mNm = next_mNm;
    in.hydraulic.age_ms = 0;
    (void)hydraulic_feedback_step(&state.feedback, &config, &released, &in.hydraulic);
    in.hydraulic.age_ms = 1000;
    if (ends) {
        reports_end();
    }
    (void)step();
    return state.watch.quiet_ms > 0;
}

void test_hydraulic_torque_is_uncertain_by_its_models_and_the_change_of_its_reports(void)
{
    TEST_ASSERT_TRUE(is_quiet(FLOOR_mNm, 0, 9999, 0, true));
    TEST_ASSERT_FALSE(is_quiet(FLOOR_mNm + 1, 0, 0, 0, true));
    TEST_ASSERT_FALSE(is_quiet(0, FLOOR_mNm + 1, 0, 0, true));
    TEST_ASSERT_TRUE(is_quiet(3000, 1000, FLOOR_mNm - 2000, 0, false));
    TEST_ASSERT_FALSE(is_quiet(3000, 1000, FLOOR_mNm - 1999, 0, false));
    /* A torque that is reported counts twice: by itself, and as a change. */
    TEST_ASSERT_TRUE(is_quiet(3000, 1000, 0, (FLOOR_mNm - 2000) / 2, false));
    TEST_ASSERT_FALSE(is_quiet(3000, 1000, 0, (FLOOR_mNm - 2000) / 2 + 1, false));
}

void test_without_reports_the_brake_is_outside_no_band(void)
{
    rolling(0);
    (void)step();
    TEST_ASSERT_EQUAL_INT32(0, state.watch.pause_ms); /* a finding that ends pauses */
}

/* Reports of no torque, in use and short of 10 N m by more than a quarter of the tolerance. */
void test_a_brake_found_by_its_reports_counts_as_reported_for_the_timeout(void)
{
    rolling(10000);
    slow_brake(10000);
    reports(0, 15000);
    for (int ms = 0; ms <= TIMEOUT_ms; ms++) {
        TEST_ASSERT_EQUAL_INT(REASON_NONE, state.watch.reason);
        (void)step();
    }
    TEST_ASSERT_EQUAL_INT(REASON_HYDRAULIC_WEAK, state.watch.reason);
    in.hydraulic.valid = false;
    for (int ms = 0; ms < TIMEOUT_ms; ms++) {
        (void)step();
        TEST_ASSERT_EQUAL_INT(REASON_HYDRAULIC_WEAK, state.watch.reason);
    }
    (void)step();
    TEST_ASSERT_EQUAL_INT(REASON_NONE, state.watch.reason);
}

/* The watch knows more than that the reports have stopped. */
void test_what_the_watch_finds_is_reported_under_its_name_and_before_lost_reports(void)
{
    measured(0, 0);
    in.hydraulic.valid = false;
    for (int ms = 0; ms <= 50; ms++) {
        (void)step();
    }
    TEST_ASSERT_EQUAL_INT(REASON_HYDRAULIC_FEEDBACK, found());
    for (reason_t name = REASON_HYDRAULIC_WEAK; name <= REASON_HYDRAULIC_LATE; name++) {
        state.watch.reason = name;
        TEST_ASSERT_EQUAL_INT(name, found());
    }
}

/* ---- what is taken from it ---- */

/* Reports of half of the 40 N m that the road shows. */
static void refute(void)
{
    rolling(40000);
    slow_brake(40000);
    reports(20000, 30000);
    for (int ms = 0; !state.watch.refutes_report; ms++) {
        TEST_ASSERT_LESS_THAN_INT(LONG_ms, ms);
        TEST_ASSERT_FALSE(state.feedback.refuted);
        (void)step();
    }
}

void test_refuted_reports_are_not_used_until_they_heal(void)
{
    refute();
    TEST_ASSERT_TRUE(state.feedback.refuted);
    TEST_ASSERT_FALSE(state.feedback.good);
    TEST_ASSERT_EQUAL_INT32(HYDRAULIC_FEEDBACK_HEAL_ms, state.feedback.heal_ms);
    TEST_ASSERT_FALSE(hydraulic_feedback_used(&state.feedback));
}

/* The wheel gains 4 mrad/s a millisecond: all of the brake's torque is missing. Reports that agree
 * with the commands leave that to the road, refuted ones to the brake. */
static reason_t found_of_a_dead_brake(void)
{
    in.hydraulic.torque_mNm = 40000;
    for (int ms = 0; ms < 700; ms++) {
        in.speed_mrad_s += 4;
        (void)step();
    }
    return state.watch.reason;
}

void test_refuted_reports_do_not_keep_the_deceleration_from_finding_the_brake(void)
{
    refute();
    TEST_ASSERT_EQUAL_INT(REASON_HYDRAULIC_WEAK, found_of_a_dead_brake());
    rolling(40000);
    slow_brake(40000);
    reports(40000, 30000);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, found_of_a_dead_brake());
}

/* The wheel does not slow down: as reports have it that contradict the commands. */
void test_confirmed_reports_are_used_at_once(void)
{
    rolling(0);
    slow_brake(40000);
    reports(0, 15000);
    for (int ms = 0; ms <= TIMEOUT_ms; ms++) {
        (void)step();
    }
    TEST_ASSERT_EQUAL_INT32(HYDRAULIC_FEEDBACK_HEAL_ms, state.feedback.heal_ms);
    for (int ms = 0; !state.watch.confirms_report; ms++) {
        TEST_ASSERT_LESS_THAN_INT(LONG_ms, ms);
        TEST_ASSERT_FALSE(hydraulic_feedback_used(&state.feedback));
        (void)step();
    }
    TEST_ASSERT_TRUE(state.feedback.confirmed);
    TEST_ASSERT_TRUE(hydraulic_feedback_used(&state.feedback));
}

/* SPDX-License-Identifier: Apache-2.0 */
/* Which of reports and deceleration the watch of the hydraulic brake follows, in single steps from
 * given states. Whole stops: test_hydraulic_watch_reports.c. */
#include "hydraulic_watch_states.h"

enum {
    TORQUE_mNm = 40000,
    DIFFERS_mNm = 20000,           /* of the reports, from the model's torque */
    END_mNm_ms = ENOUGH_mNm_ms / 3 /* beside reports a third of the sum suffices */
};

void setUp(void)
{
    states_up();
}

void tearDown(void) {}

/* A brake that makes its 40 N m, and reports of so much: beyond the band, or short of the learned
 * gain, for so long. */
static void beside_reports(int32_t reported_mNm, int32_t outside_ms, int32_t contradicts_mNm)
{
    riding(0, TORQUE_mNm, 0);
    in.reported = true;
    in.reported_mNm = reported_mNm;
    in.outside_ms = outside_ms;
    in.contradicts_mNm = contradicts_mNm;
}

/* Less than DIFFERS / 2, that is, as the deceleration shows the commanded torque. */
static void at_the_end_but(int32_t short_mNm_ms)
{
    watch.report_mNm_ms = -(END_mNm_ms - DIFFERS_mNm / 2) + short_mNm_ms;
    step();
}

/* Reports that are in use, on either side of the band and for less than the timeout. */
void test_used_reports_are_refuted_before_they_have_named_a_brake(void)
{
    for (int sign = -1; sign <= 1; sign += 2) {
        for (int32_t short_mNm_ms = 0; short_mNm_ms <= 1; short_mNm_ms++) {
            beside_reports(TORQUE_mNm + sign * DIFFERS_mNm, sign, 0);
            at_the_end_but(short_mNm_ms);
            TEST_ASSERT_TRUE(watch.refutes_report == (short_mNm_ms == 0));
            TEST_ASSERT_EQUAL_INT(REASON_NONE, watch.reason);
            TEST_ASSERT_EQUAL_INT32(short_mNm_ms == 0 ? HYDRAULIC_WATCH_SETTLE_ms : 0,
                                    watch.pause_ms);
        }
    }
}

/* They are not in use already. */
void test_reports_that_contradict_the_commands_are_not_refuted(void)
{
    beside_reports(TORQUE_mNm - DIFFERS_mNm, 0, -1);
    at_the_end_but(0);
    TEST_ASSERT_FALSE(watch.refutes_report);
    TEST_ASSERT_EQUAL_INT32(-END_mNm_ms, watch.report_mNm_ms);
}

/* What is missing then is not the road's, from the first report outside the band on: half of the
 * difference less than what is missing speaks for the reports. */
void test_the_road_waits_from_the_first_report_outside_the_band(void)
{
    for (int sign = -1; sign <= 1; sign += 2) {
        beside_reports(TORQUE_mNm - DIFFERS_mNm, sign, 0);
        watch.road_q8_mNm -= DIFFERS_mNm * 256;
        const int32_t road_q8_mNm = watch.road_q8_mNm;
        step();
        TEST_ASSERT_EQUAL_INT32(road_q8_mNm, watch.road_q8_mNm);
        TEST_ASSERT_EQUAL_INT32(DIFFERS_mNm - DIFFERS_mNm / 2, watch.report_mNm_ms);
    }
}

/* A finding of used reports is theirs until it ends, whatever they found. */
void test_what_reports_have_found_remains_their_finding(void)
{
    static const struct {
        reason_t reason;
        int32_t outside_ms;
    } CASES[] = {{REASON_HYDRAULIC_WEAK, -1},
                 {REASON_HYDRAULIC_DEAD, -1},
                 {REASON_HYDRAULIC_STRONG, 1},
                 {REASON_HYDRAULIC_STUCK, 1}};
    for (int n = 0; n < 4; n++) {
        beside_reports(TORQUE_mNm, CASES[n].outside_ms, 0);
        watch.by_report = true;
        watch.reason = CASES[n].reason;
        step();
        TEST_ASSERT_EQUAL_INT(CASES[n].reason, watch.reason);
        TEST_ASSERT_TRUE(watch.by_report);
    }
    in.outside_ms = 0; /* the excess is over in one step */
    step();
    TEST_ASSERT_EQUAL_INT(REASON_NONE, watch.reason);
    TEST_ASSERT_FALSE(watch.by_report);
}

void test_an_excess_found_by_reports_is_over_in_the_first_step_in_which_they_agree(void)
{
    for (int32_t command_mNm = 0; command_mNm <= TORQUE_mNm; command_mNm += TORQUE_mNm) {
        riding(0, command_mNm, 0);
        in.reported = true;
        in.reported_mNm = command_mNm + DIFFERS_mNm;
        in.outside_ms = TIMEOUT_ms + 1;
        step();
        TEST_ASSERT_EQUAL_INT(command_mNm == 0 ? REASON_HYDRAULIC_STUCK : REASON_HYDRAULIC_STRONG,
                              watch.reason);
        in.outside_ms = 0;
        in.reported_mNm = command_mNm;
        step();
        TEST_ASSERT_EQUAL_INT(REASON_NONE, watch.reason);
    }
}

/* Found by used reports, with 30 N m missing. */
static void found_weak(int32_t reported_mNm, int32_t outside_ms)
{
    beside_reports(reported_mNm, outside_ms, 0);
    watch.road_q8_mNm -= 30000 * 256;
    watch.by_report = true;
    watch.reason = REASON_HYDRAULIC_WEAK;
    watch.report_mNm_ms = 7;
    step();
    TEST_ASSERT_EQUAL_INT(REASON_HYDRAULIC_WEAK, watch.reason);
    TEST_ASSERT_EQUAL_INT32(0, watch.missing_mNm_ms);
    TEST_ASSERT_EQUAL_INT32(0, watch.excess_mNm_ms);
}

void test_the_deceleration_decides_on_a_finding_of_reports_and_its_own_sums_stay_zero(void)
{
    found_weak(TORQUE_mNm - DIFFERS_mNm, -1);
    TEST_ASSERT_EQUAL_INT32(7 + 30000 - DIFFERS_mNm / 2, watch.report_mNm_ms);
}

/* Apart by a quarter of the tolerance, which is too little to decide on. */
void test_the_sum_that_decides_on_reports_stays_while_they_agree(void)
{
    found_weak(TORQUE_mNm - TOLERANCE_mNm / 4, 0);
    TEST_ASSERT_EQUAL_INT32(7, watch.report_mNm_ms);
}

/* ---- before standstill ---- */

/* Hall sensors, and torques that let the wheel stand within 384 ms: of 1.024 kg m2 at 2.999 rad/s
 * those of 8 N m and more. */
static void before_standstill(void)
{
    config.rotor.sensor = CONFIG_ROTOR_HALL;
    in.speed_mrad_s = 2999;
    watch.speed_lp_q8_mrad_s = 2999 * 256;
    watch.rolls_on_ms = 7;
}

/* 10 N m are missing, half of what the reports differ by: the sum stays where it is, at its end. */
void test_a_deceleration_that_halls_hide_decides_on_no_report(void)
{
    for (int found = 0; found < 2; found++) {
        for (int hidden = 0; hidden < 2; hidden++) {
            states_up();
            beside_reports(TORQUE_mNm - DIFFERS_mNm, -1, 0);
            watch.by_report = found != 0;
            watch.reason = found != 0 ? REASON_HYDRAULIC_WEAK : REASON_NONE;
            watch.road_q8_mNm -= DIFFERS_mNm / 2 * 256;
            watch.report_mNm_ms = END_mNm_ms;
            if (hidden != 0) {
                before_standstill();
            }
            step();
            TEST_ASSERT_TRUE(watch.confirms_report == (hidden == 0));
        }
    }
}

/* ---- beside a finding of the deceleration ---- */

/* A brake that is found strong, with reports that agree with its commands: 30 N m are missing,
 * which is its end. 400 mN m and a quarter of 40 N m are tolerated. */
void test_reports_that_agree_leave_the_end_of_a_finding_to_the_deceleration(void)
{
    beside_reports(TORQUE_mNm, 0, 0);
    watch.road_q8_mNm -= 30000 * 256;
    watch.reason = REASON_HYDRAULIC_STRONG;
    step();
    TEST_ASSERT_EQUAL_INT32(30000 - FLOOR_mNm - TORQUE_mNm / 4, watch.missing_mNm_ms);
    watch.missing_mNm_ms = ENOUGH_mNm_ms / 16 * 17;
    step();
    TEST_ASSERT_EQUAL_INT(REASON_NONE, watch.reason);
}

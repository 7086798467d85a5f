/* SPDX-License-Identifier: Apache-2.0 */
/* When the watch of the hydraulic brake rolls, waits, follows the road and sums, in single steps
 * from given states. Findings: test_hydraulic_watch_findings.c. */
#include "hydraulic_watch_states.h"

/* A finding: of 10.3 kg m2 and 0.48 rad/s, and a sixteenth more. */
enum { END_mNm_ms = 10300 * 480 / 16 * 17, MODELLED_mNm = 40000 };

void setUp(void)
{
    heavy_up();
}

void tearDown(void) {}

/* As long as its road is known and the speed constant; so much is missing of a modelled torque. */
static void rolling(int32_t modelled_mNm, int32_t lacking_mNm)
{
    hydraulic_watch_init(&watch);
    in.modelled_mNm = modelled_mNm;
    in.commanded_mNm = modelled_mNm;
    watch.rolls = true;
    watch.backwards = in.speed_mrad_s < 0;
    watch.acquired_ms = HYDRAULIC_WATCH_ACQUIRE_ms;
    watch.speed_lp_q8_mrad_s = (in.speed_mrad_s < 0 ? -in.speed_mrad_s : in.speed_mrad_s) * 256;
    watch.known_lp_mNm.accumulator = -modelled_mNm * 64;
    watch.road_q8_mNm = (modelled_mNm - lacking_mNm) * 256;
}

/* Whether the road is followed in a step in which torque is missing. */
static bool follows_road(void)
{
    const int32_t before_q8_mNm = watch.road_q8_mNm;
    step();
    TEST_ASSERT_GREATER_OR_EQUAL_INT32(before_q8_mNm, watch.road_q8_mNm);
    return watch.road_q8_mNm != before_q8_mNm;
}

/* Half of 800 mrad/s and one. */
void test_a_wheel_rolls_above_half_of_the_end_of_the_blend_out(void)
{
    for (int sign = -1; sign <= 1; sign += 2) {
        in.speed_mrad_s = sign * 401;
        step();
        TEST_ASSERT_FALSE(watch.rolls);
        in.speed_mrad_s = sign * 402;
        step();
        TEST_ASSERT_TRUE(watch.rolls);
    }
}

void test_the_road_is_followed_in_either_direction(void)
{
    for (int sign = -1; sign <= 1; sign += 2) {
        in.speed_mrad_s = sign * FAST_mrad_s;
        rolling(MODELLED_mNm, 30000);
        TEST_ASSERT_TRUE(follows_road());
    }
}

/* ---- the inertia ---- */

/* 64 mrad/s faster are 1 mrad/s of the filter: 10.3 N m of 10.3 kg m2, in 256ths. */
static void faster(void)
{
    rolling(0, 0);
    in.motor_mNm = -3000;
    watch.known_lp_mNm.accumulator = -3000 * 64;
    in.speed_mrad_s = FAST_mrad_s + 64;
}

void test_steps_of_the_torque_begin_after_a_pause(void)
{
    faster();
    watch.pause_ms = 2; /* one more millisecond of it */
    step();
    TEST_ASSERT_EQUAL_INT32(10300, watch.inertial_mNm);
    TEST_ASSERT_EQUAL_INT32(-3000 * 256, watch.known_slow_mNm.accumulator);
    TEST_ASSERT_EQUAL_INT32(10300 * 256, watch.inertial_slow_mNm.accumulator);
    TEST_ASSERT_TRUE(watch.known_square == 0 && watch.known_by_inertial == 0);
}

/* A quarter of it, in 256ths, and a 32nd of the way in each step. */
void test_a_quarter_of_the_inertial_torque_is_acquired_with_the_road(void)
{
    faster();
    watch.acquired_ms = 0;
    step();
    TEST_ASSERT_EQUAL_INT32(10300 * 64 / 32, watch.quarter_q8_mNm);
}

/* ---- sums ---- */

void test_sums_end_at_zero(void)
{
    rolling(MODELLED_mNm, -30000);
    watch.missing_mNm_ms = 5;
    step();
    TEST_ASSERT_EQUAL_INT32(0, watch.missing_mNm_ms);
    rolling(MODELLED_mNm, 30000);
    watch.excess_mNm_ms = 5;
    step();
    TEST_ASSERT_EQUAL_INT32(0, watch.excess_mNm_ms);
}

void test_torque_is_not_missing_without_a_command(void)
{
    rolling(0, 30000);
    watch.missing_mNm_ms = 77;
    step();
    TEST_ASSERT_EQUAL_INT32(0, watch.missing_mNm_ms);
}

void test_an_excess_is_not_summed_beside_a_provisional_road(void)
{
    rolling(MODELLED_mNm, -30000);
    watch.provisional = true;
    watch.excess_mNm_ms = 77;
    step();
    TEST_ASSERT_EQUAL_INT32(0, watch.excess_mNm_ms);
}

void test_a_finding_begins_the_quiet_time_anew(void)
{
    rolling(0, -30000);
    watch.quiet_ms = 100;
    watch.excess_mNm_ms = END_mNm_ms - 1;
    step();
    TEST_ASSERT_EQUAL_INT(REASON_HYDRAULIC_STUCK, watch.reason);
    TEST_ASSERT_EQUAL_INT32(0, watch.quiet_ms);
}

/* What a brake makes by itself counts as 2^23 mN m at most: 4388608 less than that move the filter
 * from 4 kN m by a 64th, 68572. */
void test_the_torque_of_a_brake_by_itself_ends_at_the_largest_number(void)
{
    rolling(0, 0);
    watch.extra_mNm = INT32_MAX - 5;
    watch.known_lp_mNm.accumulator = -4000000 * 64;
    watch.road_q8_mNm = (4068572 + 30000) * 256;
    watch.excess_mNm_ms = END_mNm_ms - 1;
    step();
    TEST_ASSERT_EQUAL_INT32(4068572, watch.road_mNm);
    TEST_ASSERT_EQUAL_INT(REASON_HYDRAULIC_STUCK, watch.reason);
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, watch.extra_mNm);
}

/* ---- while the brake answers a command ---- */

void test_the_road_waits_for_as_long_as_the_brake_was_certain(void)
{
    rolling(MODELLED_mNm, 30000);
    watch.certain_ms = 5;
    TEST_ASSERT_TRUE(follows_road());
    TEST_ASSERT_EQUAL_INT32(6, watch.certain_ms);
    in.uncertain_mNm = 10000;
    watch.certain_ms = 2;
    TEST_ASSERT_FALSE(follows_road());
    TEST_ASSERT_EQUAL_INT32(1, watch.certain_ms);
    TEST_ASSERT_TRUE(follows_road());
    TEST_ASSERT_EQUAL_INT32(0, watch.certain_ms);
    TEST_ASSERT_TRUE(follows_road());
    TEST_ASSERT_EQUAL_INT32(0, watch.certain_ms);
}

/* ---- while reports are to be decided on ---- */

static bool waits_for_decision(int32_t reported_mNm, bool by_report, bool confirmed)
{
    rolling(MODELLED_mNm, 30000);
    in.reported = true;
    in.reported_mNm = reported_mNm;
    in.contradicts_mNm = -1;
    watch.reason = REASON_HYDRAULIC_WEAK;
    watch.by_report = by_report;
    watch.confirms_report = confirmed;
    watch.known_lp_mNm.accumulator = confirmed ? -reported_mNm * 64 : -MODELLED_mNm * 64;
    watch.road_q8_mNm = 0;
    return !follows_road();
}

/* A quarter of the tolerance, 100 mN m, to either side. */
void test_the_road_waits_while_reports_differ_from_the_model_by_more_than_a_brake_at_work(void)
{
    TEST_ASSERT_FALSE(waits_for_decision(MODELLED_mNm - 100, true, false));
    TEST_ASSERT_FALSE(waits_for_decision(MODELLED_mNm + 100, true, false));
    TEST_ASSERT_TRUE(waits_for_decision(MODELLED_mNm - 101, true, false));
    TEST_ASSERT_TRUE(waits_for_decision(MODELLED_mNm + 101, true, false));
    TEST_ASSERT_FALSE(waits_for_decision(MODELLED_mNm - 30000, false, false));
    TEST_ASSERT_FALSE(waits_for_decision(MODELLED_mNm - 30000, true, true));
}

void test_confirmed_reports_leave_the_sums_alone(void)
{
    rolling(MODELLED_mNm, 30000);
    in.reported = true;
    in.reported_mNm = 10000;
    in.contradicts_mNm = -1;
    watch.confirms_report = true;
    watch.reason = REASON_HYDRAULIC_WEAK;
    watch.missing_mNm_ms = 77;
    step();
    TEST_ASSERT_EQUAL_INT32(77, watch.missing_mNm_ms);
    TEST_ASSERT_EQUAL_INT32(0, watch.gain_q15); /* a quarter of the command or less is none */
}

/* ---- before standstill ---- */

/* 100 N m let a wheel of 10.3 kg m2 and 500 mrad/s stand in 52 ms: with hall sensors what is
 * missing is found only if it still rolls after its time. */
static reason_t missing_soon(int32_t rolls_on_ms)
{
    in.speed_mrad_s = 500;
    config.rotor.sensor = CONFIG_ROTOR_HALL;
    rolling(100000, 50000);
    config.brake.hydraulic_watch_road_mrad_s2 = 0;
    watch.missing_mNm_ms = END_mNm_ms - 1;
    watch.rolls_on_ms = rolls_on_ms;
    step();
    return watch.reason;
}

void test_what_is_missing_before_standstill_is_found_if_the_wheel_rolls_on(void)
{
    TEST_ASSERT_EQUAL_INT(REASON_NONE, missing_soon(2));
    TEST_ASSERT_EQUAL_INT32(1, watch.rolls_on_ms);
    TEST_ASSERT_EQUAL_INT(REASON_HYDRAULIC_WEAK, missing_soon(1));
    TEST_ASSERT_EQUAL_INT(REASON_HYDRAULIC_WEAK, missing_soon(0));
    TEST_ASSERT_EQUAL_INT32(0, watch.rolls_on_ms);
}

/* SPDX-License-Identifier: Apache-2.0 */
/* Brake blending beside reports of the hydraulic torque that contradict its command, of a wrong
 * brake or of a wrong sensor: what is named, and what both brakes make together. */
#include <math.h>

#include "blending_rig.h"

enum { DEMAND_mNm = 64000, OPTIMUM_mNm = 24000, TIMEOUT_ms = 50, TOLERANCE_mNm = 3750 };
enum { QUALIFY_ms = 250 };
enum { HEAL_ms = 1000 };

static double gain, shown; /* of the brake; share of its torque that the sensor reports */
static bool reports;
static int period_ms, now_ms; /* of the reports */
static brake_blending_out_t out;
static findings_t findings;

void setUp(void)
{
    rig_up();
    config.brake.hydraulic_timeout_ms = TIMEOUT_ms;
    config.brake.hydraulic_report_delay_ms = 0;
    config.brake.hydraulic_gain_band_q15 = 6554; /* a fifth */
    config.brake.hydraulic_tolerance_mNm = TOLERANCE_mNm;
    config.motor.max_torque_mNm = 90000;
    capability.regenerating = limit_init(90000, REASON_MAX_TORQUE);
    capability.optimal = limit_init(OPTIMUM_mNm, REASON_LOSS_OPTIMUM);
    brake_blending_init(&state, &config);
    finding_times_t times[FINDING_COUNT];
    finding_times(&config, times);
    findings_init(&findings, times, false);
    const hydraulic_feedback_t none = {0};
    in.hydraulic = none;
    in.brake_torque_mNm = DEMAND_mNm;
    gain = 1.0;
    shown = 1.0;
    reports = true;
    period_ms = 10;
    now_ms = 0;
    out.electric_mNm = 0;
    out.hydraulic_mNm = 0;
}

void tearDown(void) {}

/* The brakes make what they are commanded, the hydraulic one its gain of it, at once; the sensor
 * reports that in the next millisecond. Returns the sum of both. */
static int32_t run(int duration_ms)
{
    double sum_mNm = 0.0;
    for (int n = 0; n < duration_ms; n++) {
        const double made_mNm = gain * out.hydraulic_mNm;
        motor_follows(out.electric_mNm);
        in.hydraulic.valid = in.hydraulic.valid || reports;
        in.hydraulic.age_ms++;
        if (reports && now_ms % period_ms == 0) {
            in.hydraulic.age_ms = 0;
            in.hydraulic.torque_mNm = (int32_t)lround(shown * made_mNm);
        }
        now_ms++;
        out = step();
        (void)brake_blending_report(&state, &findings);
        sum_mNm = out.electric_mNm + gain * out.hydraulic_mNm;
    }
    return (int32_t)lround(sum_mNm);
}

static reason_t named(void)
{
    return findings_reason(&findings, findings_warning(&findings));
}

/* Which of the two is wrong nobody can tell: the report of half of 40 N m counts as the least that
 * the band explains, so that a wrong sensor makes an excess of at most a quarter of what is asked
 * of the hydraulic brake (command over 0.8), and its tolerance; but for the time of the first
 * reports. */
void test_a_report_that_lacks_torque_is_named_and_makes_a_bounded_excess(void)
{
    const double shares[] = {0.0, 0.2, 0.5, 0.75};
    const int32_t asked_mNm = DEMAND_mNm - OPTIMUM_mNm;
    for (int k = 0; k < 8; k++) {
        setUp();
        run(k < 4 ? 0 : 500); /* from the first command on, or later */
        shown = shares[k % 4];
        for (int n = 0; n < 6000; n++) {
            const int32_t sum_mNm = run(1);
            if (n >= 100) {
                TEST_ASSERT_LESS_OR_EQUAL_INT32(DEMAND_mNm + asked_mNm / 4 + TOLERANCE_mNm,
                                                sum_mNm);
            }
            if (n == QUALIFY_ms + 2 * period_ms) {
                TEST_ASSERT_EQUAL_INT(k % 4 == 3 ? REASON_NONE : REASON_HYDRAULIC_WEAK, named());
            }
        }
        TEST_ASSERT_EQUAL_INT(k % 4 == 3   ? REASON_NONE
                              : k % 4 == 2 ? REASON_HYDRAULIC_WEAK
                                           : REASON_HYDRAULIC_DEAD,
                              named());
        shown = 1.0;
        run(5000);
        TEST_ASSERT_EQUAL_INT(REASON_NONE, named());
        TEST_ASSERT_INT32_WITHIN(1000, DEMAND_mNm, run(1));
    }
}

/* 27 N m of 40: less than 0.8 of them by more than the tolerance. */
void test_a_sensor_that_drifts_is_named_before_it_lacks_a_third(void)
{
    run(500);
    double at = 1.0;
    while (named() == REASON_NONE) {
        run(10);
        shown -= 0.001; /* 10 % a second */
        at = shown;
    }
    TEST_ASSERT_EQUAL_INT(REASON_HYDRAULIC_WEAK, named());
    TEST_ASSERT_TRUE(at > 0.68 && at < 0.8);
}

/* A real loss looks the same: the motor makes up for what the band explains, no more. */
void test_a_weak_brake_is_made_up_for_within_the_band(void)
{
    run(500);
    gain = 0.5;
    run(5000);
    const int32_t asked_mNm = DEMAND_mNm - OPTIMUM_mNm;
    TEST_ASSERT_EQUAL_INT(REASON_HYDRAULIC_WEAK, named());
    TEST_ASSERT_INT32_WITHIN(TOLERANCE_mNm, OPTIMUM_mNm + asked_mNm * 5 / 8, run(1));
    gain = 0.0;
    run(1000 - period_ms);
    TEST_ASSERT_EQUAL_INT(REASON_HYDRAULIC_WEAK, named());
    run(2 * period_ms);
    TEST_ASSERT_EQUAL_INT(REASON_HYDRAULIC_DEAD, named());
}

void test_a_brake_that_comes_within_a_second_and_a_half_was_late(void)
{
    for (int late = 0; late < 2; late++) {
        setUp();
        gain = 0.0;
        run(late == 0 ? 1400 : 1600);
        gain = 1.0;
        run(HEAL_ms + 2 * period_ms);
        TEST_ASSERT_EQUAL_INT(late == 0 ? REASON_HYDRAULIC_LATE : REASON_NONE, named());
        run(9900);
        TEST_ASSERT_EQUAL_INT(late == 0 ? REASON_HYDRAULIC_LATE : REASON_NONE, named());
        run(200);
        TEST_ASSERT_EQUAL_INT(REASON_NONE, named());
    }
}

/* One and a half times as much counts as 1.2 times: as much as the band explains is the loss where
 * the sensor is wrong, and the rest the excess where the brake is. */
void test_a_report_of_too_much_torque_is_named_and_takes_no_more_than_the_band_explains(void)
{
    const int32_t asked_mNm = DEMAND_mNm - OPTIMUM_mNm;
    run(500);
    shown = 1.5;
    for (int n = 0; n < 6000; n++) {
        TEST_ASSERT_GREATER_OR_EQUAL_INT32(DEMAND_mNm - asked_mNm / 4 - TOLERANCE_mNm, run(1));
    }
    TEST_ASSERT_EQUAL_INT(REASON_HYDRAULIC_STRONG, named());
    shown = 1.0;
    gain = 1.5;
    run(3000);
    TEST_ASSERT_EQUAL_INT(REASON_HYDRAULIC_STRONG, named());
    TEST_ASSERT_INT32_WITHIN(100, DEMAND_mNm + asked_mNm / 4, run(1)); /* 1.5/1.2 of it */
}

void test_a_sensor_stuck_at_its_end_takes_next_to_nothing_of_the_motor(void)
{
    in.brake_torque_mNm = 0;
    run(100);
    reports = false;
    for (int n = 0; n < QUALIFY_ms + HEAL_ms; n++) {
        in.hydraulic.age_ms = 0;
        in.hydraulic.torque_mNm = 300000;
        run(1);
    }
    TEST_ASSERT_EQUAL_INT(REASON_HYDRAULIC_STUCK, named());
    in.brake_torque_mNm = 20000;
    in.hydraulic.age_ms = 0;
    TEST_ASSERT_GREATER_OR_EQUAL_INT32(20000 - TOLERANCE_mNm, run(1));
}

void test_without_reports_nothing_is_named_and_with_missing_ones_these(void)
{
    reports = false;
    gain = 0.0;
    run(3000);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, named());
    assert_split(OPTIMUM_mNm, DEMAND_mNm - OPTIMUM_mNm, REASON_LOSS_OPTIMUM, out);
    reports = true;
    run(500);
    TEST_ASSERT_EQUAL_INT(REASON_HYDRAULIC_WEAK, named());
    reports = false;
    run(TIMEOUT_ms + HEAL_ms + 2 * period_ms);
    TEST_ASSERT_EQUAL_INT(REASON_HYDRAULIC_FEEDBACK, named());
}

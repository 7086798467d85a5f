/* SPDX-License-Identifier: Apache-2.0 */
/* What deceleration and reports of its torque say of the hydraulic brake, together; how a finding
 * ends. */
#include "hydraulic_watch_rig.h"

static const double FAST_rad_s = 200.0; /* time for several findings before the wheel stands */

void setUp(void)
{
    rig_up();
}

void tearDown(void) {}

/* A report of zero of a dead brake is right, the same of a healthy one is the sensor's. */
void test_deceleration_decides_between_brake_and_sensor(void)
{
    in.reported = true;
    run(COAST_ms);
    in.reported_mNm = 0;
    in.contradicts_mNm = -40000;
    TEST_ASSERT_EQUAL_INT(REASON_HYDRAULIC_WEAK, brake(60.0, 0.0, 400));
    TEST_ASSERT_TRUE(watch.confirms_report);
    in.contradicts_mNm = 0;
    in.reported_mNm = 60000;
    TEST_ASSERT_EQUAL_INT(REASON_HYDRAULIC_LATE, brake(60.0, 1.0, 400));

    setUp();
    in.reported = true;
    run(COAST_ms);
    in.contradicts_mNm = -40000;
    TEST_ASSERT_EQUAL_INT(REASON_NONE, brake(60.0, 1.0, 1500));
    TEST_ASSERT_FALSE(watch.confirms_report);
}

void test_used_reports_outside_the_band_name_the_brake(void)
{
    in.reported = true;
    used = true;
    run(COAST_ms);
    in.reported_mNm = 100000;
    in.outside_ms = config.brake.hydraulic_timeout_ms + 1;
    TEST_ASSERT_EQUAL_INT(REASON_HYDRAULIC_STRONG, brake(70.0, 1.0, 10));
    in.outside_ms = -in.outside_ms;
    TEST_ASSERT_EQUAL_INT(REASON_HYDRAULIC_WEAK, run(2 * HYDRAULIC_WATCH_SETTLE_ms));
}

/* The brake of a moving wheel fails, its reports say so and the deceleration agrees. */
static void confirmed_by_deceleration(int32_t contradicts_mNm, double command_nm, double gain)
{
    rig_up();
    speed_rad_s = FAST_rad_s;
    in.reported = true;
    run(COAST_ms);
    in.contradicts_mNm = contradicts_mNm;
    in.reported_mNm = (int32_t)lround(gain * command_nm * 1e3);
    (void)brake(command_nm, gain, 400);
    TEST_ASSERT_TRUE(watch.confirms_report);
    (void)run(HYDRAULIC_WATCH_SETTLE_ms); /* the filters, after the finding */
}

/* Reports above the model are the brake's as well, if the wheel slows down as much as they say. */
void test_deceleration_confirms_reports_of_more_torque_than_commanded(void)
{
    confirmed_by_deceleration(25000, 60.0, 1.6);
    TEST_ASSERT_EQUAL_INT(REASON_HYDRAULIC_STRONG, run(1));

    rig_up();
    in.reported = true;
    run(COAST_ms);
    in.contradicts_mNm = 25000;
    in.reported_mNm = 96000;
    TEST_ASSERT_EQUAL_INT(REASON_NONE, brake(60.0, 1.0, 1500));
    TEST_ASSERT_FALSE(watch.confirms_report);
}

/* Reports that agree with the command have to last as long as those that show a fault. */
static int32_t agreed_ms(void)
{
    return config.brake.hydraulic_timeout_ms + 1;
}

/* A confirmed finding lasts as long as the reports show it, however long: without them it is over
 * in one step, when they agree with the command in the time that makes reports used. */
void test_a_confirmed_finding_ends_with_the_reports_that_show_it(void)
{
    for (int reports = 0; reports < 2; reports++) {
        confirmed_by_deceleration(-40000, 60.0, 0.0);
        TEST_ASSERT_EQUAL_INT(REASON_HYDRAULIC_DEAD, run(HYDRAULIC_WATCH_LATE_ms));
        in.reported = reports != 0;
        in.contradicts_mNm = in.reported ? 0 : in.contradicts_mNm;
        in.reported_mNm = in.reported ? 60000 : 0;
        const int32_t ends_ms = in.reported ? agreed_ms() : 1;
        TEST_ASSERT_EQUAL_INT(REASON_HYDRAULIC_DEAD, run(ends_ms - 1));
        TEST_ASSERT_EQUAL_INT(REASON_NONE, run(1)); /* too long missing to be late */
        TEST_ASSERT_FALSE(watch.confirms_report);
        TEST_ASSERT_FALSE(hydraulic_watch_is_short(&watch));
        TEST_ASSERT_EQUAL_INT32(60000, hydraulic_watch_corrected_mNm(&watch, 60000));
    }
}

/* What was missing and is reported again within HYDRAULIC_WATCH_LATE is late; what was too much is
 * over. */
void test_the_end_of_an_excess_is_not_late(void)
{
    confirmed_by_deceleration(-40000, 60.0, 0.0);
    in.contradicts_mNm = 0;
    in.reported_mNm = 60000;
    TEST_ASSERT_EQUAL_INT(REASON_HYDRAULIC_LATE, run(agreed_ms()));
    confirmed_by_deceleration(25000, 60.0, 1.6);
    TEST_ASSERT_EQUAL_INT(REASON_HYDRAULIC_STRONG, run(1));
    in.contradicts_mNm = 0;
    TEST_ASSERT_EQUAL_INT(REASON_NONE, run(1));
}

/* Of a torque that is lost the reports name half or none: a quarter of the command is between. */
void test_reports_below_a_quarter_of_the_command_are_a_brake_without_torque(void)
{
    confirmed_by_deceleration(-40000, 60.0, 0.0);
    in.reported_mNm = 15001;
    run(1);
    TEST_ASSERT_EQUAL_INT32(30000, hydraulic_watch_corrected_mNm(&watch, 60000));
    in.reported_mNm = 15000;
    run(1);
    TEST_ASSERT_EQUAL_INT32(0, hydraulic_watch_corrected_mNm(&watch, 60000));
}

/* The floor is 0.4 rad/s^2 of the inertia: 10300 * 400 / 1024 = 4023 mN m. Above it a command is
 * exceeded, below it a brake does not release; what it was found as it stays. */
void test_used_reports_without_a_command_are_a_brake_that_does_not_release(void)
{
    static const struct {
        double command_nm;
        reason_t reason;
    } CASES[] = {{4.024, REASON_HYDRAULIC_STRONG}, {4.023, REASON_HYDRAULIC_STUCK}};
    for (int n = 0; n < 2; n++) {
        rig_up();
        speed_rad_s = FAST_rad_s;
        in.reported = true;
        used = true;
        run(COAST_ms);
        in.reported_mNm = 30000;
        in.outside_ms = config.brake.hydraulic_timeout_ms;
        TEST_ASSERT_EQUAL_INT(REASON_NONE, brake(CASES[n].command_nm, 1.0, 1));
        in.outside_ms++;
        TEST_ASSERT_EQUAL_INT(CASES[n].reason, run(1));
        (void)run(HYDRAULIC_WATCH_SETTLE_ms);
        /* Of the other kind now, and still the same brake. */
        TEST_ASSERT_EQUAL_INT(CASES[n].reason, brake(CASES[1 - n].command_nm, 1.0, 2));
        in.outside_ms = 0;
        TEST_ASSERT_EQUAL_INT(REASON_NONE, run(1)); /* it is over as soon as the reports say so */
    }
}

void test_a_short_brake_found_by_reports_stays_until_they_agree(void)
{
    speed_rad_s = FAST_rad_s;
    in.reported = true;
    used = true;
    run(COAST_ms);
    in.reported_mNm = 30000;
    in.outside_ms = -config.brake.hydraulic_timeout_ms - 1;
    TEST_ASSERT_EQUAL_INT(REASON_HYDRAULIC_WEAK, brake(60.0, 0.5, 1));
    in.outside_ms = -1; /* still short, of a later report */
    TEST_ASSERT_EQUAL_INT(REASON_HYDRAULIC_WEAK, run(HYDRAULIC_WATCH_SETTLE_ms + 2));
    in.outside_ms = 0;
    in.reported_mNm = 60000;
    TEST_ASSERT_EQUAL_INT(REASON_HYDRAULIC_LATE, run(agreed_ms()));
    in.outside_ms = -1; /* a single one is no finding */
    TEST_ASSERT_EQUAL_INT(REASON_HYDRAULIC_LATE, run(HYDRAULIC_WATCH_SETTLE_ms + 2));
}

/* A band of 25 % and a tolerance of 15 N m, a quarter of which a brake at work has to show: of 5 N
 * m and more commanded. */
static void found_by_used_reports(void)
{
    rig_up();
    config.brake.hydraulic_gain_band_q15 = 8192;
    config.brake.hydraulic_tolerance_mNm = 15000;
    config.brake.hydraulic_timeout_ms = 50;
    speed_rad_s = FAST_rad_s;
    in.reported = true;
    used = true;
    run(COAST_ms);
    in.reported_mNm = 0;
    in.outside_ms = -config.brake.hydraulic_timeout_ms - 1;
    TEST_ASSERT_EQUAL_INT(REASON_HYDRAULIC_WEAK, brake(12.0, 0.0, 1));
}

/* The motor makes up for a short brake, so that the commands become small: what such reports do not
 * contradict shows no brake at work. */
void test_commands_too_small_to_tell_leave_a_short_brake_found(void)
{
    found_by_used_reports();
    in.outside_ms = 0;
    (void)brake(5.0, 0.0, 3000);
    TEST_ASSERT_EQUAL_INT(REASON_HYDRAULIC_DEAD, watch.reason);
    in.reported_mNm = 5000; /* the tolerance alone explains it */
    TEST_ASSERT_EQUAL_INT(REASON_HYDRAULIC_DEAD, brake(5.0, 1.0, 500));
    in.reported_mNm = 5010;
    TEST_ASSERT_EQUAL_INT(REASON_NONE, brake(5.01, 1.0, agreed_ms()));
}

/* A report of an earlier, larger command is no agreement with the present one. */
void test_reports_agree_for_as_long_as_they_have_to_differ(void)
{
    found_by_used_reports();
    for (int n = 0; n < 20; n++) {
        in.outside_ms = 0;
        in.reported_mNm = 12000;
        (void)brake(12.0, 1.0, agreed_ms() - 1);
        in.outside_ms = n % 2 == 0 ? -1 : 0;
        in.reported_mNm = n % 2 == 0 ? 0 : 8900; /* less than 3/4 */
        TEST_ASSERT_TRUE(hydraulic_watch_is_short(&watch));
        (void)brake(12.0, 0.0, 1);
    }
    TEST_ASSERT_TRUE(hydraulic_watch_is_short(&watch));
    in.outside_ms = 0;
    in.reported_mNm = 12000;
    in.uncertain_mNm = 4010; /* it may be the torque of a command of 16 N m, three quarters made */
    (void)brake(12.0, 1.0, 500);
    TEST_ASSERT_TRUE(hydraulic_watch_is_short(&watch));
    in.uncertain_mNm = 3990;
    TEST_ASSERT_EQUAL_INT(REASON_NONE, brake(12.0, 1.0, agreed_ms()));
}

/* Reports that grow beyond the tolerance are no longer used. Then the deceleration decides: a dead
 * brake stays found, and is dead after a second; a healthy one was never late. */
void test_reports_that_are_no_longer_used_leave_the_finding_to_the_deceleration(void)
{
    found_by_used_reports();
    in.outside_ms = 0;
    in.contradicts_mNm = -30000;
    used = false;
    for (int n = 0; n < 1500; n++) {
        (void)brake(60.0, 0.0, 1);
        TEST_ASSERT_TRUE(hydraulic_watch_is_short(&watch));
    }
    TEST_ASSERT_TRUE(watch.confirms_report);
    TEST_ASSERT_EQUAL_INT(REASON_HYDRAULIC_DEAD, watch.reason);

    found_by_used_reports();
    in.outside_ms = 0;
    in.contradicts_mNm = -30000;
    used = false;
    made_nm = 12.0;
    for (int n = 0; n < 1500; n++) {
        (void)brake(60.0, 1.0, 1);
        TEST_ASSERT_NOT_EQUAL_INT(REASON_HYDRAULIC_LATE, watch.reason);
    }
    TEST_ASSERT_EQUAL_INT(REASON_NONE, watch.reason);
    TEST_ASSERT_FALSE(watch.confirms_report);
}

void test_missing_reports_end_what_they_found_and_show_no_late_brake(void)
{
    found_by_used_reports();
    in.reported = false;
    in.outside_ms = 0;
    TEST_ASSERT_EQUAL_INT(REASON_NONE, run(1));
}

/* Measured torque is what is expected, whatever its share of the command: the road does not follow
 * a part of it. */
void test_used_reports_of_a_weak_brake_leave_the_road_alone(void)
{
    found_by_used_reports();
    const int32_t road_q8_mNm = watch.road_q8_mNm;
    in.reported_mNm = 30000;
    TEST_ASSERT_EQUAL_INT(REASON_HYDRAULIC_WEAK, brake(60.0, 0.5, 1000));
    TEST_ASSERT_INT32_WITHIN(1000 * 256, road_q8_mNm, watch.road_q8_mNm);
}

/* Reports that are not used for a while, although they are right: what the deceleration lacks until
 * it has decided is no road either. */
void test_the_road_waits_until_the_deceleration_has_decided(void)
{
    found_by_used_reports();
    const int32_t road_q8_mNm = watch.road_q8_mNm;
    in.outside_ms = 0;
    used = false;
    int ms = 0;
    while (!watch.confirms_report && ms++ < 2000) {
        (void)brake(12.0, 0.0, 1);
        TEST_ASSERT_TRUE(hydraulic_watch_is_short(&watch));
    }
    TEST_ASSERT_TRUE(watch.confirms_report);
    TEST_ASSERT_EQUAL_INT32(road_q8_mNm, watch.road_q8_mNm);
}

/* Without reports: less torque than a brake found strong, or one that did not release, is its end.
 */
void test_an_excess_found_by_the_deceleration_ends_when_it_is_missing(void)
{
    speed_rad_s = FAST_rad_s;
    run(COAST_ms);
    TEST_ASSERT_EQUAL_INT(REASON_HYDRAULIC_STRONG, brake(80.0, 1.5, 1000));
    TEST_ASSERT_EQUAL_INT(REASON_NONE, brake(80.0, 1.0, 1000));
    TEST_ASSERT_EQUAL_INT32(80000, hydraulic_watch_corrected_mNm(&watch, 80000));
}

/* A wheel that slips while its brake is known to be short still has a brake that is short: slip
 * looks like an excess, never like missing torque. */
void test_a_slip_ends_an_excess_just_found_and_no_missing_torque(void)
{
    const double slip_nm = 20.0 * TORQUE_PER_M_S2; /* 20 m/s^2 at the rim */
    speed_rad_s = FAST_rad_s;
    run(COAST_ms);
    TEST_ASSERT_EQUAL_INT(REASON_HYDRAULIC_WEAK, brake(60.0, 0.0, 250));
    made_nm = slip_nm;
    TEST_ASSERT_EQUAL_INT(REASON_HYDRAULIC_WEAK, run(150));
}

/* Twice the configured inertia and more: learned as the heaviest. */
void test_the_learned_inertia_ends_at_the_heaviest(void)
{
    mass_factor = 2.3;
    run(COAST_ms);
    for (int n = 0; n < 10; n++) {
        motor_nm = n % 2 == 0 ? 60.0 : -60.0;
        (void)run(1000);
    }
    TEST_ASSERT_EQUAL_INT32(HYDRAULIC_WATCH_HEAVIEST_Q15, watch.weight_q15);
}

/* Used reports short of the band, of a brake that makes what is commanded: for one step the watch
 * says that they are wrong, and no finding is left. Of a weak brake they are right. */
void test_deceleration_refutes_used_reports_of_a_sensor_that_shows_too_little(void)
{
    for (int weak = 0; weak < 2; weak++) {
        rig_up();
        in.reported = true;
        run(COAST_ms);
        in.reported_mNm = 30000;
        in.outside_ms = -config.brake.hydraulic_timeout_ms - 1;
        int refuted = 0;
        for (int n = 0; n < 400 && refuted == 0; n++) {
            (void)brake(60.0, weak == 0 ? 1.0 : 0.5, 1);
            refuted += watch.refutes_report ? 1 : 0;
        }
        TEST_ASSERT_EQUAL_INT(weak == 0 ? 1 : 0, refuted);
        TEST_ASSERT_TRUE(watch.confirms_report == (weak != 0));
        TEST_ASSERT_TRUE((watch.reason == REASON_NONE) == (weak == 0));
        in.outside_ms = 0;
        (void)run(1);
        TEST_ASSERT_FALSE(watch.refutes_report);
    }
}

/* SPDX-License-Identifier: Apache-2.0 */
/* Brake blending beside a hydraulic brake that makes less than its command, with reports of its
 * torque and without. The vehicle is a mass of 10.3 kg m2 at the wheel, in double precision. */
#include <math.h>

#include "blending_rig.h"

static const double INERTIA_KG_M2 = 10.3, PER_MS = 1e-3;
enum { COAST_ms = 1500, DEMAND_mNm = 64000, OPTIMUM_mNm = 24000 };

static double speed_rad_s, gain, shown; /* shown: share of its torque that the sensor reports */
static bool reports;
static int period_ms, now_ms; /* of the reports */
static brake_blending_out_t out;

void setUp(void)
{
    rig_up();
    config.brake.hydraulic_timeout_ms = 50;
    config.brake.hydraulic_report_delay_ms = 0;
    config.brake.hydraulic_gain_band_q15 = 8192; /* a quarter */
    config.brake.hydraulic_tolerance_mNm = 15000;
    config.brake.hydraulic_watch_inertia_g_m2 = 10300;
    config.brake.hydraulic_watch_speed_mrad_s = 480;
    config.brake.hydraulic_watch_floor_mrad_s2 = 400;
    config.brake.hydraulic_watch_share_q15 = 4915;
    config.brake.hydraulic_watch_road_mrad_s2 = 10;
    config.vehicle.wheel_radius_um = 250000;
    config.monitor.tyre_grip_mm_s2 = 11768;
    config.motor.max_torque_mNm = 90000;
    capability.regenerating = limit_init(90000, REASON_MAX_TORQUE);
    capability.optimal = limit_init(OPTIMUM_mNm, REASON_LOSS_OPTIMUM);
    brake_blending_init(&state, &config);
    const hydraulic_feedback_t none = {0};
    in.hydraulic = none;
    in.seen = true;
    in.acknowledged = false;
    speed_rad_s = 150.0;
    gain = 1.0;
    shown = 1.0;
    reports = true;
    period_ms = 1;
    now_ms = 0;
    out.electric_mNm = 0;
    out.hydraulic_mNm = 0;
}

void tearDown(void) {}

/* The brakes make what they are commanded, the hydraulic one its gain of it, at once; the sensor
 * reports that in the next millisecond. */
static void run(int duration_ms)
{
    for (int n = 0; n < duration_ms; n++) {
        const double made_mNm = gain * out.hydraulic_mNm;
        speed_rad_s -= (out.electric_mNm + made_mNm) * 1e-3 / INERTIA_KG_M2 * PER_MS;
        speed_rad_s = fmax(speed_rad_s, 0.0);
        in.speed_mrad_s = (int32_t)lround(speed_rad_s * 1e3);
        motor_follows(out.electric_mNm);
        in.hydraulic.valid = reports;
        in.hydraulic.age_ms = (uint32_t)(now_ms % period_ms);
        if (in.hydraulic.age_ms == 0U) {
            in.hydraulic.torque_mNm = (int32_t)lround(shown * made_mNm);
        }
        now_ms++;
        out = step();
    }
}

/* Half of 40 N m: short of what a gain in its band explains by 10 N m, less than the tolerance, so
 * the reports are used. Once the deceleration agrees (half of the 20 N m, beyond a third of
 * 4.9 N m s: 0.2 s) the motor makes what is missing, beyond its loss optimum. */
void test_motor_makes_up_for_a_brake_whose_used_reports_are_short_of_its_band(void)
{
    run(COAST_ms);
    in.brake_torque_mNm = DEMAND_mNm;
    run(500);
    TEST_ASSERT_LESS_OR_EQUAL_INT32(OPTIMUM_mNm, out.electric_mNm);
    TEST_ASSERT_INT32_WITHIN(1, DEMAND_mNm, out.electric_mNm + out.hydraulic_mNm);
    gain = 0.5;
    run(100);
    TEST_ASSERT_EQUAL_INT(REASON_HYDRAULIC_WEAK, state.watch.reason);
    run(200);
    for (int n = 0; n < HYDRAULIC_WATCH_SETTLE_ms / 2; n++) {
        run(1);
        TEST_ASSERT_EQUAL_INT(REASON_HYDRAULIC_WEAK, state.watch.reason);
        TEST_ASSERT_INT32_WITHIN(500, DEMAND_mNm, out.electric_mNm + out.hydraulic_mNm / 2);
        TEST_ASSERT_GREATER_THAN_INT32(OPTIMUM_mNm + 10000, out.electric_mNm);
    }
}

/* Reports of a dead brake contradict its command, so they are not used, until the deceleration
 * agrees with them: then the motor makes up for it. */
void test_motor_makes_up_for_a_dead_brake_whose_reports_the_deceleration_confirms(void)
{
    run(COAST_ms);
    in.brake_torque_mNm = DEMAND_mNm;
    run(500);
    gain = 0.0;
    run(100);
    TEST_ASSERT_FALSE(hydraulic_feedback_used(&state.feedback));
    TEST_ASSERT_LESS_OR_EQUAL_INT32(OPTIMUM_mNm, out.electric_mNm);
    int ms = 0;
    while (!hydraulic_watch_is_short(&state.watch) && ms++ < 500) {
        run(1);
    }
    for (int n = 0; n < HYDRAULIC_WATCH_SETTLE_ms / 2; n++) {
        run(1);
        TEST_ASSERT_TRUE(hydraulic_watch_is_short(&state.watch));
        TEST_ASSERT_TRUE(hydraulic_feedback_used(&state.feedback));
        TEST_ASSERT_INT32_WITHIN(500, DEMAND_mNm, out.electric_mNm);
    }
}

/* What the motor makes instead leaves the dead brake next to no command. It stays found: a finding
 * that ended by its own relief came again after a quarter of a second, and the torque with it. */
void test_motor_makes_up_for_a_dead_brake_without_pause(void)
{
    run(COAST_ms);
    in.brake_torque_mNm = DEMAND_mNm;
    run(500);
    gain = 0.0;
    run(600);
    for (int n = 0; n < 6000; n++) {
        run(1);
        TEST_ASSERT_TRUE(hydraulic_watch_is_short(&state.watch));
        TEST_ASSERT_INT32_WITHIN(500, DEMAND_mNm, out.electric_mNm);
    }
    TEST_ASSERT_EQUAL_INT(REASON_HYDRAULIC_DEAD, state.watch.reason);
}

/* A slope, a tow or a test bench that holds the speed looks like a weak brake: without reports the
 * motor keeps to its loss optimum. */
void test_deceleration_alone_does_not_raise_the_motor_torque(void)
{
    reports = false;
    run(COAST_ms);
    in.brake_torque_mNm = DEMAND_mNm;
    run(500);
    gain = 0.0;
    run(600);
    TEST_ASSERT_TRUE(hydraulic_watch_is_short(&state.watch));
    assert_split(OPTIMUM_mNm, DEMAND_mNm - OPTIMUM_mNm, REASON_LOSS_OPTIMUM, out);
}

/* A sensor that shows less than the brake makes, from the first command on or later: the sum is
 * beyond the demand by a tenth for less than 100 ms. Then the sensor has the blame. */
void test_reports_that_are_too_small_do_not_raise_the_sum_of_both_brakes(void)
{
    const double shares[] = {0.0, 0.25, 0.5};
    for (int k = 0; k < 6; k++) {
        setUp();
        period_ms = 20;
        const bool later = k >= 3;
        run(COAST_ms);
        in.brake_torque_mNm = DEMAND_mNm;
        run(later ? 500 : 0);
        shown = shares[k % 3];
        int beyond_ms = 0;
        for (int n = 0; n < 1500; n++) {
            run(1);
            const int32_t sum_mNm = out.electric_mNm + out.hydraulic_mNm;
            beyond_ms = sum_mNm > DEMAND_mNm + DEMAND_mNm / 10 ? beyond_ms + 1 : 0;
            TEST_ASSERT_LESS_THAN_INT(100, beyond_ms);
            TEST_ASSERT_LESS_OR_EQUAL_INT32(DEMAND_mNm + DEMAND_mNm / 4, sum_mNm);
        }
        TEST_ASSERT_FALSE(hydraulic_feedback_used(&state.feedback));
        TEST_ASSERT_EQUAL_INT(REASON_HYDRAULIC_FEEDBACK, out.hydraulic_reason);
        TEST_ASSERT_EQUAL_INT(REASON_HYDRAULIC_FEEDBACK, found());
        TEST_ASSERT_INT32_WITHIN(1, DEMAND_mNm, out.electric_mNm + out.hydraulic_mNm);
        shown = 1.0;
        run(HYDRAULIC_FEEDBACK_HEAL_ms + period_ms);
        TEST_ASSERT_TRUE(hydraulic_feedback_used(&state.feedback));
        TEST_ASSERT_EQUAL_INT(REASON_NONE, found());
    }
}

/* One that shows more makes the motor give way until the deceleration shows that nothing brakes as
 * much. */
void test_reports_that_are_too_large_lose_torque_only_until_the_deceleration_refutes_them(void)
{
    period_ms = 20;
    run(COAST_ms);
    in.brake_torque_mNm = DEMAND_mNm;
    run(500);
    shown = 1.5;
    run(1000);
    TEST_ASSERT_EQUAL_INT(REASON_HYDRAULIC_FEEDBACK, found());
    TEST_ASSERT_INT32_WITHIN(1, DEMAND_mNm, out.electric_mNm + out.hydraulic_mNm);
}

/* SPDX-License-Identifier: Apache-2.0 */
/* Healthy brakes that the deceleration once made look wrong: air drag, the last edges of halls,
 * loads. */
#include "hydraulic_watch_rig.h"

void setUp(void)
{
    rig_up();
}

void tearDown(void) {}

static reason_t cruise_and_stop(double air)
{
    air_nm_s2 = air;
    motor_nm = air * speed_rad_s * speed_rad_s;
    run(COAST_ms);
    motor_nm = -40.0;
    return brake(80.0, 1.0, 4000);
}

/* 1.2 m/s^2 of air drag at 50 rad/s, half and one and a half times what is configured: a stop takes
 * it away within four seconds, in which a road may change by 0.3. */
void test_air_drag_that_a_stop_takes_away_is_no_weak_brake(void)
{
    const double air = 1.2 * TORQUE_PER_M_S2 / (50.0 * 50.0);
    for (double factor = 0.5; factor < 1.6; factor += 0.5) {
        setUp();
        config.brake.hydraulic_watch_drag_uNm_s2 = (int32_t)lround(1e6 * air);
        (void)cruise_and_stop(factor * air);
        TEST_ASSERT_TRUE(isnan(found_after_ms));
        TEST_ASSERT_TRUE(speed_rad_s < 4.0);
    }
    setUp();
    (void)cruise_and_stop(air);
    TEST_ASSERT_TRUE_MESSAGE(found_after_ms > 0.0, "a drag that is not configured looks weak");
    setUp();
    config.brake.hydraulic_watch_drag_uNm_s2 = (int32_t)lround(1e6 * air);
    air_nm_s2 = 1.5 * air;
    run(COAST_ms);
    TEST_ASSERT_EQUAL_INT(REASON_HYDRAULIC_WEAK, brake(80.0, 0.5, 1000));
}

/* What halls of 7 pole pairs show: the time between the last two edges. */
static void stop_with_halls(double first_edge, double fails_at_rad_s)
{
    const double pitch_rad = 6.283185307 / 42.0;
    double angle_rad = first_edge * pitch_rad, edges_rad_s = speed_rad_s;
    double since_s = angle_rad / speed_rad_s;
    while (speed_rad_s > 0.0 && isnan(found_after_ms)) {
        made_nm = speed_rad_s < fails_at_rad_s ? 0.0 : made_nm;
        angle_rad += speed_rad_s * PER_MS;
        since_s += PER_MS;
        if (angle_rad >= pitch_rad) {
            edges_rad_s = pitch_rad / since_s;
            angle_rad -= pitch_rad;
            since_s = 0.0;
        }
        seen_share = edges_rad_s / speed_rad_s;
        (void)run(1);
    }
}

/* 100 N m are 9.7 rad/s^2: no edge tells of the last 0.17 s, in which 1.7 rad/s are lost. The same
 * of another sensor would count, and a brake that fails half a second before standstill is
 * found. */
void test_the_last_edges_of_a_hard_stop_are_no_weak_brake(void)
{
    static const double FAILS_AT_RAD_S[] = {0.0, 0.0, 4.85};
    int found[3] = {0, 0, 0};
    for (int n = 0; n < 30; n++) {
        setUp();
        config.rotor.sensor = n % 3 == 0 ? CONFIG_ROTOR_ANGLE : CONFIG_ROTOR_HALL;
        run(COAST_ms);
        commanded_nm = 100.0;
        made_nm = 100.0;
        stop_with_halls(0.1 * (n / 3), FAILS_AT_RAD_S[n % 3]);
        found[n % 3] += isnan(found_after_ms) ? 0 : 1;
    }
    TEST_ASSERT_TRUE(found[0] > 0);
    TEST_ASSERT_EQUAL_INT(0, found[1]);
    TEST_ASSERT_EQUAL_INT(10, found[2]);
}

/* 3.4 rad/s are 0.35 s from standstill at 9.7 rad/s^2, and 34 ms behind the speed from which it is
 * 384 ms. A wheel that rolls on has no brake, which is found 448 ms behind that speed. */
void test_a_wheel_that_rolls_on_where_it_should_have_stopped_has_a_weak_brake(void)
{
    config.rotor.sensor = CONFIG_ROTOR_HALL;
    run(COAST_ms);
    while (speed_rad_s > 3.4) {
        TEST_ASSERT_EQUAL_INT(REASON_NONE, brake(100.0, 1.0, 1));
    }
    TEST_ASSERT_EQUAL_INT(REASON_NONE, brake(100.0, 0.0, HYDRAULIC_WATCH_ROLLS_ON_ms - 40));
    TEST_ASSERT_EQUAL_INT(REASON_HYDRAULIC_WEAK, brake(100.0, 0.0, 1000));
}

/* A third more or less load, downhill: the road that was followed in the stop holds a third of its
 * deceleration when the vehicle rolls off, slowed by its brake. */
void test_a_load_that_is_not_learned_has_no_finding_when_the_vehicle_rolls_off(void)
{
    for (mass_factor = 0.7; mass_factor < 1.4; mass_factor += 0.6) {
        const double factor = mass_factor;
        setUp();
        mass_factor = factor;
        slope = -0.08;
        speed_rad_s = 20.0;
        run(COAST_ms);
        TEST_ASSERT_EQUAL_INT(REASON_NONE, brake(90.0 * factor, 1.0, 10000));
        TEST_ASSERT_EQUAL_DOUBLE(0.0, speed_rad_s);
        for (int n = 0; n < 5000; n++) {
            TEST_ASSERT_EQUAL_INT(REASON_NONE, brake(8.0 + 2e-3 * n, 1.0, 1));
        }
        TEST_ASSERT_EQUAL_INT(32768, watch.weight_q15);
        TEST_ASSERT_TRUE(speed_rad_s > 4.0);
        mass_factor = factor;
    }
}

/* Acquired while the vehicle accelerates downhill, followed while it does not: the road no longer
 * holds what an inertia that is learned then would take from it. */
void test_a_road_that_was_followed_at_another_deceleration_stays_when_the_inertia_is_learned(void)
{
    mass_factor = 1.3;
    slope = -0.16;
    speed_rad_s = 20.0;
    run(HYDRAULIC_WATCH_ACQUIRE_ms + 500);
    const double level_nm = slope * G_M_S2 * TORQUE_PER_M_S2 * mass_factor;
    for (int n = 1; n <= 100; n++) { /* too slowly to learn from */
        motor_nm = level_nm * n / 100.0;
        TEST_ASSERT_EQUAL_INT(REASON_NONE, run(100));
    }
    TEST_ASSERT_EQUAL_INT(REASON_NONE, run(10000));
    TEST_ASSERT_EQUAL_INT(32768, watch.weight_q15);
    motor_nm = level_nm - 40.0;
    TEST_ASSERT_EQUAL_INT(REASON_NONE, run(400));
    TEST_ASSERT_DOUBLE_WITHIN(0.1, 1.3, watch.weight_q15 / 32768.0);
    motor_nm = level_nm;
    TEST_ASSERT_EQUAL_INT(REASON_NONE, brake(20.0, 1.0, 1500));
}

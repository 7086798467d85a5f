/* SPDX-License-Identifier: Apache-2.0 */
/* Road, tolerance and inertia of the watch of the hydraulic brake, in single steps from given
 * states. */
#include "hydraulic_watch_states.h"

enum {
    ONE_q15 = 32768,
    MOST_mNm = (1 << 23) - 1,
    CHANGE_q8_mNm = 74, /* 1.024 g m2 * 10 mrad/s2 * 30 rad/s / 2^22, down, and one */
    END_mNm_ms = ENOUGH_mNm_ms / 16 * 17
};

void setUp(void)
{
    states_up();
}

void tearDown(void) {}

/* The filtered speed rises by so many 256ths of a mrad/s in this step. */
static void rises_by(int32_t change_q8_mrad_s)
{
    watch.speed_lp_q8_mrad_s = FAST_mrad_s * 256 - 64 * change_q8_mrad_s;
}

/* ---- speed, slip and air drag ---- */

/* A wheel of 256 mm: the change in 256ths of a mrad/s is its rim's in mm/s^2. */
void test_a_rim_that_changes_its_speed_by_more_than_the_grip_slips(void)
{
    config.vehicle.wheel_radius_um = 256000;
    config.monitor.tyre_grip_mm_s2 = 11768;
    for (int32_t sign = -1; sign <= 1; sign += 2) {
        riding(0, 0, 0);
        rises_by(sign * 11768);
        step();
        TEST_ASSERT_EQUAL_INT32(0, watch.pause_ms);
        riding(0, 0, 0);
        rises_by(sign * 11769);
        step();
        TEST_ASSERT_EQUAL_INT32(HYDRAULIC_WATCH_PAUSE_ms, watch.pause_ms);
    }
    config.monitor.tyre_grip_mm_s2 = 1000000;
    riding(0, 0, 0);
    rises_by(1000001);
    step();
    TEST_ASSERT_EQUAL_INT32(HYDRAULIC_WATCH_PAUSE_ms, watch.pause_ms);
}

/* 30000^2 / 2^20 is 858.3, and 858 * 1001 / 2^10 is 838.7. */
void test_air_drag_is_its_share_of_the_squared_speed(void)
{
    config.brake.hydraulic_watch_drag_uNm_s2 = 1001;
    riding(0, 0, 0);
    step();
    TEST_ASSERT_EQUAL_INT32(838, watch.road_mNm);
}

/* ---- the road ---- */

/* Before standstill 8 N m let 1.024 kg m2 stand from 3 rad/s within 384 ms. */
static int32_t rolls_on_ms(int32_t sensor, int32_t speed_mrad_s)
{
    riding(0, 10000, 8000);
    config.rotor.sensor = sensor;
    in.speed_mrad_s = speed_mrad_s;
    watch.backwards = speed_mrad_s < 0;
    watch.speed_lp_q8_mrad_s = 3000 * 256;
    watch.road_q8_mNm += 255;
    watch.rolls_on_ms = 7;
    step();
    return watch.rolls_on_ms;
}

void test_all_known_torques_and_the_road_tell_when_a_wheel_with_halls_ends_its_ride(void)
{
    const int32_t all_ms = HYDRAULIC_WATCH_ROLLS_ON_ms;
    for (int32_t sign = -1; sign <= 1; sign += 2) {
        TEST_ASSERT_EQUAL_INT32(6, rolls_on_ms(CONFIG_ROTOR_HALL, sign * 2999));
        TEST_ASSERT_EQUAL_INT32(all_ms, rolls_on_ms(CONFIG_ROTOR_HALL, sign * 3000));
        TEST_ASSERT_EQUAL_INT32(all_ms, rolls_on_ms(CONFIG_ROTOR_ANGLE, sign * 2999));
    }
}

/* ---- a load that may have changed ---- */

/* An inertial torque of 400 mN m, of whose quarter so many 256ths are followed after this step. */
static bool stale_with(int32_t followed_q8_mNm)
{
    riding(0, 0, 0);
    rises_by(100);
    const bool below = followed_q8_mNm < 100 * 256;
    watch.stale = true;
    watch.quarter_q8_mNm = followed_q8_mNm + (below ? -CHANGE_q8_mNm : CHANGE_q8_mNm);
    step();
    TEST_ASSERT_EQUAL_INT32(followed_q8_mNm, watch.quarter_q8_mNm);
    return watch.stale;
}

/* Reports that contradict the commands a little: the sums go on. */
static void contradicted(void)
{
    in.reported = true;
    in.contradicts_mNm = 1;
}

/* 250 and 150 mN m are the floor, either sign and order. */
void test_a_load_is_known_when_a_road_holds_less_than_the_floor_of_it(void)
{
    TEST_ASSERT_TRUE(stale_with(-150 * 256));
    TEST_ASSERT_FALSE(stale_with(-150 * 256 + 1));
    TEST_ASSERT_TRUE(stale_with(250 * 256));
    TEST_ASSERT_FALSE(stale_with(250 * 256 - 1));
    TEST_ASSERT_FALSE(stale_with(100 * 256 + 1));
}

/* ---- the tolerance ---- */

/* A quarter of the brake's torque, an eighth of what the motor has not made for long. */
void test_shares_of_both_torques_are_tolerated_beside_reports(void)
{
    contradicted();
    riding(-16000, 40000, 30000);
    step();
    TEST_ASSERT_EQUAL_INT32(30000 - FLOOR_mNm - 10000, watch.missing_mNm_ms);
    /* from rest: -1000 / 512, down, are -2 and -32; 15968 are left */
    riding(-16000, 40000, 30000);
    watch.motor_lp_mNm.accumulator = 0;
    step();
    TEST_ASSERT_EQUAL_INT32(-1000, watch.motor_lp_mNm.accumulator);
    TEST_ASSERT_EQUAL_INT32(30000 - FLOOR_mNm - 10000 - 1996, watch.missing_mNm_ms);
    riding(-16000, 40000, -30000);
    watch.motor_lp_mNm.accumulator = 0;
    step();
    TEST_ASSERT_EQUAL_INT32(30000 - FLOOR_mNm - 10000 - 1996, watch.excess_mNm_ms);
}

/* 2^23 and a fifth and a tenth of it, less 23 / 80 and 46 / 160. */
void test_the_torque_that_is_expected_is_limited(void)
{
    config.brake.hydraulic_watch_share_q15 = ONE_q15;
    const int32_t tolerated_mNm = FLOOR_mNm + 1677721 + 838860;
    riding(0, MOST_mNm, 0);
    in.modelled_mNm = MOST_mNm + 1000; /* 16 more would be 0.2 and 0.1 more of the parts */
    watch.road_q8_mNm = (MOST_mNm - tolerated_mNm - 1000) * 256;
    step();
    TEST_ASSERT_EQUAL_INT32(1000, watch.missing_mNm_ms);
}

/* Three floors, and three quarters of what the motor has not made for long. */
void test_more_is_tolerated_of_an_excess_without_a_command(void)
{
    riding(-16000, 0, -30000);
    watch.motor_lp_mNm.accumulator = 0;
    step();
    TEST_ASSERT_EQUAL_INT32(30000 - 3 * FLOOR_mNm - 3 * 3992, watch.excess_mNm_ms);
}

/* ---- beside the floor ---- */

static int32_t acquired_ms(int32_t modelled_mNm, int32_t uncertain_mNm, int32_t speed_mrad_s)
{
    riding(0, modelled_mNm, 0);
    in.uncertain_mNm = uncertain_mNm;
    in.speed_mrad_s = speed_mrad_s;
    watch.backwards = speed_mrad_s < 0;
    watch.acquired_ms = 7;
    watch.pause_ms = 1;
    step();
    return watch.acquired_ms;
}

void test_a_road_is_acquired_with_a_brake_that_is_certain_up_to_the_floor(void)
{
    TEST_ASSERT_EQUAL_INT32(8, acquired_ms(40000, FLOOR_mNm, FAST_mrad_s));
    TEST_ASSERT_TRUE(watch.provisional);
    TEST_ASSERT_EQUAL_INT32(7, acquired_ms(40000, FLOOR_mNm + 1, FAST_mrad_s));
    TEST_ASSERT_FALSE(watch.provisional);
    TEST_ASSERT_EQUAL_INT32(8, acquired_ms(0, FLOOR_mNm, FAST_mrad_s));
    TEST_ASSERT_FALSE(watch.provisional);
}

void test_a_road_is_acquired_above_the_start_of_the_blend_out(void)
{
    for (int32_t sign = -1; sign <= 1; sign += 2) {
        TEST_ASSERT_EQUAL_INT32(7, acquired_ms(0, 0, sign * 2600));
        TEST_ASSERT_EQUAL_INT32(8, acquired_ms(0, 0, sign * 2601));
    }
}

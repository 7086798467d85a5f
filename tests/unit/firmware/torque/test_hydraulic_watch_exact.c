/* SPDX-License-Identifier: Apache-2.0 */
/* Arithmetic of the watch of the hydraulic brake, in single steps from given states: limits, road,
 * tolerance and inertia to the unit. */
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

/* Four times the change, rounded towards a filter that stays: 3.98 either way are 3. */
void test_the_inertial_torque_is_that_of_whole_changes_of_the_filtered_speed(void)
{
    for (int32_t sign = -1; sign <= 1; sign += 2) {
        riding(0, 0, 0);
        watch.speed_lp_q8_mrad_s = FAST_mrad_s * 256 - sign * (64 * 3 + 63);
        step();
        TEST_ASSERT_EQUAL_INT32(sign * 3 * 4, watch.inertial_mNm);
        TEST_ASSERT_EQUAL_INT32(sign * 3 * 4, watch.road_mNm);
    }
}

void test_torques_are_limited_before_they_are_filtered(void)
{
    config.brake.hydraulic_watch_inertia_g_m2 = 1 << 22;
    riding(0, 0, 0);
    rises_by(600);
    step();
    TEST_ASSERT_EQUAL_INT32(MOST_mNm, watch.inertial_mNm);
    TEST_ASSERT_EQUAL_INT32(MOST_mNm, watch.road_mNm);
    riding(0, 0, 0);
    in.motor_mNm = MOST_mNm + 6400;
    step();
    TEST_ASSERT_EQUAL_INT32(MOST_mNm, watch.known_lp_mNm.accumulator);
    TEST_ASSERT_EQUAL_INT32(MOST_mNm / 16, watch.motor_lp_mNm.accumulator); /* in units of 16 */
    riding(0, 0, 0);
    in.motor_mNm = -MOST_mNm - 6400;
    step();
    TEST_ASSERT_EQUAL_INT32(-MOST_mNm, watch.known_lp_mNm.accumulator);
}

/* 30000^2 / 2^20 is 858.3, and 858 * 1001 / 2^10 is 838.7. */
void test_air_drag_is_its_share_of_the_squared_speed(void)
{
    config.brake.hydraulic_watch_drag_uNm_s2 = 1001;
    riding(0, 0, 0);
    step();
    TEST_ASSERT_EQUAL_INT32(838, watch.road_mNm);
}

/* 8388607 mrad/s are the largest of the filter: 2^26 of a squared speed, less one. */
void test_air_drag_ends_at_the_largest_torque(void)
{
    riding(-1000, 0, 0);
    config.brake.hydraulic_watch_drag_uNm_s2 = 1 << 16;
    in.speed_mrad_s = INT32_MAX;
    watch.speed_lp_q8_mrad_s = INT32_MAX;
    step();
    TEST_ASSERT_EQUAL_INT32(MOST_mNm, watch.road_mNm);
}

/* ---- the road ---- */

/* Twice the largest torque apart. */
void test_the_road_follows_the_largest_difference_either_way(void)
{
    config.brake.hydraulic_watch_inertia_g_m2 = 1 << 22;
    for (int32_t sign = -1; sign <= 1; sign += 2) {
        const int32_t apart_q8_mNm = sign < 0 ? MOST_mNm * 256 : -MOST_mNm * 256;
        riding(0, 0, 0);
        watch.road_q8_mNm = apart_q8_mNm;
        rises_by(sign * 600);
        step();
        TEST_ASSERT_EQUAL_INT32(sign * MOST_mNm, watch.road_mNm);
        TEST_ASSERT_EQUAL_INT32(apart_q8_mNm + sign * 300001, watch.road_q8_mNm);
    }
}

void test_the_road_follows_by_what_it_may_change_in_a_step(void)
{
    for (int32_t sign = -1; sign <= 1; sign += 2) {
        riding(0, 40000, sign * 30000);
        const int32_t before_q8_mNm = watch.road_q8_mNm;
        step();
        TEST_ASSERT_EQUAL_INT32(before_q8_mNm + sign * CHANGE_q8_mNm, watch.road_q8_mNm);
    }
    riding(0, 0, 0);
    step();
    TEST_ASSERT_EQUAL_INT32(0, watch.road_q8_mNm);
}

/* Inertia times slope counts as 2^31 - 1 at most: times 402 and by 2^22 205823, and one. */
void test_the_change_of_the_road_is_of_a_product_within_the_range_of_numbers(void)
{
    config.brake.hydraulic_watch_inertia_g_m2 = 1 << 20;
    config.brake.hydraulic_watch_road_mrad_s2 = 1 << 12;
    riding(0, 40000, 30000);
    in.speed_mrad_s = 402;
    watch.speed_lp_q8_mrad_s = 402 * 256;
    step();
    TEST_ASSERT_EQUAL_INT32(10000 * 256 + 205824, watch.road_q8_mNm);
    watch.road_q8_mNm = 39990 * 256; /* 10 mN m away, less than it may change */
    step();
    TEST_ASSERT_EQUAL_INT32(40000 * 256, watch.road_q8_mNm);
}

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

/* 10 N m of a quarter that are not there any more, less the step: 39.97 N m of which 9.999. */
void test_what_a_stale_road_has_not_followed_is_tolerated(void)
{
    riding(0, 40000, 30000);
    contradicted();
    watch.stale = true;
    watch.quarter_q8_mNm = 10000 * 256 + CHANGE_q8_mNm - 1;
    step();
    TEST_ASSERT_EQUAL_INT32(30000 - FLOOR_mNm - 10000 - 9999, watch.missing_mNm_ms);
    riding(0, 0, -30000);
    watch.stale = true;
    watch.quarter_q8_mNm = 10000 * 256 + CHANGE_q8_mNm - 1;
    step();
    TEST_ASSERT_EQUAL_INT32(30000 - 3 * FLOOR_mNm - 9999, watch.excess_mNm_ms);
    riding(0, 40000, 30000);
    watch.quarter_q8_mNm = 10000 * 256;
    step();
    TEST_ASSERT_EQUAL_INT32(30000 - FLOOR_mNm - 10000, watch.missing_mNm_ms);
}

/* Commands and reports agree, so what is missing or in excess is the road's, and names no brake. */
void test_reports_that_agree_with_the_commands_leave_both_sums_at_zero(void)
{
    for (int way = 0; way < 2; way++) {
        riding(0, 40000, way == 0 ? 30000 : -30000);
        in.reported = true;
        watch.missing_mNm_ms = way == 0 ? END_mNm_ms : 0;
        watch.excess_mNm_ms = way == 0 ? 0 : END_mNm_ms;
        step();
        TEST_ASSERT_EQUAL_INT(REASON_NONE, watch.reason);
        TEST_ASSERT_EQUAL_INT32(0, watch.missing_mNm_ms);
        TEST_ASSERT_EQUAL_INT32(0, watch.excess_mNm_ms);
    }
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

/* Three quarters of what is uncertain, up. */
void test_what_the_times_of_the_brake_leave_open_is_tolerated(void)
{
    contradicted();
    riding(0, 40000, 30000);
    in.uncertain_mNm = 4003;
    step();
    TEST_ASSERT_EQUAL_INT32(30000 - FLOOR_mNm - 10000 - 3003, watch.missing_mNm_ms);
}

/* A fifth of 40 N m less 23 / 16, and a tenth of them less 46 / 16: 5 and 10 sixteenths of the
 * road's 74 256ths, each sum down. */
void test_without_reports_parts_are_tolerated_until_the_road_has_followed_them(void)
{
    config.brake.hydraulic_watch_share_q15 = 16384;
    riding(0, 40000, 30000);
    step();
    TEST_ASSERT_EQUAL_INT32(23, watch.hydraulic_q4_mNm);
    TEST_ASSERT_EQUAL_INT32(-46, watch.known_q4_mNm);
    TEST_ASSERT_EQUAL_INT32(30000 - FLOOR_mNm - 7999 - 3999, watch.missing_mNm_ms);
    riding(0, 40000, 30000);
    watch.hydraulic_q4_mNm = 40000 * 16 + 10;
    watch.known_q4_mNm = -40000 * 16 - 10;
    step();
    TEST_ASSERT_EQUAL_INT32(40000 * 16, watch.hydraulic_q4_mNm);
    TEST_ASSERT_EQUAL_INT32(-40000 * 16, watch.known_q4_mNm);
    TEST_ASSERT_EQUAL_INT32(30000 - FLOOR_mNm, watch.missing_mNm_ms);
}

/* 2^20 g m2 and 2^11 mrad/s2: the road may change by 15360000, the parts by those of 2^23. */
void test_parts_are_followed_by_those_of_a_largest_change(void)
{
    config.brake.hydraulic_watch_inertia_g_m2 = 1 << 20;
    config.brake.hydraulic_watch_road_mrad_s2 = 1 << 11;
    config.brake.hydraulic_watch_floor_mrad_s2 = 0;
    riding(0, 1000000, 30000);
    step();
    TEST_ASSERT_EQUAL_INT32((1 << 23) / 16 * 5, watch.hydraulic_q4_mNm);
    TEST_ASSERT_EQUAL_INT32(-(1 << 23) / 16 * 10, watch.known_q4_mNm);
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

void test_a_sum_without_reports_ends_with_a_sixteenth_more(void)
{
    contradicted();
    for (int32_t short_mNm = 0; short_mNm <= 1; short_mNm++) {
        riding(0, 40000, 30000);
        watch.missing_mNm_ms = END_mNm_ms - (30000 - FLOOR_mNm - 10000) - short_mNm;
        step();
        TEST_ASSERT_EQUAL_INT(short_mNm ? REASON_NONE : REASON_HYDRAULIC_WEAK, watch.reason);
        riding(0, 40000, -30000);
        watch.excess_mNm_ms = END_mNm_ms - (30000 - FLOOR_mNm - 10000) - short_mNm;
        step();
        TEST_ASSERT_EQUAL_INT(short_mNm ? REASON_NONE : REASON_HYDRAULIC_STRONG, watch.reason);
    }
}

/* Half of the largest number counts, and a sixteenth more of that: 67108863 * 17. */
void test_the_end_of_a_sum_is_within_the_range_of_numbers(void)
{
    config.brake.hydraulic_watch_speed_mrad_s = 1 << 24;
    riding(0, 40000, 30000);
    contradicted();
    watch.missing_mNm_ms = INT32_MAX - 1;
    step();
    TEST_ASSERT_EQUAL_INT(REASON_HYDRAULIC_WEAK, watch.reason);
    riding(0, 40000, 30000);
    watch.missing_mNm_ms = 67108863 * 17 - 19601;
    step();
    TEST_ASSERT_EQUAL_INT(REASON_NONE, watch.reason);
    TEST_ASSERT_EQUAL_INT32(67108863 * 17 - 1, watch.missing_mNm_ms);
}

/* ---- beside the floor ---- */

void test_a_torque_above_the_floor_is_commanded(void)
{
    riding(0, FLOOR_mNm, 30000);
    step();
    TEST_ASSERT_EQUAL_INT32(0, watch.missing_mNm_ms);
    riding(0, FLOOR_mNm + 1, 30000);
    step();
    TEST_ASSERT_GREATER_THAN_INT32(20000, watch.missing_mNm_ms);
}

void test_torque_and_what_is_uncertain_up_to_the_floor_are_quiet(void)
{
    riding(0, FLOOR_mNm - 100, 0);
    in.uncertain_mNm = 100;
    step();
    TEST_ASSERT_EQUAL_INT32(1, watch.quiet_ms);
    in.uncertain_mNm = 101;
    step();
    TEST_ASSERT_EQUAL_INT32(0, watch.quiet_ms);
}

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

void test_the_road_waits_for_a_brake_that_is_uncertain_by_more_than_the_floor(void)
{
    riding(0, 40000, 30000);
    in.uncertain_mNm = FLOOR_mNm;
    watch.certain_ms = HYDRAULIC_WATCH_AWAITS_ms;
    step();
    TEST_ASSERT_EQUAL_INT32(10000 * 256 + CHANGE_q8_mNm, watch.road_q8_mNm);
    TEST_ASSERT_EQUAL_INT32(HYDRAULIC_WATCH_AWAITS_ms, watch.certain_ms);
    in.uncertain_mNm = FLOOR_mNm + 1;
    step();
    TEST_ASSERT_EQUAL_INT32(10000 * 256 + CHANGE_q8_mNm, watch.road_q8_mNm);
    TEST_ASSERT_EQUAL_INT32(HYDRAULIC_WATCH_AWAITS_ms - 1, watch.certain_ms);
}

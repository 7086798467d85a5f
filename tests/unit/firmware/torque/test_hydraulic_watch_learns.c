/* SPDX-License-Identifier: Apache-2.0 */
/* The inertia that the watch of the hydraulic brake learns, in single steps from given states. With
 * one of 1.024 kg m2 the floor is 400 mN m, and a change of the filtered speed by 256ths of a
 * mrad/s four times as many millinewton metres. */
#include "hydraulic_watch_rig.h"

enum {
    ONE_q15 = 32768,
    FAST_mrad_s = 30000,
    STEP_mNm = 25600, /* 25500 beside its slow filter, that began at zero */
    SEEN_mNm = 25500
};

void setUp(void)
{
    rig_up();
    config.brake.hydraulic_watch_inertia_g_m2 = 1024;
    config.brake.hydraulic_watch_road_mrad_s2 = 0;
    config.monitor.tyre_grip_mm_s2 = 1000000;
    config.rotor.sensor = CONFIG_ROTOR_ANGLE;
    in.speed_mrad_s = FAST_mrad_s;
}

void tearDown(void) {}

/* The motor's torque, alone and for longer than the fast filters, and what the speed does. */
static void stepped(int32_t motor_mNm, int32_t change_q8_mrad_s)
{
    in.motor_mNm = motor_mNm;
    watch.rolls = true;
    watch.acquired_ms = HYDRAULIC_WATCH_ACQUIRE_ms;
    watch.quiet_ms = HYDRAULIC_WATCH_QUIET_ms;
    watch.speed_lp_q8_mrad_s = FAST_mrad_s * 256 - 64 * change_q8_mrad_s;
    watch.known_lp_mNm.accumulator = motor_mNm * 64;
    watch.known_slow_mNm.accumulator = 0;
    watch.inertial_slow_mNm.accumulator = 0;
    hydraulic_watch_step(&watch, &config, &in);
}

static void assert_sums(int64_t square, int64_t by_inertial)
{
    TEST_ASSERT_EQUAL_INT64(square, watch.known_square);
    TEST_ASSERT_EQUAL_INT64(by_inertial, watch.known_by_inertial);
}

/* 6400 * 4 are as much as the motor's. */
void test_steps_of_known_and_inertial_torque_are_summed(void)
{
    const int64_t square = (int64_t)SEEN_mNm * SEEN_mNm;
    stepped(STEP_mNm, 6400);
    assert_sums(square, square);
    TEST_ASSERT_EQUAL_INT32(STEP_mNm, watch.known_slow_mNm.accumulator);
    TEST_ASSERT_EQUAL_INT32(STEP_mNm, watch.inertial_slow_mNm.accumulator);
    hydraulic_watch_init(&watch);
    stepped(-STEP_mNm, 6400);
    assert_sums(square, -square);
    hydraulic_watch_init(&watch);
    stepped(-STEP_mNm, -6400);
    assert_sums(square, square);
}

/* An 8192nd in each step, both towards zero. */
void test_what_was_learned_fades(void)
{
    watch.known_square = 8192 * 1000 + 8191;
    watch.known_by_inertial = -(8192 * 500 + 8191);
    stepped(STEP_mNm, 0);
    assert_sums((int64_t)SEEN_mNm * SEEN_mNm + 8192 * 1000 + 8191 - 1000, -8192 * 500 - 8191 + 500);
    watch.known_square = 0;
    watch.known_by_inertial = 8192 * 500 + 8191;
    stepped(STEP_mNm, 0);
    assert_sums((int64_t)SEEN_mNm * SEEN_mNm, 8192 * 500 + 8191 - 500);
}

/* 803 are 800 beside a slow filter of 3, 804 are 801. */
void test_a_step_of_more_than_two_floors_shows_the_inertia(void)
{
    stepped(803, 0);
    assert_sums(0, 0);
    stepped(804, 0);
    assert_sums(801 * 801, 0);
    hydraulic_watch_init(&watch);
    stepped(-803, 0); /* a slow filter of -4 */
    assert_sums(0, 0);
    stepped(-805, 0);
    assert_sums(801 * 801, 0);
}

void test_steps_show_the_inertia_after_the_quiet_time(void)
{
    watch.known_slow_mNm.accumulator = 0;
    stepped(804, 0);
    assert_sums(801 * 801, 0);
    watch.known_slow_mNm.accumulator = 0;
    watch.quiet_ms = HYDRAULIC_WATCH_QUIET_ms - 1;
    hydraulic_watch_step(&watch, &config, &in);
    assert_sums(801 * 801, 0);
    TEST_ASSERT_EQUAL_INT32(HYDRAULIC_WATCH_QUIET_ms, watch.quiet_ms);
    watch.known_slow_mNm.accumulator = 0;
    hydraulic_watch_step(&watch, &config, &in);
    assert_sums(2 * 801 * 801 - (801 * 801 >> 13), 0);
}

/* 2^22 of both, less 2^14. */
void test_steps_are_limited(void)
{
    const int64_t most = ((1 << 22) - (1 << 14)) * (int64_t)((1 << 22) - (1 << 14));
    config.brake.hydraulic_watch_inertia_g_m2 = 1 << 20;
    config.brake.hydraulic_watch_floor_mrad_s2 = 0;
    stepped((1 << 22) + 6400, 1100);
    assert_sums(most, most);
    hydraulic_watch_init(&watch);
    stepped(-(1 << 22) - 6400, -1100);
    assert_sums(most, most);
    watch.pause_ms = 2;
    stepped((1 << 22) + 6400, 1100);
    TEST_ASSERT_EQUAL_INT32(1 << 30, watch.known_slow_mNm.accumulator);
    TEST_ASSERT_EQUAL_INT32(1 << 30, watch.inertial_slow_mNm.accumulator);
}

/* 400^2 * 2^13 are 1310720000; 25500^2 are 650250000, so that 660469999 and an 8191st of that,
 * 660550632, are short of it by one, and two more reach what is more. */
void test_the_inertia_is_weighed_beyond_enough_of_the_steps(void)
{
    int64_t before = 660550632;
    for (int64_t sum = 0; sum < 1310720000; before++) {
        sum = before + 1 - ((before + 1) >> 13) + 650250000;
    }
    watch.known_square = before;
    stepped(STEP_mNm, 0);
    TEST_ASSERT_EQUAL_INT64(1310720000, watch.known_square);
    TEST_ASSERT_EQUAL_INT32(ONE_q15, watch.weight_q15);
    watch.known_square = before + 1;
    stepped(STEP_mNm, 0);
    TEST_ASSERT_EQUAL_INT64(1310720001, watch.known_square);
    TEST_ASSERT_EQUAL_INT32(HYDRAULIC_WATCH_HEAVIEST_Q15, watch.weight_q15);
}

/* One step of 51 N m is enough. The inertia is heavier as the speed changes by less. */
static int32_t weight_q15(int32_t change_q8_mrad_s)
{
    hydraulic_watch_init(&watch);
    stepped(51200, change_q8_mrad_s);
    return watch.weight_q15;
}

void test_the_inertia_is_known_over_inertial_torque_within_its_limits(void)
{
    TEST_ASSERT_EQUAL_INT32(ONE_q15, weight_q15(12800));
    TEST_ASSERT_EQUAL_INT32(ONE_q15 * 4 / 5, weight_q15(16000));
    TEST_ASSERT_INT32_WITHIN(1, ONE_q15 * 4 / 3, weight_q15(9600));
    TEST_ASSERT_EQUAL_INT32(HYDRAULIC_WATCH_LIGHTEST_Q15, weight_q15(25600));
    TEST_ASSERT_EQUAL_INT32(HYDRAULIC_WATCH_HEAVIEST_Q15, weight_q15(7000));
    TEST_ASSERT_EQUAL_INT32(HYDRAULIC_WATCH_HEAVIEST_Q15, weight_q15(5000));
    TEST_ASSERT_EQUAL_INT32(HYDRAULIC_WATCH_HEAVIEST_Q15, weight_q15(0));
    TEST_ASSERT_EQUAL_INT32(HYDRAULIC_WATCH_HEAVIEST_Q15, weight_q15(-12800));
}

/* 128 * 256 are 32768, and by 2^15 one: half of the inertia by as little as that. */
void test_steps_without_a_floor_are_weighed_from_their_first_units(void)
{
    config.brake.hydraulic_watch_floor_mrad_s2 = 0;
    watch.inertial_slow_mNm.accumulator = 0;
    config.brake.hydraulic_watch_inertia_g_m2 = 257;
    stepped(128, 256);
    assert_sums(128 * 128, 32768);
    TEST_ASSERT_EQUAL_INT32(HYDRAULIC_WATCH_LIGHTEST_Q15, watch.weight_q15);
    hydraulic_watch_init(&watch);
    watch.known_by_inertial = -1;
    stepped(128, 256);
    assert_sums(128 * 128, 32767);
    TEST_ASSERT_EQUAL_INT32(HYDRAULIC_WATCH_HEAVIEST_Q15, watch.weight_q15);
    watch.known_square = INT64_C(1) << 32; /* times 2^15 of as little inertial torque */
    watch.known_by_inertial = 65536;
    stepped(128, 0);
    TEST_ASSERT_EQUAL_INT32(HYDRAULIC_WATCH_HEAVIEST_Q15, watch.weight_q15);
}

/* A quarter of 6400 / 256: 22938 / 32768 more of it are 4480, and of all four times that. */
void test_what_is_now_the_inertias_is_taken_from_the_road(void)
{
    watch.quarter_q8_mNm = 6400;
    watch.road_q8_mNm = 5000;
    stepped(51200, 0);
    /* a step of the least change towards what is missing, which is negative */
    TEST_ASSERT_EQUAL_INT32(5000 + 4 * 4480 - 1, watch.road_q8_mNm);
    TEST_ASSERT_EQUAL_INT32(6399, watch.quarter_q8_mNm);
    hydraulic_watch_init(&watch);
    watch.quarter_q8_mNm = 6400;
    watch.road_q8_mNm = INT32_MAX - 100;
    stepped(51200, 0);
    TEST_ASSERT_EQUAL_INT32(INT32_MAX - 1, watch.road_q8_mNm);
}

/* Of 51.2 N m that take 64 N m of the configured inertia four fifths are the inertia's. */
void test_the_inertial_torque_is_that_of_the_inertia_learned(void)
{
    (void)weight_q15(16000);
    TEST_ASSERT_EQUAL_INT32(64000, watch.inertial_mNm);
    TEST_ASSERT_INT32_WITHIN(2, 0, watch.road_mNm);
}

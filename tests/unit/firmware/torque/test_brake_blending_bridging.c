/* SPDX-License-Identifier: Apache-2.0 */
/* Bridging of a deferrable limit that falls, and the speed and limit expected, from given states,
 * to the unit. The brake has a dead time of 40 ms and a lag of 60 ms; bridged torque is kept for
 * 40 ms and then falls by a 61st (138 ms/2.3 + 1 ms) in each. */
#include "blending_rig.h"

enum { LIMIT_mNm = 10000, KEPT_ms = 40, BRIDGING_ms = 178 };

void setUp(void)
{
    rig_up();
    config.brake.hydraulic_dead_time_ms = KEPT_ms;
    config.brake.hydraulic_time_constant_ms = 60;
    config.brake.bridging_time_ms = BRIDGING_ms;
    in.hydraulic.valid = false;
    capability.optimal = limit_init(LIMIT_mNm, REASON_LOSS_OPTIMUM);
    in.brake_torque_mNm = 45000;
    motor_follows(45000);
}

void tearDown(void) {}

/* One step with a limit above which so much is left; the motor's torque, and what is left then. */
static int32_t left_q6;

static int32_t bridged(int32_t bridging_ms, int32_t above_q6)
{
    state.within_q6_mNm = LIMIT_mNm * 64;
    state.bridged_q6_mNm = LIMIT_mNm * 64 + above_q6;
    state.bridging_ms = bridging_ms;
    const int32_t electric_mNm = step().electric_mNm;
    left_q6 = state.bridged_q6_mNm - state.within_q6_mNm;
    return electric_mNm;
}

/* ---- kept, then with the lag ---- */

void test_torque_above_the_limit_is_kept_for_the_dead_time(void)
{
    TEST_ASSERT_EQUAL_INT32(LIMIT_mNm + 100, bridged(1, 6400));
    TEST_ASSERT_EQUAL_INT32(2, state.bridging_ms);
    TEST_ASSERT_EQUAL_INT32(6400, left_q6);
    TEST_ASSERT_EQUAL_INT32(LIMIT_mNm + 100, bridged(KEPT_ms - 1, 6400));
    TEST_ASSERT_EQUAL_INT32(KEPT_ms, state.bridging_ms);
    TEST_ASSERT_EQUAL_INT32(6400, left_q6);
}

/* 6100/61 and one more; below 61 one, down to zero. */
void test_torque_above_the_limit_falls_by_its_61st_and_one_unit(void)
{
    TEST_ASSERT_EQUAL_INT32(LIMIT_mNm + 5999 / 64, bridged(KEPT_ms, 6100));
    TEST_ASSERT_EQUAL_INT32(5999, left_q6);
    TEST_ASSERT_EQUAL_INT32(KEPT_ms, state.bridging_ms);
    (void)bridged(KEPT_ms, 60);
    TEST_ASSERT_EQUAL_INT32(59, left_q6);
    (void)bridged(KEPT_ms, 1);
    TEST_ASSERT_EQUAL_INT32(0, left_q6);
}

void test_a_bridging_time_up_to_the_dead_time_ends_at_once(void)
{
    config.brake.bridging_time_ms = KEPT_ms;
    (void)bridged(KEPT_ms, 6100);
    TEST_ASSERT_EQUAL_INT32(0, left_q6);
    config.brake.bridging_time_ms = KEPT_ms / 2;
    (void)bridged(KEPT_ms / 2 - 1, 6100);
    TEST_ASSERT_EQUAL_INT32(6100, left_q6);
    TEST_ASSERT_EQUAL_INT32(LIMIT_mNm, bridged(KEPT_ms / 2, 6100));
    TEST_ASSERT_EQUAL_INT32(0, left_q6);
    config.brake.bridging_time_ms = 0;
    TEST_ASSERT_EQUAL_INT32(LIMIT_mNm, bridged(0, 6100));
    TEST_ASSERT_EQUAL_INT32(0, left_q6);
    TEST_ASSERT_EQUAL_INT32(0, state.bridging_ms);
}

/* A brake that is measured may be twice as slow: 80 ms, then a 121st (276 ms/2.3 + 1 ms). */
void test_beside_a_measured_brake_bridging_takes_twice_as_long(void)
{
    measured(0, 0);
    in.hydraulic.age_ms = 0;
    TEST_ASSERT_EQUAL_INT32(LIMIT_mNm + 190, bridged(2 * KEPT_ms - 1, 12161));
    TEST_ASSERT_EQUAL_INT32(12161, left_q6);
    TEST_ASSERT_EQUAL_INT32(2 * KEPT_ms, state.bridging_ms);
    (void)bridged(2 * KEPT_ms, 12161);
    TEST_ASSERT_EQUAL_INT32(12161 - 100 - 1, left_q6);
}

void test_the_motor_torque_is_never_raised_to_what_is_bridged(void)
{
    motor_follows(LIMIT_mNm + 5);
    TEST_ASSERT_EQUAL_INT32(LIMIT_mNm + 5, bridged(1, 6400));
    motor_follows(LIMIT_mNm - 5);
    TEST_ASSERT_EQUAL_INT32(LIMIT_mNm, bridged(1, 6400));
    motor_follows(0);
    TEST_ASSERT_EQUAL_INT32(LIMIT_mNm, bridged(KEPT_ms, 6400));
}

/* ---- a limit that falls by a step begins anew ---- */

/* In one step; a 16th of what is bridged is 64000. */
static void falls_by(int32_t fall_q6, int32_t motor_mNm)
{
    motor_follows(motor_mNm);
    state.within_q6_mNm = LIMIT_mNm * 64 + fall_q6;
    state.bridged_q6_mNm = 16 * 64000;
    state.bridging_ms = 30;
    (void)step();
}

void test_a_limit_that_falls_by_more_than_a_16th_is_bridged_anew(void)
{
    falls_by(64000, 15000);
    TEST_ASSERT_EQUAL_INT32(31, state.bridging_ms);
    TEST_ASSERT_EQUAL_INT32(16 * 64000, state.bridged_q6_mNm);
    falls_by(64001, 15000); /* from the torque that the motor makes */
    TEST_ASSERT_EQUAL_INT32(1, state.bridging_ms);
    TEST_ASSERT_EQUAL_INT32(15000 * 64, state.bridged_q6_mNm);
    TEST_ASSERT_EQUAL_INT32(LIMIT_mNm * 64, state.within_q6_mNm);
    falls_by(64001, 17000); /* no more than was permitted */
    TEST_ASSERT_EQUAL_INT32(16 * 64000, state.bridged_q6_mNm);
}

void test_a_limit_that_stays_or_rises_is_followed_at_once(void)
{
    TEST_ASSERT_EQUAL_INT32(LIMIT_mNm, bridged(17, 0));
    TEST_ASSERT_EQUAL_INT32(0, state.bridging_ms);
    TEST_ASSERT_EQUAL_INT32(LIMIT_mNm, bridged(17, -6400));
    TEST_ASSERT_EQUAL_INT32(0, state.bridging_ms);
    TEST_ASSERT_EQUAL_INT32(LIMIT_mNm * 64, state.bridged_q6_mNm);
}

/* 2^23 mN m in 64ths are 2^29: no limit and no motor torque is beyond. */
void test_limits_and_torques_of_the_largest_numbers_are_bridged_as_8_kNm(void)
{
    config.brake.strategy = CONFIG_STRATEGY_SERIES_OPTIMAL;
    capability.optimal = limit_init(INT32_MAX, REASON_LOSS_OPTIMUM);
    (void)step();
    TEST_ASSERT_EQUAL_INT32(1 << 29, state.within_q6_mNm);
    TEST_ASSERT_EQUAL_INT32(1 << 29, state.bridged_q6_mNm);
    capability.optimal = limit_init(LIMIT_mNm, REASON_LOSS_OPTIMUM);
    in.motor_command_mNm = -INT32_MAX;
    (void)step();
    TEST_ASSERT_EQUAL_INT32(1 << 29, state.bridged_q6_mNm);
}

/* ---- fading with the blend-out ---- */

/* What is left of 10 N m at a speed; the line BLEND_OUT lies above the limit. */
static int32_t faded_mNm(int32_t speed_mrad_s)
{
    in.speed_mrad_s = speed_mrad_s;
    motor_follows(45000);
    return bridged(1, 10000 * 64) - LIMIT_mNm;
}

void test_what_is_bridged_fades_in_the_blend_out_range(void)
{
    for (int sign = -1; sign <= 1; sign += 2) {
        TEST_ASSERT_EQUAL_INT32(10000, faded_mNm(sign * 2618));
        TEST_ASSERT_EQUAL_INT32(5000, faded_mNm(sign * 1728)); /* the middle */
    }
    /* 39998 of 40000 are 32766 of 32768; one more is the whole. */
    config.brake.blend_out_start_mrad_s = 40000;
    config.brake.blend_out_end_mrad_s = 0;
    TEST_ASSERT_EQUAL_INT32(9999, faded_mNm(39998));
    TEST_ASSERT_EQUAL_INT32(10000, faded_mNm(39999));
}

void test_what_is_bridged_ends_at_a_blend_out_of_zero_width(void)
{
    config.brake.blend_out_start_mrad_s = 1000;
    config.brake.blend_out_end_mrad_s = 1000;
    TEST_ASSERT_EQUAL_INT32(10000, faded_mNm(1001));
    in.speed_mrad_s = 1000;
    motor_follows(45000);
    state.within_q6_mNm = 0;
    state.bridged_q6_mNm = 640000;
    state.bridging_ms = 1;
    TEST_ASSERT_EQUAL_INT32(0, step().electric_mNm);
}

/* ---- expected speed and limit ---- */

/* 20 rad/s before; 8 rad/s less move the low-pass by 125 mrad/s, and the lag of 7.875 rad/s of 64
 * ms is 19.7 rad/s of 160 ms. */
static int32_t slower_mrad_s(int32_t speed_mrad_s)
{
    filter_reset(&state.speed_lp_mrad_s, 20000, 6);
    in.speed_mrad_s = speed_mrad_s;
    return step().slower_mrad_s;
}

void test_the_expected_speed_is_that_of_the_slope_of_64_ms(void)
{
    for (int sign = -1; sign <= 1; sign += 2) {
        TEST_ASSERT_EQUAL_INT32(19000 - 984 * 160 / 64, slower_mrad_s(sign * 19000));
        TEST_ASSERT_EQUAL_INT32(0, slower_mrad_s(sign * 12000));
        TEST_ASSERT_EQUAL_INT32(20000, slower_mrad_s(sign * 20000));
        TEST_ASSERT_EQUAL_INT32(20100, slower_mrad_s(sign * 20100));
    }
}

void test_beside_a_measured_brake_the_expected_speed_is_that_a_lag_later(void)
{
    measured(0, 0);
    in.hydraulic.age_ms = 0;
    TEST_ASSERT_EQUAL_INT32(19000 - 984 * 220 / 64, slower_mrad_s(19000));
}

/* Speeds beyond 2^23 count as that: from there 8000001 mrad/s move the low-pass by 6072, and 382535
 * of 64 ms are 956337 of 160 ms. */
void test_the_expected_speed_of_the_largest_numbers_does_not_overflow(void)
{
    in.speed_mrad_s = INT32_MAX;
    for (int n = 0; n < 3000; n++) {
        TEST_ASSERT_EQUAL_INT32(INT32_MAX, step().slower_mrad_s);
    }
    in.speed_mrad_s = 8000001;
    TEST_ASSERT_EQUAL_INT32(8000001 - 956337, step().slower_mrad_s);
}

/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The torque command in whole millinewton-metres: what counts as braking, what goes at once, and
 * what the smallest torque and the smallest speed do.
 */
#include "torque_command_rig.h"

void setUp(void)
{
    rig_up();
}

void tearDown(void) {}

static torque_command_out_t step(int32_t speed_mrad_s, int32_t drive_mNm, int32_t electric_mNm)
{
    in.speed_mrad_s = speed_mrad_s;
    in.drive_torque_mNm = drive_mNm;
    in.electric_mNm = electric_mNm;
    return command_step();
}

static int32_t command(int32_t speed_mrad_s, int32_t drive_mNm, int32_t electric_mNm)
{
    return step(speed_mrad_s, drive_mNm, electric_mNm).command_mNm;
}

/* From none, without what is withdrawn, has arrived or interrupts. */
static int32_t settle(int32_t speed_mrad_s, int32_t drive_mNm, int32_t electric_mNm)
{
    command_begins();
    in.drive_withdrawn = in.bridge_open = false;
    in.rise_mNm = in.uncovered_mNm = 0;
    for (int n = 0; n < SETTLED; n++) {
        (void)command(speed_mrad_s, drive_mNm, electric_mNm);
    }
    return last_command_mNm;
}

void test_the_first_state_has_not_braked(void)
{
    state.braked = true;
    torque_command_init(&state);
    TEST_ASSERT_FALSE(state.braked);
}

void test_a_torque_is_against_the_rotation_if_both_have_opposite_signs(void)
{
    for (int32_t speed_mrad_s = -1; speed_mrad_s <= 1; speed_mrad_s++) {
        for (int32_t torque_mNm = -1; torque_mNm <= 1; torque_mNm++) {
            TEST_ASSERT_EQUAL_INT(speed_mrad_s * torque_mNm == -1,
                                  torque_command_is_against(torque_mNm, speed_mrad_s));
        }
    }
}

/* ---- the smallest torques and speeds ---- */

void test_the_smallest_driving_demand_is_bounded_and_has_its_sign(void)
{
    TEST_ASSERT_EQUAL_INT32(1, command(FORWARD, 1, 0));
    TEST_ASSERT_EQUAL_INT32(-1, command(BACKWARD, -1, 0));
    limits.driving[TORQUE_LINE_MAX_TORQUE] = limit_init(0, REASON_MAX_TORQUE);
    for (int32_t drive_mNm = -1; drive_mNm <= 1; drive_mNm += 2) {
        command_begins();
        const torque_command_out_t out = step(FORWARD * drive_mNm, drive_mNm, 0);
        TEST_ASSERT_EQUAL_INT32(0, out.command_mNm);
        TEST_ASSERT_EQUAL_INT(REASON_MAX_TORQUE, out.reason);
    }
}

/* 600, on the way from 1000 to 1. */
void test_the_torque_is_falling_towards_the_smallest_one_of_its_sign(void)
{
    for (int32_t sign = -1; sign <= 1; sign += 2) {
        settle(sign * FORWARD, sign * 1000, 0);
        const torque_command_out_t out = step(sign * FORWARD, sign, 0);
        TEST_ASSERT_EQUAL_INT32(sign * 600, out.command_mNm);
        TEST_ASSERT_TRUE(out.falling);
    }
}

/* ---- which limits bound a driving demand ---- */

void test_the_lines_of_the_strategy_bound_no_driving_demand(void)
{
    static const limit_t LITTLE = {.torque_mNm = 1000, .reason = REASON_LOSS_OPTIMUM};
    for (torque_line_t line = TORQUE_LINE_LOSS_OPTIMUM; line < TORQUE_LINE_ABS; line++) {
        limits.driving[line] = limits.braking[line] = LITTLE;
    }
    TEST_ASSERT_EQUAL_INT32(30000, settle(FORWARD, 30000, 0));
    TEST_ASSERT_EQUAL_INT32(-25000, settle(FORWARD, -30000, 0));
}

void test_anti_lock_bounds_a_driving_demand_against_the_rotation(void)
{
    limits.braking[TORQUE_LINE_ABS] = limit_init(5000, REASON_ABS);
    TEST_ASSERT_EQUAL_INT32(-5000, settle(FORWARD, -30000, 0));
    TEST_ASSERT_EQUAL_INT(REASON_ABS, step(FORWARD, -30000, 0).reason);
    TEST_ASSERT_EQUAL_INT32(30000, settle(FORWARD, 30000, 0));
}

/* ---- what goes at once, and what does not ---- */

/* From 1 mN m of braking on; a driving demand then takes it over. */
void test_the_smallest_braking_torque_still_counts_as_braking_at_zero_speed(void)
{
    for (int32_t sign = -1; sign <= 1; sign += 2) {
        TEST_ASSERT_EQUAL_INT32(-sign, settle(sign * FORWARD, 0, 1));
        TEST_ASSERT_EQUAL_INT32(-sign * 401, command(0, -sign * 20000, 0));
        in.drive_withdrawn = true;
        TEST_ASSERT_EQUAL_INT32(-sign, command(0, 0, 0));
    }
}

void test_a_torque_that_begins_at_zero_speed_after_braking_is_driving_torque(void)
{
    for (int32_t sign = -1; sign <= 1; sign += 2) {
        settle(sign * FORWARD, 0, 20000);
        in.bridge_open = true; /* the braking torque is gone */
        TEST_ASSERT_EQUAL_INT32(-sign * 400, command(0, -sign * 20000, 0));
        in.bridge_open = false;
        TEST_ASSERT_EQUAL_INT32(-sign * 800, command(0, -sign * 20000, 0));
        in.drive_withdrawn = true;
        TEST_ASSERT_EQUAL_INT32(0, command(0, 0, 0));
    }
}

void test_braking_torque_that_drives_after_the_wheel_has_turned_round_is_driving_torque(void)
{
    for (int32_t sign = -1; sign <= 1; sign += 2) {
        settle(-sign * FORWARD, sign * 20000, 0);
        TEST_ASSERT_EQUAL_INT32(sign * 20000, command(sign * FORWARD, sign * 20000, 0));
        in.drive_withdrawn = true;
        TEST_ASSERT_EQUAL_INT32(0, command(0, 0, 0));
    }
}

/* It stays where the driver wants it, and goes where he wants the opposite. */
void test_a_driving_demand_of_the_opposite_sign_does_not_keep_the_braking_torque(void)
{
    for (int32_t sign = -1; sign <= 1; sign += 2) {
        settle(sign * FORWARD, 0, 20000);
        TEST_ASSERT_EQUAL_INT32(sign * 400, command(-sign, sign * 20000, 0));
        settle(sign * FORWARD, 0, 20000);
        TEST_ASSERT_EQUAL_INT32(-sign * 19600, command(-sign, -sign, 0));
    }
}

/* ---- what the hydraulic brake has taken over ---- */

void test_one_millinewton_metre_of_the_hydraulic_brake_is_taken_over(void)
{
    settle(FORWARD, 0, 20000);
    in.rise_mNm = 1;
    TEST_ASSERT_EQUAL_INT32(-19999, command(FORWARD, 0, 20000));
}

void test_the_hydraulic_brake_takes_over_neither_driving_torque_nor_what_the_driver_demands(void)
{
    settle(FORWARD, 20000, 0);
    in.rise_mNm = 5000;
    TEST_ASSERT_EQUAL_INT32(19600, command(FORWARD, 0, 0));
    settle(FORWARD, -20000, 0); /* by the pedal, of a wheel that rolls back */
    in.rise_mNm = 5000;
    TEST_ASSERT_EQUAL_INT32(-20000, command(FORWARD, -20000, 0));
    settle(FORWARD, -1, 0);
    in.rise_mNm = 5000;
    TEST_ASSERT_EQUAL_INT32(-1, command(FORWARD, -1, 0));
    settle(BACKWARD, 1, 0);
    in.rise_mNm = 5000;
    TEST_ASSERT_EQUAL_INT32(1, command(BACKWARD, 1, 0));
}

/* ---- growth near the voltage limit ---- */

/* The least slope, 1: the share is what is left of the end, 26214/32768, however little of the
 * voltage is used, and as much less beyond twice the end. Of 2 kN m a step. */
void test_growth_is_that_of_no_voltage_below_zero_and_of_twice_the_end_above_it(void)
{
    config.brake.torque_rate_mNm_s = 2000000000;
    config.brake.torque_growth_end_q15 = 26214;
    config.brake.torque_growth_slope_q9 = 512;
    const int32_t most_mNm = (int32_t)(2000000LL * 26214 / 32768);
    TEST_ASSERT_INT32_WITHIN(1, most_mNm, torque_command_growth_mNm(&config, 0));
    TEST_ASSERT_INT32_WITHIN(1, most_mNm, torque_command_growth_mNm(&config, -1));
    TEST_ASSERT_INT32_WITHIN(1, most_mNm, torque_command_growth_mNm(&config, INT32_MIN));
    TEST_ASSERT_INT32_WITHIN(1, -most_mNm, torque_command_growth_mNm(&config, 2 * 26214));
    TEST_ASSERT_INT32_WITHIN(1, -most_mNm, torque_command_growth_mNm(&config, 2 * 26214 + 1));
    TEST_ASSERT_INT32_WITHIN(1, -most_mNm, torque_command_growth_mNm(&config, INT32_MAX));
}

/* Slope 50, 2/32768 below the end: 400 mN m * 50 * 2/32768 = 1.2 mN m. */
void test_a_torque_that_may_still_grow_is_limited_by_the_rate(void)
{
    in.voltage_use_q15 = config.brake.torque_growth_end_q15 - 2;
    TEST_ASSERT_EQUAL_INT32(1, torque_command_growth_mNm(&config, in.voltage_use_q15));
    const torque_command_out_t grows = step(FORWARD, 10000, 0);
    TEST_ASSERT_EQUAL_INT32(1, grows.command_mNm);
    TEST_ASSERT_EQUAL_INT(REASON_TORQUE_RATE, grows.reason);
    in.voltage_use_q15 = config.brake.torque_growth_end_q15;
    const torque_command_out_t stays = step(FORWARD, 10000, 0);
    TEST_ASSERT_EQUAL_INT32(1, stays.command_mNm);
    TEST_ASSERT_EQUAL_INT(REASON_VOLTAGE, stays.reason);
}

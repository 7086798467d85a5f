/* SPDX-License-Identifier: Apache-2.0 */
/* Two pedals with two channels each: accelerator 40 N m, brake pedal 200 N m with 40 N m at the end
 * of 30 % of free travel, dead band 5 %, difference 10 %, 100 ms. Expected torques follow from
 * travels in per cent, ratios from the calibration. */
#include <math.h>
#include <stddef.h>
#include <string.h>

#include "config/validate.h"
#include "paper_vehicle.h"
#include "pedals/pedals.h"
#include "random_values.h"
#include "unity.h"

enum { FULL_DRIVE = 40000, FULL_BRAKE = 200000, KNEE = 40000, FAULT_TIME = 100, LONG_AGO = 5000 };
enum { INVALID_q15 = -1 };
static const double DEAD_BAND = 0.05;

static config_t config;
static pedals_state_t state;
static pedals_input_t in;

void setUp(void)
{
    const pedals_input_t none = {.received_age_ms = UINT32_MAX};
    config = paper_vehicle();
    config_pedals_t *pedals = &config.pedals;
    pedals->accelerator_channels = 2;
    pedals->brake_channels = 2;
    pedals->drive_torque_mNm = FULL_DRIVE;
    pedals->brake_torque_mNm = FULL_BRAKE;
    pedals->free_travel_torque_mNm = KNEE;
    in = none;
    pedals_init(&state);
}

void tearDown(void) {}

static int32_t ratio_q15(int channel, double travel)
{
    const double released = config.pedals.released_q15[channel];
    return (int32_t)lround(released + travel * (config.pedals.pressed_q15[channel] - released));
}

/* The whole travel that counts as `counted` behind the dead band. */
static double whole(double counted)
{
    return DEAD_BAND + counted * (1.0 - DEAD_BAND);
}

static void press(double accelerator, double brake)
{
    for (int k = 0; k < 2; k++) {
        in.ratio_q15[k] = ratio_q15(k, accelerator);
        in.ratio_q15[2 + k] = ratio_q15(2 + k, brake);
    }
}

static pedals_output_t run(int milliseconds)
{
    pedals_output_t out = pedals_step(&state, &config, &in);
    for (int n = 1; n < milliseconds; n++) {
        out = pedals_step(&state, &config, &in);
    }
    return out;
}

static pedals_output_t pressed(double accelerator, double brake)
{
    press(accelerator, brake);
    return run(1);
}

/* A thousandth: ratios have 32 768 steps, channel b's travel a third of them. */
static void assert_torque(double expected_mNm, int32_t actual_mNm)
{
    TEST_ASSERT_INT32_WITHIN(FULL_BRAKE / 1000, lround(expected_mNm), actual_mNm);
}

void test_released_pedals_demand_zero_torque_and_are_valid(void)
{
    const pedals_output_t out = pressed(0.0, 0.0);
    TEST_ASSERT_EQUAL_INT32(0, out.demand.drive_torque_mNm);
    TEST_ASSERT_EQUAL_INT32(0, out.demand.brake_torque_mNm);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, out.demand.reason);
    TEST_ASSERT_EQUAL_UINT32(0, out.age_ms);
}

void test_drive_torque_is_proportional_to_the_travel_beyond_the_dead_band(void)
{
    pressed(0.0, 0.0);
    TEST_ASSERT_EQUAL_INT32(0, pressed(DEAD_BAND - 0.001, 0.0).demand.drive_torque_mNm);
    for (double part = 0.1; part <= 1.0; part += 0.1) {
        assert_torque(part * FULL_DRIVE, pressed(whole(part), 0.0).demand.drive_torque_mNm);
    }
    TEST_ASSERT_EQUAL_INT32(FULL_DRIVE, pressed(1.05, 0.0).demand.drive_torque_mNm);
    in.received.direction = DRIVE_DIRECTION_REVERSE;
    in.received.enable = true;
    in.received_age_ms = 0;
    assert_torque(-0.5 * FULL_DRIVE, pressed(whole(0.5), 0.0).demand.drive_torque_mNm);
}

/* From -10 N m at the released pedal to zero at 15 % of the travel, to 40 N m at its end. */
void test_the_first_part_of_the_accelerator_is_lift_off_braking(void)
{
    config.pedals.lift_off_torque_mNm = 10000;
    config.pedals.lift_off_travel_q15 = 4915;
    TEST_ASSERT_EQUAL_INT32(-10000, pressed(0.0, 0.0).demand.drive_torque_mNm);
    assert_torque(-5000, pressed(whole(0.075), 0.0).demand.drive_torque_mNm);
    assert_torque(0, pressed(whole(0.15), 0.0).demand.drive_torque_mNm);
    assert_torque(20000, pressed(whole(0.575), 0.0).demand.drive_torque_mNm);
    TEST_ASSERT_EQUAL_INT32(FULL_DRIVE, pressed(1.0, 0.0).demand.drive_torque_mNm);
    /* The brake pedal does not reduce it (UN R13-H). */
    TEST_ASSERT_EQUAL_INT32(-10000, pressed(0.0, 0.5).demand.drive_torque_mNm);
}

/* One channel on either side of the travel without torque. */
void test_channels_around_the_end_of_lift_off_braking_demand_neither_torque(void)
{
    config.pedals.lift_off_torque_mNm = 10000;
    config.pedals.lift_off_travel_q15 = 4915;
    pressed(0.0, 0.0);
    press(whole(0.145), 0.0);
    in.ratio_q15[1] = ratio_q15(1, whole(0.155));
    TEST_ASSERT_EQUAL_INT32(0, run(1).demand.drive_torque_mNm);
}

void test_an_accelerator_whose_fault_has_not_healed_does_not_brake(void)
{
    config.pedals.lift_off_torque_mNm = 10000;
    config.pedals.lift_off_travel_q15 = 16384;
    press(0.1, 0.0);
    in.ratio_q15[1] = INVALID_q15;
    run(FAULT_TIME);
    press(0.1, 0.0);
    for (int n = 1; n < FAULT_TIME; n++) {
        TEST_ASSERT_EQUAL_INT32(0, run(1).demand.drive_torque_mNm);
    }
    TEST_ASSERT_LESS_THAN_INT32(0, run(1).demand.drive_torque_mNm);
}

void test_the_accelerator_must_be_released_once_before_it_drives(void)
{
    const pedals_output_t locked = pressed(0.8, 0.0);
    TEST_ASSERT_EQUAL_INT32(0, locked.demand.drive_torque_mNm);
    TEST_ASSERT_EQUAL_INT(REASON_ACCELERATOR_LOCKED, locked.demand.reason);
    TEST_ASSERT_EQUAL_INT32(0, pressed(0.1, 0.0).demand.drive_torque_mNm);
    pressed(0.0, 0.0);
    const pedals_output_t again = pressed(whole(0.5), 0.0);
    assert_torque(0.5 * FULL_DRIVE, again.demand.drive_torque_mNm);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, again.demand.reason);
}

void test_channels_that_are_not_valid_release_no_accelerator(void)
{
    for (int channel = 0; channel < 2; channel++) {
        pedals_init(&state);
        pressed(0.5, 0.0);
        press(0.0, 0.0);
        in.ratio_q15[channel] = INVALID_q15;
        TEST_ASSERT_EQUAL_INT32(0, run(1).demand.drive_torque_mNm);
        const pedals_output_t out = pressed(0.5, 0.0);
        TEST_ASSERT_EQUAL_INT32(0, out.demand.drive_torque_mNm);
        TEST_ASSERT_EQUAL_INT(REASON_ACCELERATOR_LOCKED, out.demand.reason);
    }
}

/* Shorted to ground, open with a pull-down, shorted to the supply. */
static const int32_t BROKEN_q15[] = {0, 300, 32768};

void test_a_shorted_or_open_accelerator_channel_takes_the_torque_at_once(void)
{
    config.pedals.lift_off_torque_mNm = 10000;
    for (int channel = 0; channel < 2; channel++) {
        for (int k = 0; k < 3; k++) {
            pedals_init(&state);
            pressed(0.0, 0.0);
            press(0.8, 0.0);
            TEST_ASSERT_GREATER_THAN_INT32(20000, run(1).demand.drive_torque_mNm);
            in.ratio_q15[channel] = BROKEN_q15[k];
            TEST_ASSERT_EQUAL_INT32(0, run(1).demand.drive_torque_mNm);
            TEST_ASSERT_EQUAL_INT(REASON_NONE, run(FAULT_TIME - 2).demand.reason);
            const pedals_output_t out = run(1);
            TEST_ASSERT_EQUAL_INT(REASON_ACCELERATOR_SENSOR, out.demand.reason);
            TEST_ASSERT_EQUAL_INT32(0, out.demand.drive_torque_mNm);
            TEST_ASSERT_EQUAL_UINT32(0, out.age_ms); /* the brake pedal still counts */
        }
    }
}

void test_a_fault_heals_in_its_time_and_the_accelerator_must_then_be_released(void)
{
    pressed(0.0, 0.0);
    press(0.8, 0.0);
    in.ratio_q15[0] = 0;
    run(FAULT_TIME);
    press(0.8, 0.0);
    TEST_ASSERT_EQUAL_INT(REASON_ACCELERATOR_SENSOR, run(FAULT_TIME - 1).demand.reason);
    TEST_ASSERT_EQUAL_INT(REASON_ACCELERATOR_LOCKED, run(1).demand.reason);
    TEST_ASSERT_EQUAL_INT32(0, run(1000).demand.drive_torque_mNm);
    pressed(0.0, 0.0);
    TEST_ASSERT_GREATER_THAN_INT32(20000, pressed(0.8, 0.0).demand.drive_torque_mNm);
}

void test_a_disturbance_shorter_than_the_fault_time_leaves_no_fault(void)
{
    pressed(0.0, 0.0);
    press(0.8, 0.0);
    const int32_t torque_mNm = run(1).demand.drive_torque_mNm;
    in.ratio_q15[1] = 0;
    run(FAULT_TIME - 1);
    press(0.8, 0.0);
    TEST_ASSERT_EQUAL_INT32(torque_mNm, run(1).demand.drive_torque_mNm);
}

/* Half of the time open, at 10 to 500 Hz: named within a second, and as long as it lasts. A tenth
 * of the time, in pieces shorter than the fault time, is not. */
void test_a_loose_contact_is_a_fault_at_any_rate(void)
{
    static const int HALF_PERIODS_ms[] = {1, 5, 20, 50};
    for (int channel = 0; channel <= 2; channel += 2) {
        for (int k = 0; k < 4; k++) {
            setUp();
            pressed(0.0, 0.0);
            const reason_t expected =
                channel == 0 ? REASON_ACCELERATOR_SENSOR : REASON_BRAKE_PEDAL_SENSOR;
            for (int ms = 0; ms < 3000; ms++) {
                press(0.3, channel == 2 ? 0.3 : 0.0);
                if (ms / HALF_PERIODS_ms[k] % 2 == 0) {
                    in.ratio_q15[channel] = 0;
                }
                const reason_t reason = run(1).demand.reason;
                if (ms >= 1000) {
                    TEST_ASSERT_EQUAL_INT(expected, reason);
                }
            }
        }
    }
}

void test_what_is_open_for_a_tenth_of_the_time_is_no_fault(void)
{
    pressed(0.0, 0.0);
    for (int ms = 0; ms < 3000; ms++) {
        press(0.3, 0.0);
        if (ms % 20 < 2) {
            in.ratio_q15[0] = 0;
        }
        TEST_ASSERT_EQUAL_INT(REASON_NONE, run(1).demand.reason);
    }
}

/* 9 % and 11 % of the travel apart: behind the dead band 9.5 % and 11.6 %. */
void test_channels_that_differ_too_much_drive_with_the_smaller_travel_then_not_at_all(void)
{
    pressed(0.0, 0.0);
    press(0.6, 0.0);
    in.ratio_q15[1] = ratio_q15(1, 0.51);
    assert_torque((0.46 / 0.95) * FULL_DRIVE, run(1000).demand.drive_torque_mNm);
    in.ratio_q15[1] = ratio_q15(1, 0.49);
    assert_torque((0.44 / 0.95) * FULL_DRIVE, run(FAULT_TIME - 1).demand.drive_torque_mNm);
    const pedals_output_t out = run(1);
    TEST_ASSERT_EQUAL_INT32(0, out.demand.drive_torque_mNm);
    TEST_ASSERT_EQUAL_INT(REASON_ACCELERATOR_SENSOR, out.demand.reason);
}

/* Two equal channels without a dead band: a travel is its ratio. */
void test_channels_may_differ_by_exactly_the_configured_difference(void)
{
    for (int k = 0; k < 2; k++) {
        config.pedals.lowest_q15[k] = config.pedals.released_q15[k] = 0;
        config.pedals.highest_q15[k] = config.pedals.pressed_q15[k] = 32768;
    }
    config.pedals.dead_band_q15 = 0;
    config.pedals.difference_q15 = 328;
    for (int32_t apart_q15 = 328; apart_q15 <= 329; apart_q15++) {
        pedals_init(&state);
        pressed(0.0, 0.0);
        in.ratio_q15[0] = 4096;
        in.ratio_q15[1] = 4096 + apart_q15;
        const pedals_output_t out = run(FAULT_TIME);
        TEST_ASSERT_EQUAL_INT32(apart_q15 == 328 ? FULL_DRIVE / 8 : 0, out.demand.drive_torque_mNm);
        TEST_ASSERT_EQUAL_INT(apart_q15 == 328 ? REASON_NONE : REASON_ACCELERATOR_SENSOR,
                              out.demand.reason);
    }
}

/* The travels at the same ratio x are (x - 0.15)/0.7 and (2 x - 0.15)/0.7: x/0.7 apart, more than
 * 10 % wherever one of them is not zero. */
void test_two_channels_shorted_together_do_not_drive(void)
{
    for (int32_t both_q15 = 0; both_q15 <= 32768; both_q15 += 64) {
        pedals_init(&state);
        pressed(0.0, 0.0);
        in.ratio_q15[0] = both_q15;
        in.ratio_q15[1] = both_q15;
        TEST_ASSERT_EQUAL_INT32(0, run(FAULT_TIME).demand.drive_torque_mNm);
    }
}

void test_proportional_interpretation_is_one_straight_line(void)
{
    config.pedals.interpretation = CONFIG_PEDAL_PROPORTIONAL;
    for (double part = 0.0; part <= 1.0; part += 0.125) {
        assert_torque(part * FULL_BRAKE, pressed(0.0, whole(part)).demand.brake_torque_mNm);
    }
    TEST_ASSERT_EQUAL_INT32(FULL_BRAKE, pressed(0.0, 1.05).demand.brake_torque_mNm);
}

/* 40 N m over the first 30 %, 160 N m over the other 70 %. */
void test_free_travel_interpretation_is_two_straight_lines(void)
{
    config.pedals.interpretation = CONFIG_PEDAL_FREE_TRAVEL;
    config.pedals.free_travel_q15 = 9830;
    const double expected_mNm[][2] = {{0.0, 0.0},     {0.15, 20000},   {0.3, 40000},
                                      {0.65, 120000}, {0.825, 160000}, {1.0, 200000}};
    for (size_t k = 0; k < sizeof expected_mNm / sizeof expected_mNm[0]; k++) {
        assert_torque(expected_mNm[k][1],
                      pressed(0.0, whole(expected_mNm[k][0])).demand.brake_torque_mNm);
    }
    int32_t before_mNm = 0;
    for (int32_t travel_q15 = 0; travel_q15 <= 32768; travel_q15++) {
        const int32_t torque_mNm = pedals_brake_torque_mNm(&config.pedals, travel_q15);
        /* 160 N m / 0.7 of 32 768 steps: 6.98 mN m a step, the knee included */
        TEST_ASSERT_TRUE(torque_mNm >= before_mNm && torque_mNm <= before_mNm + 7);
        before_mNm = torque_mNm;
    }
    TEST_ASSERT_EQUAL_INT32(FULL_BRAKE, before_mNm);
}

void test_the_brake_pedal_counts_with_the_larger_channel_and_warns(void)
{
    press(0.0, whole(0.5));
    in.ratio_q15[3] = ratio_q15(3, whole(0.8));
    assert_torque(0.8 * FULL_BRAKE, run(FAULT_TIME - 1).demand.brake_torque_mNm);
    const pedals_output_t out = run(1);
    assert_torque(0.8 * FULL_BRAKE, out.demand.brake_torque_mNm);
    TEST_ASSERT_EQUAL_INT(REASON_BRAKE_PEDAL_SENSOR, out.demand.reason);
    TEST_ASSERT_EQUAL_UINT32(0, out.age_ms);
}

void test_one_broken_brake_channel_leaves_the_other(void)
{
    for (int channel = 2; channel < 4; channel++) {
        for (int k = 0; k < 3; k++) {
            pedals_init(&state);
            press(0.0, whole(0.5));
            in.ratio_q15[channel] = BROKEN_q15[k];
            const pedals_output_t out = run(FAULT_TIME);
            assert_torque(0.5 * FULL_BRAKE, out.demand.brake_torque_mNm);
            TEST_ASSERT_EQUAL_INT(REASON_BRAKE_PEDAL_SENSOR, out.demand.reason);
            TEST_ASSERT_EQUAL_UINT32(0, out.age_ms);
        }
    }
}

void test_a_brake_pedal_without_a_channel_is_kept_for_the_fault_time_and_then_lost(void)
{
    pressed(0.0, whole(0.5));
    in.ratio_q15[2] = 0;
    in.ratio_q15[3] = 32768;
    const pedals_output_t kept = run(FAULT_TIME - 1);
    assert_torque(0.5 * FULL_BRAKE, kept.demand.brake_torque_mNm);
    TEST_ASSERT_EQUAL_UINT32(0, kept.age_ms);
    TEST_ASSERT_EQUAL_UINT32(UINT32_MAX, run(1).age_ms);
    TEST_ASSERT_EQUAL_UINT32(0, pressed(0.0, 0.0).age_ms);
}

void test_a_brake_pedal_that_never_had_a_channel_is_lost_from_the_start(void)
{
    press(0.0, 0.0);
    in.ratio_q15[2] = 0;
    in.ratio_q15[3] = 0;
    TEST_ASSERT_EQUAL_UINT32(UINT32_MAX, run(1).age_ms);
}

void test_an_old_sample_counts_as_out_of_range(void)
{
    pressed(0.0, 0.0);
    press(0.8, 0.0);
    in.age_ms = (uint32_t)config.brake.demand_timeout_ms + 1U;
    TEST_ASSERT_EQUAL_INT32(0, run(1).demand.drive_torque_mNm);
    TEST_ASSERT_EQUAL_UINT32(UINT32_MAX, run(FAULT_TIME - 1).age_ms);
}

/* Formula SAE EV.4.7: beyond 25 % with the brake pressed, until the accelerator is released. */
void test_both_pedals_pressed_take_the_drive_until_the_accelerator_is_released(void)
{
    pressed(0.0, 0.0);
    pressed(whole(0.2), 0.3);
    assert_torque(0.2 * FULL_DRIVE, pressed(whole(0.2), 0.0).demand.drive_torque_mNm);
    TEST_ASSERT_EQUAL_INT32(0, pressed(whole(0.3), 0.3).demand.drive_torque_mNm);
    const pedals_output_t locked = pressed(whole(0.3), 0.0);
    TEST_ASSERT_EQUAL_INT32(0, locked.demand.drive_torque_mNm);
    TEST_ASSERT_EQUAL_INT(REASON_ACCELERATOR_LOCKED, locked.demand.reason);
    pressed(0.0, 0.0);
    assert_torque(0.3 * FULL_DRIVE, pressed(whole(0.3), 0.0).demand.drive_torque_mNm);
    config.pedals.override_q15 = 32768;
    pressed(1.0, 1.0);
    assert_torque(FULL_DRIVE, pressed(1.0, 0.0).demand.drive_torque_mNm);
}

/* By CAN, from a brake pedal elsewhere. */
void test_any_braking_beside_a_pressed_accelerator_takes_the_drive(void)
{
    config.pedals.brake_channels = 0;
    in.received.direction = DRIVE_DIRECTION_FORWARD;
    in.received_age_ms = 0;
    pressed(0.0, 0.0);
    assert_torque(0.5 * FULL_DRIVE, pressed(whole(0.5), 0.0).demand.drive_torque_mNm);
    in.received.brake_torque_mNm = 1;
    TEST_ASSERT_EQUAL_INT32(0, run(1).demand.drive_torque_mNm);
    in.received.brake_torque_mNm = 0;
    TEST_ASSERT_EQUAL_INT32(0, run(1).demand.drive_torque_mNm);
}

void test_switches_come_by_can_and_their_loss_leaves_the_brake_pedal_in_neutral(void)
{
    const wheel_demand_t received = {
        .drive_torque_mNm = 5000,
        .brake_torque_mNm = 7000,
        .direction = DRIVE_DIRECTION_FORWARD,
        .enable = false,
        .abs_active = true,
        .fault_reset = true,
    };
    pressed(0.0, 0.0);
    press(whole(0.5), whole(0.1));
    in.received = received;
    in.received_age_ms = 0;
    const pedals_output_t out = run(1);
    TEST_ASSERT_FALSE(out.demand.enable);
    TEST_ASSERT_TRUE(out.demand.abs_active);
    TEST_ASSERT_TRUE(out.demand.fault_reset);
    assert_torque(0.1 * FULL_BRAKE, out.demand.brake_torque_mNm);
    in.received_age_ms = LONG_AGO;
    const pedals_output_t lost = run(1);
    TEST_ASSERT_EQUAL_INT(DRIVE_DIRECTION_NEUTRAL, lost.demand.direction);
    TEST_ASSERT_EQUAL_INT32(0, lost.demand.drive_torque_mNm);
    TEST_ASSERT_EQUAL_INT(REASON_DEMAND_TIMEOUT, lost.demand.reason);
    TEST_ASSERT_TRUE(lost.demand.enable);
    assert_torque(0.1 * FULL_BRAKE, lost.demand.brake_torque_mNm);
    TEST_ASSERT_EQUAL_UINT32(0, lost.age_ms);
}

void test_a_pedal_that_is_not_wired_is_received(void)
{
    in.received.drive_torque_mNm = 5000;
    in.received.brake_torque_mNm = 7000;
    in.received_age_ms = 3;
    config.pedals.accelerator_channels = 0;
    TEST_ASSERT_EQUAL_INT32(5000, pressed(0.0, 0.0).demand.drive_torque_mNm);
    config.pedals.accelerator_channels = 1;
    config.pedals.brake_channels = 0;
    const pedals_output_t out = pressed(0.0, 0.0);
    TEST_ASSERT_EQUAL_INT32(7000, out.demand.brake_torque_mNm);
    TEST_ASSERT_EQUAL_UINT32(3, out.age_ms); /* the brake pedal elsewhere */
    in.received_age_ms = LONG_AGO;
    TEST_ASSERT_EQUAL_UINT32(LONG_AGO, run(1).age_ms);
    pedals_init(&state); /* a throttle alone, without CAN */
    TEST_ASSERT_EQUAL_UINT32(0, run(1).age_ms);
}

void test_each_wheel_has_its_share(void)
{
    const wheel_demand_t demand = {.drive_torque_mNm = -10000, .brake_torque_mNm = 30000};
    config.pedals.drive_share_q15[2] = 16384;
    config.pedals.brake_share_q15[2] = 8192;
    const wheel_demand_t rear = pedals_wheel_demand(&config, &demand, 2);
    TEST_ASSERT_EQUAL_INT32(-5000, rear.drive_torque_mNm);
    TEST_ASSERT_EQUAL_INT32(7500, rear.brake_torque_mNm);
    TEST_ASSERT_EQUAL_INT32(-10000, pedals_wheel_demand(&config, &demand, 1).drive_torque_mNm);
    /* What comes from elsewhere is shared out there. */
    config.pedals.accelerator_channels = 0;
    TEST_ASSERT_EQUAL_INT32(-10000, pedals_wheel_demand(&config, &demand, 2).drive_torque_mNm);
    TEST_ASSERT_EQUAL_INT32(7500, pedals_wheel_demand(&config, &demand, 2).brake_torque_mNm);
    config.pedals.brake_channels = 0;
    TEST_ASSERT_EQUAL_INT32(30000, pedals_wheel_demand(&config, &demand, 2).brake_torque_mNm);
}

void test_a_pedal_with_one_channel_is_a_pedal(void)
{
    config.pedals.accelerator_channels = 1;
    config.pedals.brake_channels = 1;
    press(0.0, whole(0.5));
    in.ratio_q15[1] = in.ratio_q15[3] = INVALID_q15;
    const pedals_output_t braking = run(FAULT_TIME);
    assert_torque(0.5 * FULL_BRAKE, braking.demand.brake_torque_mNm);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, braking.demand.reason);
    press(whole(0.5), 0.0);
    in.ratio_q15[1] = in.ratio_q15[3] = INVALID_q15;
    assert_torque(0.5 * FULL_DRIVE, run(1).demand.drive_torque_mNm);
    const wheel_demand_t demand = {.drive_torque_mNm = 10000, .brake_torque_mNm = 30000};
    config.pedals.drive_share_q15[0] = 16384;
    config.pedals.brake_share_q15[0] = 16384;
    const wheel_demand_t wheel = pedals_wheel_demand(&config, &demand, 0);
    TEST_ASSERT_EQUAL_INT32(5000, wheel.drive_torque_mNm);
    TEST_ASSERT_EQUAL_INT32(15000, wheel.brake_torque_mNm);
}

#define PEDALS(name, lowest, highest, unit, text)                                                  \
    if (random_chance(random, 0.5)) {                                                              \
        pedals->name = random_between(random, lowest, highest);                                    \
    }
#define PEDALS_ARRAY(name, count, lowest, highest, unit, text)                                     \
    for (int k = 0; k < (count) && random_chance(random, 0.3); k++) {                              \
        pedals->name[k] = random_between(random, lowest, highest);                                 \
    }

static bool random_pedals(random_t *random, config_pedals_t *pedals)
{
    CONFIG_PEDALS_FIELDS(PEDALS)
    CONFIG_PEDALS_ARRAY(PEDALS_ARRAY)
    config.crc32 = config_crc32(&config, (uint32_t)offsetof(config_t, crc32));
    return config_validate(&config, sizeof config).code == CONFIG_RESULT_OK;
}

static bool channel_in_range(int channel)
{
    return in.ratio_q15[channel] >= config.pedals.lowest_q15[channel] &&
           in.ratio_q15[channel] <= config.pedals.highest_q15[channel];
}

void test_torques_stay_in_range_and_no_invalid_channel_drives_for_any_configuration_and_input(void)
{
    random_t random = random_seeded(8);
    const config_t usual = config;
    int accepted = 0;
    int driven = 0;
    for (int n = 0; n < 3000; n++) {
        config = usual;
        if (!random_pedals(&random, &config.pedals)) {
            continue;
        }
        accepted++;
        pedals_init(&state);
        for (int step = 0; step < 60; step++) {
            if (step % 20 == 0) {
                press(step == 0 ? 0.0 : random_real(&random, 0.0, 1.0),
                      random_real(&random, 0.0, 1.0));
            }
            if (random_chance(&random, 0.02)) {
                in.ratio_q15[random_between(&random, 0, 3)] = random_wild(&random);
            }
            in.received_age_ms = random_chance(&random, 0.9) ? 0U : UINT32_MAX;
            in.received.direction = (drive_direction_t)random_between(&random, 0, 2);
            const pedals_output_t out = run(1);
            const config_pedals_t *pedals = &config.pedals;
            if (pedals->brake_channels > 0) {
                TEST_ASSERT_GREATER_OR_EQUAL_INT32(0, out.demand.brake_torque_mNm);
                TEST_ASSERT_LESS_OR_EQUAL_INT32(pedals->brake_torque_mNm,
                                                out.demand.brake_torque_mNm);
            }
            const int32_t along_mNm =
                out.demand.drive_torque_mNm * drive_direction_sign(out.demand.direction);
            bool valid = true;
            for (int k = 0; k < pedals->accelerator_channels; k++) {
                valid = valid && channel_in_range(k);
            }
            if (pedals->accelerator_channels > 0) {
                TEST_ASSERT_LESS_OR_EQUAL_INT32(valid ? pedals->drive_torque_mNm : 0, along_mNm);
                TEST_ASSERT_GREATER_OR_EQUAL_INT32(-pedals->lift_off_torque_mNm, along_mNm);
                driven += along_mNm > 0 ? 1 : 0;
            }
        }
    }
    TEST_ASSERT_GREATER_THAN_INT(300, accepted);
    TEST_ASSERT_GREATER_THAN_INT(300, driven);
}

/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Pedals in whole numbers. Channels from 0 to 32 768, dead band a quarter: the travel beyond it is
 * (ratio - 8192) 4/3. Accelerator 40 N m, brake pedal 200 N m, proportional. The channels of a
 * pedal are equal, which config_validate() would refuse.
 */
#include "paper_vehicle.h"
#include "pedals/pedals.h"
#include "unity.h"

enum {
    FULL_DRIVE = 40000,
    FULL_BRAKE = 200000,
    DEAD_BAND = 8192,
    FAULT_TIME = 100,
    LIFT_OFF = 10000,
    HALF = 16384,
    WHOLE = 32768,
    INVALID = -1
};

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
    pedals->interpretation = CONFIG_PEDAL_PROPORTIONAL;
    pedals->drive_torque_mNm = FULL_DRIVE;
    pedals->brake_torque_mNm = FULL_BRAKE;
    pedals->lift_off_torque_mNm = 0;
    pedals->dead_band_q15 = DEAD_BAND;
    pedals->fault_time_ms = FAULT_TIME;
    pedals->override_q15 = 8192;
    for (int k = 0; k < CONFIG_PEDAL_CHANNELS; k++) {
        pedals->lowest_q15[k] = pedals->released_q15[k] = 0;
        pedals->highest_q15[k] = pedals->pressed_q15[k] = WHOLE;
    }
    in = none;
    pedals_init(&state);
}

void tearDown(void) {}

/* The least ratio of a travel. */
static int32_t ratio_of(int32_t travel_q15)
{
    return DEAD_BAND + (travel_q15 * 3 + 3) / 4;
}

static pedals_output_t step(void)
{
    return pedals_step(&state, &config, &in);
}

static pedals_output_t run(int milliseconds)
{
    for (int n = 1; n < milliseconds; n++) {
        (void)step();
    }
    return step();
}

static void set_accelerator(int32_t a_q15, int32_t b_q15)
{
    in.ratio_q15[0] = a_q15;
    in.ratio_q15[1] = b_q15;
}

static void set_brake(int32_t a_q15, int32_t b_q15)
{
    in.ratio_q15[2] = a_q15;
    in.ratio_q15[3] = b_q15;
}

static pedals_output_t accelerate(int32_t travel_q15)
{
    set_accelerator(ratio_of(travel_q15), ratio_of(travel_q15));
    return step();
}

/* ---- travel ---- */

void test_the_travel_that_counts_is_that_beyond_the_dead_band(void)
{
    static const int32_t RATIO_q15[] = {0, 1, 8191, 8192, 8193, 20480, 32767, 32768};
    static const int32_t TRAVEL_q15[] = {0, 0, 0, 0, 1, 16384, 32766, 32768};
    config.pedals.drive_torque_mNm = WHOLE; /* so that the torque is the travel */
    config.pedals.brake_torque_mNm = WHOLE;
    for (int k = 0; k < 8; k++) {
        set_brake(0, 0);
        set_accelerator(RATIO_q15[k], RATIO_q15[k]);
        TEST_ASSERT_EQUAL_INT32(TRAVEL_q15[k], step().demand.drive_torque_mNm);
        set_accelerator(0, 0);
        set_brake(RATIO_q15[k], RATIO_q15[k]);
        TEST_ASSERT_EQUAL_INT32(TRAVEL_q15[k], step().demand.brake_torque_mNm);
    }
}

void test_travel_beyond_the_pressed_pedal_is_the_whole_travel(void)
{
    set_brake(WHOLE, WHOLE);
    for (int k = 0; k < CONFIG_PEDAL_CHANNELS; k++) {
        config.pedals.pressed_q15[k] = HALF;
    }
    TEST_ASSERT_EQUAL_INT32(FULL_BRAKE, step().demand.brake_torque_mNm);
}

void test_the_drive_torque_is_the_travel_s_share_of_the_whole(void)
{
    accelerate(0);
    TEST_ASSERT_EQUAL_INT32(FULL_DRIVE / 2, accelerate(HALF).demand.drive_torque_mNm);
    TEST_ASSERT_EQUAL_INT32(FULL_DRIVE, accelerate(WHOLE).demand.drive_torque_mNm);
}

/* ---- valid channels ---- */

void test_the_ends_of_the_valid_range_are_valid(void)
{
    static const int32_t RATIO_q15[] = {999, 1000, 32000, 32001};
    for (int k = 0; k < CONFIG_PEDAL_CHANNELS; k++) {
        config.pedals.lowest_q15[k] = 1000;
        config.pedals.highest_q15[k] = 32000;
    }
    for (int k = 0; k < 4; k++) {
        pedals_init(&state);
        set_brake(RATIO_q15[k], RATIO_q15[k]);
        const bool valid = k == 1 || k == 2;
        TEST_ASSERT_EQUAL_UINT32(valid ? 0 : UINT32_MAX, step().age_ms);
    }
}

/* A hundredth: 328 of 32 768. */
void test_channels_may_differ_by_exactly_the_configured_difference(void)
{
    config.pedals.difference_q15 = 328;
    for (int32_t apart_q15 = 328; apart_q15 <= 329; apart_q15++) {
        pedals_init(&state);
        accelerate(0);
        set_accelerator(ratio_of(4000), ratio_of(4000 + apart_q15));
        const pedals_output_t out = run(FAULT_TIME);
        TEST_ASSERT_EQUAL_INT(apart_q15 == 328 ? REASON_NONE : REASON_ACCELERATOR_SENSOR,
                              out.demand.reason);
        TEST_ASSERT_EQUAL_INT32(apart_q15 == 328 ? FULL_DRIVE * 4000 / WHOLE : 0,
                                out.demand.drive_torque_mNm);
    }
}

void test_a_pedal_with_one_channel_is_a_pedal(void)
{
    config.pedals.accelerator_channels = 1;
    config.pedals.brake_channels = 1;
    set_accelerator(0, INVALID);
    set_brake(ratio_of(HALF), INVALID);
    const pedals_output_t braking = run(FAULT_TIME);
    TEST_ASSERT_EQUAL_INT32(FULL_BRAKE / 2, braking.demand.brake_torque_mNm);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, braking.demand.reason);
    set_brake(0, INVALID);
    set_accelerator(ratio_of(HALF), INVALID);
    TEST_ASSERT_EQUAL_INT32(FULL_DRIVE / 2, step().demand.drive_torque_mNm);
    const wheel_demand_t demand = {.drive_torque_mNm = 10000, .brake_torque_mNm = 30000};
    config.pedals.drive_share_q15[0] = HALF;
    config.pedals.brake_share_q15[0] = HALF;
    const wheel_demand_t wheel = pedals_wheel_demand(&config, &demand, 0);
    TEST_ASSERT_EQUAL_INT32(5000, wheel.drive_torque_mNm);
    TEST_ASSERT_EQUAL_INT32(15000, wheel.brake_torque_mNm);
}

/* ---- lift-off braking ---- */

void test_the_smallest_lift_off_braking_is_one_millinewton_metre(void)
{
    config.pedals.lift_off_torque_mNm = 1;
    config.pedals.lift_off_travel_q15 = HALF;
    TEST_ASSERT_EQUAL_INT32(-1, accelerate(0).demand.drive_torque_mNm);
}

/* One channel on either side of the travel without torque. */
void test_channels_around_the_end_of_lift_off_braking_demand_neither_torque(void)
{
    config.pedals.lift_off_torque_mNm = LIFT_OFF;
    config.pedals.lift_off_travel_q15 = 4916;
    accelerate(0);
    set_accelerator(ratio_of(4900), ratio_of(4920));
    TEST_ASSERT_EQUAL_INT32(0, step().demand.drive_torque_mNm);
}

void test_lift_off_braking_needs_no_release_before(void)
{
    config.pedals.lift_off_torque_mNm = LIFT_OFF;
    config.pedals.lift_off_travel_q15 = HALF;
    const pedals_output_t out = accelerate(HALF / 2);
    TEST_ASSERT_EQUAL_INT32(-LIFT_OFF / 2, out.demand.drive_torque_mNm);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, out.demand.reason);
}

void test_an_accelerator_whose_fault_has_not_healed_does_not_brake(void)
{
    config.pedals.lift_off_torque_mNm = LIFT_OFF;
    config.pedals.lift_off_travel_q15 = HALF;
    set_accelerator(ratio_of(4000), INVALID);
    run(FAULT_TIME);
    set_accelerator(ratio_of(4000), ratio_of(4000));
    for (int n = 1; n < FAULT_TIME; n++) {
        TEST_ASSERT_EQUAL_INT32(0, step().demand.drive_torque_mNm);
    }
    TEST_ASSERT_LESS_THAN_INT32(0, step().demand.drive_torque_mNm);
}

/* ---- when it must be released ---- */

void test_channels_that_are_not_valid_release_no_accelerator(void)
{
    static const int32_t B_q15[] = {INVALID, 0};
    for (int k = 0; k < 2; k++) {
        pedals_init(&state);
        accelerate(HALF);
        set_accelerator(INVALID, B_q15[k]);
        TEST_ASSERT_EQUAL_INT32(0, step().demand.drive_torque_mNm);
        const pedals_output_t out = accelerate(HALF);
        TEST_ASSERT_EQUAL_INT32(0, out.demand.drive_torque_mNm);
        TEST_ASSERT_EQUAL_INT(REASON_ACCELERATOR_LOCKED, out.demand.reason);
    }
}

/* By CAN, from a brake pedal elsewhere. */
void test_any_braking_beside_a_pressed_accelerator_takes_the_drive(void)
{
    config.pedals.brake_channels = 0;
    in.received.direction = DRIVE_DIRECTION_FORWARD;
    in.received_age_ms = 0;
    accelerate(0);
    TEST_ASSERT_EQUAL_INT32(FULL_DRIVE / 2, accelerate(HALF).demand.drive_torque_mNm);
    in.received.brake_torque_mNm = 1;
    TEST_ASSERT_EQUAL_INT32(0, step().demand.drive_torque_mNm);
    in.received.brake_torque_mNm = 0;
    TEST_ASSERT_EQUAL_INT32(0, step().demand.drive_torque_mNm);
}

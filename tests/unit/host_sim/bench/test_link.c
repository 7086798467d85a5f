/* SPDX-License-Identifier: Apache-2.0 */
/* Frames between vehicle and wheel: what each fault makes of the demand that the wheel knows. */
#include "bench/link.h"

#include <string.h>

#include "app/can_link.h"
#include "unity.h"

extern const config_t CONFIG_LU2013;

enum { BRAKE_mNm = 40000, MORE_mNm = 50000, TIMEOUT_MS = 100 };

static fault_params_t fault;
static link_t link_of_wheel;
static slow_input_t in;

void setUp(void)
{
    memset(&fault, 0, sizeof(fault));
    memset(&link_of_wheel, 0, sizeof(link_of_wheel));
}

void tearDown(void) {}

/* A millisecond in which the vehicle wants so much. */
static void step(int32_t brake_mNm)
{
    const slow_input_t now = {
        .demand = {.brake_torque_mNm = brake_mNm,
                   .direction = DRIVE_DIRECTION_FORWARD,
                   .enable = true},
        .bms = {.charge_current_mA = 40000, .discharge_current_mA = 60000},
        .hydraulic = {.torque_mNm = 10000, .age_ms = 0, .valid = true},
        .selftest_passed = true,
        .config_accepted = true,
    };
    in = now;
    link_step(&fault, &link_of_wheel, &CONFIG_LU2013, &in);
}

static void steps(int count, int32_t brake_mNm)
{
    for (int k = 0; k < count; k++) {
        step(brake_mNm);
    }
}

void test_the_node_is_configured_as_in_the_application(void)
{
    const node_limits_t ours = link_limits(&CONFIG_LU2013);
    const node_limits_t theirs = can_link_limits(&CONFIG_LU2013);
    const battery_limits_t *pack = &theirs.pack;
    TEST_ASSERT_EQUAL_INT32(pack->charge_current_mA, ours.pack.charge_current_mA);
    TEST_ASSERT_EQUAL_INT32(pack->discharge_current_mA, ours.pack.discharge_current_mA);
    TEST_ASSERT_EQUAL_INT32(pack->charge_peak_current_mA, ours.pack.charge_peak_current_mA);
    TEST_ASSERT_EQUAL_INT32(pack->voltage_mV, ours.pack.voltage_mV);
    TEST_ASSERT_EQUAL(pack->contactor, ours.pack.contactor);
    TEST_ASSERT_EQUAL(pack->current_given, ours.pack.current_given);
    TEST_ASSERT_EQUAL_INT32(theirs.largest_drive_mNm, ours.largest_drive_mNm);
    TEST_ASSERT_EQUAL_INT32(theirs.largest_brake_mNm, ours.largest_brake_mNm);
    TEST_ASSERT_EQUAL_INT32(theirs.demand_rise_ms, ours.demand_rise_ms);
    TEST_ASSERT_EQUAL_INT32(theirs.demand_lost_frames, ours.demand_lost_frames);
}

void test_no_parameter_is_no_fault_and_any_is_one(void)
{
    TEST_ASSERT_FALSE(link_fault_present(&fault));
    fault.can_wrong_wheel = 1.0;
    TEST_ASSERT_TRUE(link_fault_present(&fault));
}

/* A share of damaged frames so small that none is: everything arrives, within a cycle. */
void test_a_good_link_hands_over_what_was_sent(void)
{
    fault.can_corrupt = 1e-12;
    step(BRAKE_mNm);
    TEST_ASSERT_INT32_WITHIN(500, BRAKE_mNm, in.demand.brake_torque_mNm);
    TEST_ASSERT_TRUE(in.demand.enable);
    steps(50, MORE_mNm);
    TEST_ASSERT_INT32_WITHIN(500, MORE_mNm, in.demand.brake_torque_mNm);
    TEST_ASSERT_TRUE(in.demand_age_ms < 10);
    TEST_ASSERT_INT32_WITHIN(1000, 40000, in.bms.charge_current_mA);
    TEST_ASSERT_TRUE(in.hydraulic.valid);
    TEST_ASSERT_INT32_WITHIN(500, 10000, in.hydraulic.torque_mNm);
    TEST_ASSERT_TRUE(in.selftest_passed && in.config_accepted);
}

void test_a_delayed_frame_is_the_one_of_so_long_ago(void)
{
    fault.can_delay_s = 0.05;
    steps(100, BRAKE_mNm);
    steps(49, MORE_mNm);
    TEST_ASSERT_INT32_WITHIN(500, BRAKE_mNm, in.demand.brake_torque_mNm);
    steps(12, MORE_mNm);
    TEST_ASSERT_INT32_WITHIN(500, MORE_mNm, in.demand.brake_torque_mNm);
    TEST_ASSERT_TRUE(in.demand_age_ms < 10); /* a constant delay is no age */
}

static void no_new_demand_arrives(void)
{
    steps(2 * TIMEOUT_MS, MORE_mNm);
    TEST_ASSERT_INT32_WITHIN(500, BRAKE_mNm, in.demand.brake_torque_mNm);
    TEST_ASSERT_TRUE(in.demand_age_ms > TIMEOUT_MS);
}

void test_repeated_frames_and_those_of_another_wheel_grow_old(void)
{
    fault.can_repeated = 1.0;
    step(BRAKE_mNm);
    no_new_demand_arrives();
    setUp();
    fault.can_wrong_wheel = 1.0;
    step(BRAKE_mNm);
    no_new_demand_arrives();
}

/* Every frame: a residue of 1 in 65 536 of frames may pass. */
void test_damaged_frames_grow_old(void)
{
    fault.can_corrupt = 1.0;
    step(BRAKE_mNm);
    no_new_demand_arrives();
    TEST_ASSERT_FALSE(in.hydraulic.valid);
    steps(5 * 100, MORE_mNm); /* five cycles of the battery's message */
    TEST_ASSERT_EQUAL_INT32(0, in.bms.charge_current_mA);
}

/* In each round three frames qualify the sequence anew, and the recorded demand comes again. */
void test_a_replay_brings_the_recorded_demand_and_never_the_new_one(void)
{
    fault.can_replay_s = 0.3;
    steps(300, BRAKE_mNm);
    for (int k = 0; k < 1500; k++) {
        step(MORE_mNm);
        TEST_ASSERT_INT32_WITHIN(500, BRAKE_mNm, in.demand.brake_torque_mNm);
        TEST_ASSERT_TRUE(in.demand_age_ms < TIMEOUT_MS);
    }
}

void test_a_reset_link_begins_again_with_what_is_sent(void)
{
    fault.can_repeated = 1.0;
    step(BRAKE_mNm);
    steps(200, MORE_mNm);
    link_reset(&link_of_wheel);
    step(MORE_mNm);
    TEST_ASSERT_INT32_WITHIN(500, MORE_mNm, in.demand.brake_torque_mNm);
    TEST_ASSERT_TRUE(in.demand_age_ms < 20);
}

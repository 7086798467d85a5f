/* SPDX-License-Identifier: Apache-2.0 */
#include <string.h>

#include "core/fault.h"
#include "fault_rows.h"
#include "modes_rig.h"
#include "random_values.h"

void setUp(void)
{
    start();
}

void tearDown(void) {}

void test_fault_in_any_mode_after_boot_sets_the_torque_enable_to_zero_in_the_same_step(void)
{
    for (operating_mode_t mode = MODE_SELFTEST; mode <= MODE_LIMP; mode++) {
        start_in(mode);
        in.fault = REASON_BUS_OVERVOLTAGE;
        const modes_output_t out = step();
        assert_mode(MODE_FAULT, out);
        TEST_ASSERT_EQUAL_INT(REASON_BUS_OVERVOLTAGE, out.fault);
        TEST_ASSERT_EQUAL_INT16(0, out.torque_enable.drive_q15);
        TEST_ASSERT_EQUAL_INT16(0, out.torque_enable.brake_q15);
        TEST_ASSERT_EQUAL_INT(REASON_BUS_OVERVOLTAGE, out.torque_enable.reason);
    }
}

void test_reason_of_the_first_fault_is_kept(void)
{
    start_in(MODE_FAULT);
    in.fault = REASON_BUS_UNDERVOLTAGE;
    TEST_ASSERT_EQUAL_INT(REASON_OVERCURRENT, run(10).fault);
}

void test_a_fault_never_clears_itself(void)
{
    start_in(MODE_FAULT);
    in.enable = true;
    const modes_output_t out = run(100000);
    assert_mode(MODE_FAULT, out);
    TEST_ASSERT_EQUAL_INT(REASON_OVERCURRENT, out.fault);
}

void test_acknowledgement_at_standstill_restarts_from_the_self_test(void)
{
    start_in(MODE_FAULT);
    in.fault_reset = true;
    const modes_output_t out = step();
    assert_mode(MODE_SELFTEST, out);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, out.fault);
    TEST_ASSERT_TRUE(out.clear_trip);
    TEST_ASSERT_FALSE(step().clear_trip);
    assert_mode(MODE_OFFSET_CAL, step());
    assert_mode(MODE_READY, run(10));
}

void test_a_withdrawn_configuration_or_self_test_ends_every_mode_that_needed_it(void)
{
    for (operating_mode_t mode = MODE_SELFTEST; mode <= MODE_LIMP; mode++) {
        start_in(mode);
        in.config_accepted = false;
        const modes_output_t refused = step();
        assert_mode(MODE_FAULT, refused);
        TEST_ASSERT_EQUAL_INT(REASON_CONFIG_INVALID, refused.fault);
        TEST_ASSERT_FALSE(torque_enable_any(refused.torque_enable));
        start_in(mode);
        if (mode != MODE_SELFTEST) { /* which waits for it */
            in.selftest_passed = false;
            const modes_output_t failed = step();
            assert_mode(MODE_FAULT, failed);
            TEST_ASSERT_EQUAL_INT(REASON_SELFTEST_FAILED, failed.fault);
        }
    }
}

void test_a_fault_that_only_a_restart_clears_cannot_be_acknowledged(void)
{
    start_in(MODE_RUN);
    in.selftest_passed = false;
    step();
    in.selftest_passed = true;
    in.fault_reset = true;
    const modes_output_t out = run(1000);
    assert_mode(MODE_FAULT, out);
    TEST_ASSERT_FALSE(out.clear_trip);
    TEST_ASSERT_EQUAL_INT(WAITS_FOR_RESTART, out.waits_for);
}

void test_an_acknowledgement_with_a_withdrawn_configuration_waits_for_it(void)
{
    start_in(MODE_FAULT);
    in.config_accepted = false;
    in.fault_reset = true;
    assert_mode(MODE_FAULT, step());
    in.config_accepted = true;
    assert_mode(MODE_SELFTEST, step());
}

void test_acknowledgement_is_ignored_while_the_monitor_does_not_know_rest(void)
{
    start_in(MODE_FAULT);
    in.bound_mrad_s = 0;
    in.at_rest = false;
    in.fault_reset = true;
    const modes_output_t out = run(10);
    assert_mode(MODE_FAULT, out);
    TEST_ASSERT_EQUAL_INT(WAITS_FOR_REST, out.waits_for);
    in.at_rest = true;
    assert_mode(MODE_FAULT, run(1000));
}

void test_fault_reset_needs_a_rising_edge(void)
{
    in.fault_reset = true;
    run(10);
    in.fault = REASON_OVERCURRENT;
    step();
    in.fault = REASON_NONE;
    assert_mode(MODE_FAULT, run(10000));
    in.fault_reset = false;
    assert_mode(MODE_FAULT, run(10));
    in.fault_reset = true;
    assert_mode(MODE_SELFTEST, step());
}

void test_acknowledgement_while_rolling_is_ignored(void)
{
    start_in(MODE_FAULT);
    in.bound_mrad_s = ROLLING_mrad_s;
    in.at_rest = false;
    in.fault_reset = true;
    assert_mode(MODE_FAULT, run(10));
    in.bound_mrad_s = 0;
    in.at_rest = true;
    assert_mode(MODE_FAULT, run(1000));
}

void test_acknowledgement_with_a_torque_demand_is_ignored(void)
{
    start_in(MODE_FAULT);
    in.brake_demanded = true;
    in.fault_reset = true;
    assert_mode(MODE_FAULT, run(10));
    in.brake_demanded = false;
    assert_mode(MODE_FAULT, run(1000));
}

void test_offsets_that_were_implausible_are_measured_again_after_an_acknowledgement(void)
{
    start_in(MODE_OFFSET_CAL);
    in.offsets_plausible = false;
    in.offsets_done = true;
    const modes_output_t out = run(MODES_CALIBRATION_SETTLE_STEPS);
    assert_mode(MODE_FAULT, out);
    TEST_ASSERT_EQUAL_INT(REASON_OFFSET_IMPLAUSIBLE, out.fault);
    in.offsets_plausible = true;
    in.fault_reset = true;
    assert_mode(MODE_SELFTEST, step());
    assert_mode(MODE_OFFSET_CAL, step());
    assert_mode(MODE_READY, run(MODES_CALIBRATION_SETTLE_STEPS));
}

void test_acknowledgement_waits_for_the_fault_to_clear(void)
{
    start_in(MODE_FAULT);
    in.fault = REASON_OVERCURRENT; /* until the fast loop has cleared its trip */
    in.fault_reset = true;
    for (int n = 0; n < MODES_ACKNOWLEDGE_STEPS - 1; n++) {
        const modes_output_t out = step();
        assert_mode(MODE_FAULT, out);
        TEST_ASSERT_TRUE(out.clear_trip);
    }
    in.fault = REASON_NONE;
    assert_mode(MODE_SELFTEST, step());
}

void test_acknowledgement_expires(void)
{
    start_in(MODE_FAULT);
    in.fault = REASON_OVERCURRENT;
    in.fault_reset = true;
    run(MODES_ACKNOWLEDGE_STEPS);
    const modes_output_t out = step();
    TEST_ASSERT_FALSE(out.clear_trip);
    in.fault = REASON_NONE;
    assert_mode(MODE_FAULT, run(1000));
}

void test_torque_demand_cancels_a_waiting_acknowledgement(void)
{
    start_in(MODE_FAULT);
    in.fault = REASON_OVERCURRENT;
    in.fault_reset = true;
    run(10);
    in.brake_demanded = true;
    TEST_ASSERT_FALSE(step().clear_trip);
    in.brake_demanded = false;
    in.fault = REASON_NONE;
    assert_mode(MODE_FAULT, run(1000));
}

void test_next_fault_after_an_acknowledgement_has_its_own_reason(void)
{
    start_in(MODE_FAULT);
    in.fault_reset = true;
    run(20);
    in.fault = REASON_CURRENT_SUM;
    TEST_ASSERT_EQUAL_INT(REASON_CURRENT_SUM, step().fault);
}

/* ---- random inputs ---- */

static void random_input(random_t *random)
{
    in.config_accepted = random_chance(random, 0.999);
    in.selftest_passed = random_chance(random, 0.999);
    in.offsets_done = random_chance(random, 0.9);
    in.offsets_plausible = random_chance(random, 0.99);
    const bool rolling = random_chance(random, 0.3);
    in.bound_mrad_s = rolling ? ROLLING_mrad_s : 0;
    in.at_rest = !rolling && random_chance(random, 0.9);
    in.enable = random_chance(random, 0.8);
    in.brake_demanded = random_chance(random, 0.3);
    in.fault_reset = random_chance(random, 0.3);
    in.warning = random_chance(random, 0.1) ? FINDING_ROTOR_READING : FINDING_COUNT;
    in.fault = random_chance(random, 0.02) ? REASON_CURRENT_SUM : REASON_NONE;
    in.emf_conducts = random_chance(random, 0.1);
    in.warning = random_chance(random, 0.1) ? FINDING_BATTERY_LEFT : in.warning;
    in.bridge = random_chance(random, 0.5) ? BRIDGE_OFF : BRIDGE_PWM;
}

void test_bridge_switches_only_in_run_and_limp_under_random_inputs(void)
{
    random_t random = random_seeded(1);
    int running = 0;
    findings.braking_kept = true; /* a battery that has left counts no longer than its cause */
    for (int n = 0; n < 200000; n++) {
        random_input(&random);
        const modes_output_t out = step();
        const bool may_switch = out.mode == MODE_RUN || out.mode == MODE_LIMP;
        TEST_ASSERT_EQUAL(may_switch && in.warning != FINDING_BATTERY_LEFT,
                          torque_enable_any(out.torque_enable));
        running += may_switch ? 1 : 0;
        if (!may_switch) {
            TEST_ASSERT_EQUAL_INT16(0, out.torque_enable.drive_q15);
            TEST_ASSERT_EQUAL_INT16(0, out.torque_enable.brake_q15);
        }
        const bool full =
            out.torque_enable.drive_q15 == Q15_ONE && out.torque_enable.brake_q15 == Q15_ONE;
        TEST_ASSERT_EQUAL(full, out.torque_enable.reason == REASON_NONE);
        TEST_ASSERT_EQUAL(out.mode == MODE_FAULT, out.fault != REASON_NONE);
        if (out.waits_for == WAITS_FOR_RESTART) {
            modes_init(&state);
        }
    }
    TEST_ASSERT_GREATER_THAN_INT(10000, running);
}

/* One of the table's faults, each as likely. */
static reason_t random_latched(random_t *random)
{
    for (;;) {
        reason_t reason = REASON_NONE;
        if (fault_listed((uint32_t)random_between(random, 0, 63), &reason) && is_latched(reason)) {
            return reason;
        }
    }
}

void test_fault_ends_only_at_rest_without_demand_after_a_rising_edge_and_never_of_itself(void)
{
    random_t random = random_seeded(2);
    int since_edge = 1000;
    int left = 0;
    int restarts = 0;
    for (int n = 0; n < 400000; n++) {
        const operating_mode_t before = state.mode;
        const reason_t fault_before = state.fault;
        const bool reset_before = in.fault_reset;
        random_input(&random);
        in.fault = in.fault != REASON_NONE ? random_latched(&random) : REASON_NONE;
        since_edge = in.fault_reset && !reset_before ? 0 : since_edge + 1;
        const modes_output_t out = step();
        if (before == MODE_FAULT && out.mode != MODE_FAULT) {
            left++;
            TEST_ASSERT_TRUE(in.at_rest);
            TEST_ASSERT_FALSE(in.brake_demanded);
            TEST_ASSERT_EQUAL_INT(REASON_NONE, in.fault);
            TEST_ASSERT_LESS_THAN_INT(MODES_ACKNOWLEDGE_STEPS, since_edge);
            TEST_ASSERT_EQUAL_INT(FAULT_CLEARING_ACKNOWLEDGED, fault_clearing(fault_before));
        } else if (before == MODE_FAULT) {
            TEST_ASSERT_EQUAL_INT(fault_before, out.fault);
        }
        if (out.mode == MODE_RUN || out.mode == MODE_LIMP) {
            TEST_ASSERT_EQUAL_INT(REASON_NONE, out.fault);
            TEST_ASSERT_TRUE(in.config_accepted && in.selftest_passed);
        }
        if (out.waits_for == WAITS_FOR_RESTART && random_chance(&random, 0.01)) {
            modes_init(&state);
            restarts++;
        }
    }
    TEST_ASSERT_GREATER_THAN_INT(100, left);
    TEST_ASSERT_GREATER_THAN_INT(100, restarts);
}

/* Any bit of mode or fault that flips between two steps, in any mode: also FAULT back to RUN. */
void test_a_flipped_bit_of_mode_or_fault_is_a_fault_that_only_a_restart_clears(void)
{
    for (operating_mode_t mode = MODE_BOOT; mode <= MODE_FAULT; mode++) {
        for (unsigned bit = 0; bit < 16; bit++) {
            start_in(mode);
            if (bit < 8) {
                state.mode = (operating_mode_t)((unsigned)state.mode ^ 1U << bit);
            } else {
                state.fault = (reason_t)((unsigned)state.fault ^ 1U << (bit - 8U));
            }
            in.enable = true;
            const modes_output_t out = step();
            assert_mode(MODE_FAULT, out);
            TEST_ASSERT_EQUAL_INT(REASON_MEMORY, out.fault);
            TEST_ASSERT_FALSE(torque_enable_any(out.torque_enable));
            in.fault_reset = true;
            assert_mode(MODE_FAULT, run(100));
        }
    }
}

void test_init_clears_the_fault(void)
{
    memset(&state, 0xFF, sizeof state);
    modes_init(&state);
    TEST_ASSERT_EQUAL_INT(MODE_BOOT, state.mode);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, state.fault);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, state.warning);
    TEST_ASSERT_EQUAL_UINT16(0, state.steps);
    TEST_ASSERT_EQUAL_UINT16(0, state.acknowledge_steps);
    TEST_ASSERT_FALSE(state.reset_before);
}

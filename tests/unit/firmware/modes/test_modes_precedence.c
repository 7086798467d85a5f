/* SPDX-License-Identifier: Apache-2.0 */
/* Which of several causes is shown, and what is left of a state that came before. */
#include <string.h>

#include "modes_rig.h"

void setUp(void)
{
    start();
}

void tearDown(void) {}

/* ---- memory ---- */

void test_init_does_not_depend_on_what_the_memory_held(void)
{
    memset(&state, 0xFF, sizeof state);
    modes_init(&state);
    TEST_ASSERT_FALSE(state.offsets_stored);
    TEST_ASSERT_FALSE(state.fault_persists);
    assert_mode(MODE_SELFTEST, step());
}

/* A cleared state would be BOOT without a fault if the copy were not inverted. */
void test_cleared_memory_is_a_fault(void)
{
    memset(&state, 0, sizeof state);
    const modes_output_t out = step();
    assert_mode(MODE_FAULT, out);
    TEST_ASSERT_EQUAL_INT(REASON_MEMORY, out.fault);
}

void test_each_flipped_bit_of_mode_or_fault_is_a_fault(void)
{
    /* An enumeration has one byte on the target. */
    const unsigned bits = sizeof state.mode == 1 ? 8U : 16U;
    for (unsigned bit = 0; bit < bits; bit++) {
        for (operating_mode_t mode = MODE_BOOT; mode <= MODE_FAULT; mode++) {
            start_in(mode);
            state.mode = (operating_mode_t)((unsigned)state.mode ^ 1U << bit);
            TEST_ASSERT_EQUAL_INT(REASON_MEMORY, step().fault);
            start_in(mode);
            state.fault = (reason_t)((unsigned)state.fault ^ 1U << bit);
            TEST_ASSERT_EQUAL_INT(REASON_MEMORY, step().fault);
        }
    }
}

void test_time_in_a_mode_saturates(void)
{
    start_in(MODE_READY);
    (void)run(UINT16_MAX + 10);
    TEST_ASSERT_EQUAL_UINT16(UINT16_MAX, state.steps);
}

/* ---- offsets ---- */

/* The fast loop begins a new calibration after the current: its old result must not count. */
void test_offsets_settle_for_the_full_time_after_a_current(void)
{
    start_in(MODE_OFFSET_CAL);
    in.emf_conducts = true;
    assert_mode(MODE_OFFSET_CAL, step());
    in.emf_conducts = false;
    in.offsets_done = true;
    assert_mode(MODE_OFFSET_CAL, run(MODES_CALIBRATION_SETTLE_STEPS - 1));
    assert_mode(MODE_READY, step());
}

void test_measured_offsets_leave_no_warning_when_their_flag_is_gone(void)
{
    start_in(MODE_OFFSET_CAL);
    (void)run(MODES_CALIBRATION_SETTLE_STEPS);
    in.offsets_done = true;
    assert_mode(MODE_READY, step());
    in.offsets_done = false;
    in.enable = true;
    assert_mode(MODE_RUN, run(3));
}

static void start_with_stored_offsets(void)
{
    start_in(MODE_OFFSET_CAL);
    in.emf_conducts = true;
    in.enable = true;
    assert_mode(MODE_READY, run(config.modes.offset_wait_ms));
    assert_mode(MODE_LIMP, run(2));
}

void test_stored_offsets_stay_in_use_when_the_measured_ones_are_implausible(void)
{
    start_with_stored_offsets();
    in.offsets_done = true;
    in.offsets_plausible = false;
    assert_mode(MODE_LIMP, run(100));
    in.offsets_plausible = true;
    assert_mode(MODE_RUN, step());
}

void test_a_warning_of_the_monitor_is_shown_before_that_of_the_stored_offsets(void)
{
    start_with_stored_offsets();
    TEST_ASSERT_EQUAL_INT(REASON_OFFSETS_STORED, step().warning);
    in.warning = FINDING_ROTOR_READING;
    const modes_output_t out = step();
    TEST_ASSERT_EQUAL_INT(REASON_ROTOR_UNCERTAIN, out.warning);
    TEST_ASSERT_EQUAL_INT(REASON_ROTOR_UNCERTAIN, out.torque_enable.reason);
}

/* ---- warnings ---- */

/* The table of findings gives this one no reaction: the driver is told, the torque stays. */
void test_a_warning_without_a_reaction_leaves_run_as_it_is(void)
{
    start_in(MODE_RUN);
    in.warning = FINDING_BRAKE_REPORT;
    const modes_output_t out = run(10);
    assert_mode(MODE_RUN, out);
    TEST_ASSERT_EQUAL_INT(REASON_HYDRAULIC_FEEDBACK, out.warning);
    TEST_ASSERT_EQUAL_INT16(Q15_ONE, out.torque_enable.drive_q15);
}

/* ---- reason of the torque enable ---- */

void test_switched_off_while_rolling_the_reason_is_the_enable(void)
{
    start_in(MODE_RUN);
    in.bound_mrad_s = ROLLING_mrad_s;
    in.enable = false;
    TEST_ASSERT_EQUAL_INT(REASON_TORQUE_ENABLE, step().torque_enable.reason);
}

void test_on_the_way_up_the_reason_is_the_mode_and_not_the_rotor(void)
{
    const operating_mode_t modes[] = {MODE_SELFTEST, MODE_OFFSET_CAL};
    for (int k = 0; k < 2; k++) {
        start_in(modes[k]);
        in.angle_valid = false;
        TEST_ASSERT_EQUAL_INT(REASON_TORQUE_ENABLE, step().torque_enable.reason);
    }
}

void test_without_a_battery_both_shares_are_exactly_zero(void)
{
    start_in(MODE_RUN);
    in.warning = FINDING_BATTERY_LEFT;
    const torque_enable_t out = step().torque_enable;
    TEST_ASSERT_EQUAL_INT16(0, out.drive_q15);
    TEST_ASSERT_EQUAL_INT16(0, out.brake_q15);
}

void test_without_a_battery_a_mode_without_torque_keeps_its_own_reason(void)
{
    start_in(MODE_FAULT);
    in.warning = FINDING_BATTERY_LEFT;
    TEST_ASSERT_EQUAL_INT(REASON_OVERCURRENT, step().torque_enable.reason);
}

/* ---- faults ---- */

void test_the_monitor_s_fault_is_named_before_what_is_withdrawn_at_the_same_time(void)
{
    start_in(MODE_RUN);
    in.fault = REASON_OVERCURRENT;
    in.config_accepted = false;
    TEST_ASSERT_EQUAL_INT(REASON_OVERCURRENT, step().fault);
    start_in(MODE_RUN);
    in.fault = REASON_OVERCURRENT;
    in.selftest_passed = false;
    TEST_ASSERT_EQUAL_INT(REASON_OVERCURRENT, step().fault);
}

/* ---- what driving waits for ---- */

void test_the_first_step_of_ready_names_no_condition_when_all_are_met(void)
{
    start_in(MODE_OFFSET_CAL);
    in.enable = true;
    (void)run(MODES_CALIBRATION_SETTLE_STEPS);
    in.offsets_done = true;
    const modes_output_t out = step();
    assert_mode(MODE_READY, out);
    TEST_ASSERT_EQUAL_INT(WAITS_FOR_NONE, out.waits_for);
}

void test_a_lost_battery_is_waited_for_before_a_direction(void)
{
    start_in(MODE_RUN);
    in.neutral = true;
    in.warning = FINDING_BATTERY_UNKNOWN;
    TEST_ASSERT_EQUAL_INT(WAITS_FOR_BATTERY, step().waits_for);
}

void test_a_fault_at_standstill_waits_for_the_released_pedal(void)
{
    start_in(MODE_FAULT);
    in.brake_demanded = true;
    TEST_ASSERT_EQUAL_INT(WAITS_FOR_REST, step().waits_for);
}

/* While a second acknowledgement is pending, it is not known whether the cause is still there. */
void test_a_new_acknowledgement_forgets_that_the_last_one_found_the_fault(void)
{
    start_in(MODE_FAULT);
    in.fault = REASON_OVERCURRENT;
    in.fault_reset = true;
    TEST_ASSERT_EQUAL_INT(WAITS_FOR_FAULT_CAUSE, run(MODES_ACKNOWLEDGE_STEPS + 1).waits_for);
    in.fault_reset = false;
    TEST_ASSERT_EQUAL_INT(WAITS_FOR_FAULT_CAUSE, step().waits_for);
    in.fault_reset = true;
    TEST_ASSERT_EQUAL_INT(WAITS_FOR_ACKNOWLEDGEMENT, step().waits_for);
}

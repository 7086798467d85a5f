/* SPDX-License-Identifier: Apache-2.0 */
#include "modes_rig.h"

void setUp(void)
{
    start();
}

void tearDown(void) {}

/* ---- start-up ---- */

void test_from_boot_to_ready_in_the_order_of_the_diagram(void)
{
    assert_mode(MODE_SELFTEST, step());
    assert_mode(MODE_OFFSET_CAL, step());
    assert_mode(MODE_READY, run(MODES_CALIBRATION_SETTLE_STEPS));
    assert_mode(MODE_READY, run(100000));
    in.enable = true;
    assert_mode(MODE_RUN, step());
}

void test_ready_waits_for_a_valid_rotor_angle_with_reason_rotor_uncertain(void)
{
    start_in(MODE_READY);
    in.enable = true;
    in.angle_valid = false;
    assert_mode(MODE_READY, run(100000));
    TEST_ASSERT_EQUAL_INT(REASON_ROTOR_UNCERTAIN, step().torque_enable.reason);
    in.angle_valid = true;
    assert_mode(MODE_RUN, step());
    in.angle_valid =
        false; /* what follows now is the monitor's business: the torque must leave in a ramp */
    assert_mode(MODE_RUN, run(10));
}

void test_boot_is_not_left_without_an_accepted_configuration(void)
{
    in.config_accepted = false;
    in.enable = true;
    assert_mode(MODE_BOOT, run(100000));
    in.fault = REASON_OVERCURRENT; /* other inputs have no effect yet */
    assert_mode(MODE_BOOT, step());
    in.fault = REASON_NONE;
    in.config_accepted = true;
    assert_mode(MODE_SELFTEST, step());
}

void test_a_self_test_that_does_not_pass_within_a_second_is_a_fault(void)
{
    start_in(MODE_SELFTEST);
    assert_mode(MODE_SELFTEST, run(config.modes.selftest_timeout_ms - 1));
    const modes_output_t out = step();
    assert_mode(MODE_FAULT, out);
    TEST_ASSERT_EQUAL_INT(REASON_SELFTEST_FAILED, out.fault);
}

void test_offsets_are_calibrated_in_their_mode_and_in_no_other(void)
{
    for (operating_mode_t mode = MODE_BOOT; mode <= MODE_FAULT; mode++) {
        start_in(mode);
        TEST_ASSERT_EQUAL(mode == MODE_OFFSET_CAL, step().calibrate_offsets);
    }
}

void test_offset_calibration_waits_for_a_new_result(void)
{
    start_in(MODE_OFFSET_CAL);
    in.offsets_done = true; /* flag of an earlier calibration */
    assert_mode(MODE_OFFSET_CAL, run(MODES_CALIBRATION_SETTLE_STEPS - 1));
    in.offsets_done = false; /* the fast loop has begun */
    assert_mode(MODE_OFFSET_CAL, run(100));
    in.offsets_done = true;
    assert_mode(MODE_READY, step());
}

void test_implausible_offsets_are_a_fault(void)
{
    start_in(MODE_OFFSET_CAL);
    in.offsets_plausible = false;
    assert_mode(MODE_OFFSET_CAL, run(50)); /* not before they are done */
    in.offsets_done = true;
    const modes_output_t out = step();
    assert_mode(MODE_FAULT, out);
    TEST_ASSERT_EQUAL_INT(REASON_OFFSET_IMPLAUSIBLE, out.fault);
}

/* Those of the last calibration, until the fast loop has begun this one; and while the EMF drives a
 * current there is none. In another mode they are measured beside the others and may wait. */
void test_implausible_offsets_of_another_calibration_are_no_fault(void)
{
    start_in(MODE_OFFSET_CAL);
    in.offsets_plausible = false;
    in.offsets_done = true;
    assert_mode(MODE_OFFSET_CAL, run(MODES_CALIBRATION_SETTLE_STEPS - 1));
    assert_mode(MODE_FAULT, step());
    start_in(MODE_OFFSET_CAL);
    in.offsets_plausible = false;
    in.offsets_done = true;
    in.emf_conducts = true;
    assert_mode(MODE_OFFSET_CAL, run(10 * MODES_CALIBRATION_SETTLE_STEPS));
    start_in(MODE_READY);
    in.offsets_plausible = false;
    in.offsets_done = true;
    TEST_ASSERT_NOT_EQUAL_INT(MODE_FAULT, run(10 * MODES_CALIBRATION_SETTLE_STEPS).mode);
}

void test_offset_calibration_times_out_after_half_a_second(void)
{
    start_in(MODE_OFFSET_CAL);
    assert_mode(MODE_OFFSET_CAL, run(MODES_CALIBRATION_TIMEOUT_STEPS - 1));
    const modes_output_t out = step();
    assert_mode(MODE_FAULT, out);
    TEST_ASSERT_EQUAL_INT(REASON_OFFSET_IMPLAUSIBLE, out.fault);
}

/* ---- running ---- */

void test_run_waits_for_a_zero_drive_demand_but_not_for_a_zero_brake_demand(void)
{
    start_in(MODE_READY);
    in.enable = true;
    in.brake_demanded = true;
    in.drive_demanded = true;
    assert_mode(MODE_READY, run(1000));
    in.drive_demanded = false; /* the brake pedal is still pressed */
    assert_mode(MODE_RUN, step());
    in.drive_demanded = true;
    assert_mode(MODE_RUN, run(1000));
}

void test_disable_at_standstill_leads_to_ready(void)
{
    const operating_mode_t running[] = {MODE_RUN, MODE_LIMP};
    for (int k = 0; k < 2; k++) {
        start_in(running[k]);
        in.enable = false;
        assert_mode(MODE_READY, step());
    }
}

void test_disable_while_rolling_sets_the_drive_enable_to_zero_and_keeps_the_brake_enable(void)
{
    const operating_mode_t running[] = {MODE_RUN, MODE_LIMP};
    for (int k = 0; k < 2; k++) {
        start_in(running[k]);
        in.bound_mrad_s = ROLLING_mrad_s;
        in.enable = false;
        const modes_output_t out = run(10000);
        assert_mode(running[k], out);
        TEST_ASSERT_EQUAL_INT16(0, out.torque_enable.drive_q15);
        TEST_ASSERT_EQUAL_INT16(Q15_ONE, out.torque_enable.brake_q15);
        TEST_ASSERT_NOT_EQUAL_INT(REASON_NONE, out.torque_enable.reason);
        in.bound_mrad_s = 0;
        assert_mode(MODE_READY, step());
    }
}

void test_accelerator_held_while_switched_on_rolling_drives_once_it_was_released(void)
{
    const operating_mode_t running[] = {MODE_RUN, MODE_LIMP};
    for (int k = 0; k < 2; k++) {
        start_in(running[k]);
        in.bound_mrad_s = ROLLING_mrad_s;
        in.drive_demanded = true;
        const int16_t share_q15 = run(10).torque_enable.drive_q15;
        TEST_ASSERT_GREATER_THAN_INT16(0, share_q15);
        in.enable = false;
        TEST_ASSERT_EQUAL_INT16(0, step().torque_enable.drive_q15);
        in.enable = true;
        const modes_output_t pressed = run(10000);
        TEST_ASSERT_EQUAL_INT16(0, pressed.torque_enable.drive_q15);
        TEST_ASSERT_EQUAL_INT16(Q15_ONE, pressed.torque_enable.brake_q15);
        TEST_ASSERT_NOT_EQUAL_INT(REASON_NONE, pressed.torque_enable.reason);
        TEST_ASSERT_EQUAL_INT(WAITS_FOR_PEDAL_RELEASE, pressed.waits_for);
        in.drive_demanded = false;
        in.demand_lost = true; /* a released pedal of an old demand is none */
        run(10);
        in.demand_lost = false;
        in.drive_demanded = true;
        TEST_ASSERT_EQUAL_INT16(0, step().torque_enable.drive_q15);
        in.drive_demanded = false;
        step();
        in.drive_demanded = true;
        TEST_ASSERT_EQUAL_INT16(share_q15, step().torque_enable.drive_q15);
        TEST_ASSERT_EQUAL_INT(WAITS_FOR_NONE, step().waits_for);
    }
}

void test_a_warning_leads_to_limp_and_its_end_back_to_run(void)
{
    start_in(MODE_RUN);
    in.warning = FINDING_ROTOR_READING;
    assert_mode(MODE_LIMP, step());
    assert_mode(MODE_LIMP, run(100));
    in.warning = FINDING_COUNT;
    assert_mode(MODE_RUN, step());
}

void test_warning_in_ready_has_no_effect(void)
{
    start_in(MODE_READY);
    in.warning = FINDING_ROTOR_READING;
    assert_mode(MODE_READY, run(100));
}

/* ---- torque_enable, mode by mode ---- */

void test_torque_enable_of_every_mode_is_that_of_the_table(void)
{
    static const struct {
        operating_mode_t mode;
        int16_t drive_q15, brake_q15;
        reason_t reason;
    } TABLE[] = {
        {MODE_BOOT, 0, 0, REASON_CONFIG_INVALID},
        {MODE_SELFTEST, 0, 0, REASON_TORQUE_ENABLE},
        {MODE_OFFSET_CAL, 0, 0, REASON_TORQUE_ENABLE},
        {MODE_READY, 0, 0, REASON_TORQUE_ENABLE},
        {MODE_RUN, Q15_ONE, Q15_ONE, REASON_NONE},
        {MODE_LIMP, 9830, Q15_ONE, REASON_ROTOR_UNCERTAIN},
        {MODE_FAULT, 0, 0, REASON_OVERCURRENT},
    };
    for (int k = 0; k < 7; k++) {
        start_in(TABLE[k].mode);
        const torque_enable_t out = step().torque_enable;
        TEST_ASSERT_EQUAL_INT16(TABLE[k].drive_q15, out.drive_q15);
        TEST_ASSERT_EQUAL_INT16(TABLE[k].brake_q15, out.brake_q15);
        TEST_ASSERT_EQUAL_INT(TABLE[k].reason, out.reason);
    }
}

void test_limp_enables_the_configured_share_of_the_driving_torque(void)
{
    const int16_t shares_q15[] = {9830, 0, 16384, Q15_ONE};
    for (int k = 0; k < 4; k++) {
        start_in(MODE_LIMP);
        config.modes.limp_drive_share_q15 = shares_q15[k];
        const torque_enable_t out = step().torque_enable;
        TEST_ASSERT_EQUAL_INT16(shares_q15[k], out.drive_q15);
        TEST_ASSERT_EQUAL_INT16(Q15_ONE, out.brake_q15);
    }
}

void test_self_test_times_out_after_the_configured_time(void)
{
    start_in(MODE_SELFTEST);
    config.modes.selftest_timeout_ms = 50;
    assert_mode(MODE_SELFTEST, run(49));
    assert_mode(MODE_FAULT, step());
    TEST_ASSERT_EQUAL_INT(REASON_SELFTEST_FAILED, state.fault);
}

/* A controller that restarts at high speed: in freewheel the diodes rectify the EMF, and their
 * current would be calibrated as the sensors' offset. */
void test_no_offset_calibration_while_the_emf_drives_a_current(void)
{
    start_in(MODE_SELFTEST);
    in.emf_conducts = true;
    (void)step();
    in.selftest_passed = true;
    in.offsets_done = false;
    for (int k = 1; k < config.modes.offset_wait_ms; k++) {
        const modes_output_t out = step();
        assert_mode(MODE_OFFSET_CAL, out);
        TEST_ASSERT_FALSE(out.calibrate_offsets);
    }
    in.emf_conducts = false;
    const modes_output_t out = step();
    assert_mode(MODE_OFFSET_CAL, out);
    TEST_ASSERT_TRUE(out.calibrate_offsets);
}

void test_offset_calibration_restarts_after_a_current(void)
{
    start_in(MODE_OFFSET_CAL);
    config.modes.offset_wait_ms = 2 * MODES_CALIBRATION_TIMEOUT_STEPS;
    in.offsets_done = false;
    (void)run(MODES_CALIBRATION_TIMEOUT_STEPS - 10);
    in.emf_conducts = true;
    TEST_ASSERT_FALSE(step().calibrate_offsets);
    in.emf_conducts = false;
    assert_mode(MODE_OFFSET_CAL, run(MODES_CALIBRATION_TIMEOUT_STEPS - 10));
    in.offsets_done = true;
    assert_mode(MODE_READY, step());
}

/* The wheel turns too fast for a zero current: the stored offsets serve, as a warning. */
static void start_with_stored_offsets(void)
{
    start_in(MODE_OFFSET_CAL);
    in.offsets_done = false;
    in.emf_conducts = true;
    in.enable = true;
    in.bridge = BRIDGE_OFF;
    assert_mode(MODE_OFFSET_CAL, run(config.modes.offset_wait_ms - 1));
    assert_mode(MODE_READY, step());
    assert_mode(MODE_RUN, step());
    assert_mode(MODE_LIMP, step());
}

void test_start_above_the_emf_limit_runs_with_stored_offsets_and_a_warning(void)
{
    start_with_stored_offsets();
    in.bridge = BRIDGE_PWM;
    const modes_output_t out = run(1000);
    assert_mode(MODE_LIMP, out);
    TEST_ASSERT_EQUAL_INT(REASON_OFFSETS_STORED, out.torque_enable.reason);
    TEST_ASSERT_EQUAL_INT16(Q15_ONE, out.torque_enable.brake_q15);
    TEST_ASSERT_FALSE(out.calibrate_offsets);
}

void test_stored_offsets_are_replaced_when_the_wheel_coasts_below_the_emf_limit(void)
{
    start_with_stored_offsets();
    in.emf_conducts = false;
    in.bridge = BRIDGE_PWM;
    TEST_ASSERT_FALSE(step().calibrate_offsets);
    in.bridge = BRIDGE_OFF;
    TEST_ASSERT_TRUE(step().calibrate_offsets);
    in.offsets_done = true;
    (void)step();
    assert_mode(MODE_RUN, step());
    TEST_ASSERT_FALSE(step().calibrate_offsets);
}

void test_without_a_battery_no_torque_is_enabled_and_the_mode_returns_by_itself(void)
{
    start_in(MODE_RUN);
    in.enable = true;
    in.warning = FINDING_BATTERY_LEFT;
    const modes_output_t out = step();
    assert_mode(MODE_LIMP, out);
    TEST_ASSERT_FALSE(torque_enable_any(out.torque_enable));
    TEST_ASSERT_EQUAL_INT(REASON_BATTERY_DISCONNECTED, out.torque_enable.reason);
    in.warning = FINDING_COUNT;
    assert_mode(MODE_RUN, step());
    TEST_ASSERT_TRUE(torque_enable_any(step().torque_enable));
}

static void lose_the_battery(int milliseconds)
{
    in.warning = FINDING_BATTERY_LEFT;
    (void)run(milliseconds);
    in.warning = FINDING_COUNT;
}

/* Milliseconds from the end of the finding until the whole braking torque is enabled again;
 * meanwhile the driving torque is whole, and the reason is that of the finding. */
static int braking_returns_ms(void)
{
    torque_enable_t out = step().torque_enable;
    while (out.drive_q15 == 0) {
        out = step().torque_enable;
    }
    int milliseconds = 1;
    int32_t before_q15 = 0;
    for (; out.brake_q15 < Q15_ONE; out = step().torque_enable) {
        TEST_ASSERT_EQUAL_INT16(Q15_ONE, out.drive_q15);
        TEST_ASSERT_EQUAL_INT(REASON_BATTERY_DISCONNECTED, out.reason);
        TEST_ASSERT_TRUE(out.brake_q15 > before_q15);
        before_q15 = out.brake_q15;
        milliseconds++;
    }
    TEST_ASSERT_EQUAL_INT(REASON_NONE, step().torque_enable.reason);
    return milliseconds;
}

/* In 2^11 ms, and the next time twice as slowly. */
void test_braking_torque_that_a_finding_took_away_comes_back_slowly(void)
{
    start_in(MODE_RUN);
    in.enable = true;
    lose_the_battery(10);
    TEST_ASSERT_EQUAL_INT(2048, braking_returns_ms());
    lose_the_battery(1);
    TEST_ASSERT_EQUAL_INT(4096, braking_returns_ms());
}

void test_braking_torque_comes_back_at_once_where_there_is_no_other_brake(void)
{
    start_in(MODE_RUN);
    in.enable = true;
    config.driver.no_other_brake = 1;
    lose_the_battery(10);
    TEST_ASSERT_EQUAL_INT(1, braking_returns_ms());
}

void test_the_end_of_a_fault_leaves_the_whole_braking_torque(void)
{
    start_in(MODE_FAULT);
    in.fault = REASON_NONE;
    in.enable = false;
    in.fault_reset = true;
    (void)run(2000);
    in.enable = true;
    const modes_output_t out = run(2);
    assert_mode(MODE_RUN, out);
    TEST_ASSERT_EQUAL_INT16(Q15_ONE, out.torque_enable.brake_q15);
}

/* The first millisecond, in which the monitor has no name for it yet. */
void test_lost_battery_without_a_name_is_shown_as_torque_enable(void)
{
    start_in(MODE_RUN);
    in.enable = true;
    in.warning = FINDING_BATTERY_UNKNOWN;
    const modes_output_t out = step();
    assert_mode(MODE_RUN, out);
    TEST_ASSERT_FALSE(torque_enable_any(out.torque_enable));
    TEST_ASSERT_EQUAL_INT(REASON_TORQUE_ENABLE, out.torque_enable.reason);
}

/* ---- lost demand ---- */

void test_demand_lost_in_run_latches_a_warning_and_leaves_the_torque_enable(void)
{
    start_in(MODE_RUN);
    in.demand_lost = true;
    modes_output_t out = step();
    assert_mode(MODE_RUN, out);
    TEST_ASSERT_EQUAL_INT(REASON_DEMAND_TIMEOUT, out.warning);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, out.fault);
    TEST_ASSERT_EQUAL_INT16(Q15_ONE, out.torque_enable.drive_q15);
    TEST_ASSERT_EQUAL_INT16(Q15_ONE, out.torque_enable.brake_q15);
    in.demand_lost = false;
    TEST_ASSERT_EQUAL_INT(REASON_DEMAND_TIMEOUT, run(100000).warning);
}

void test_warning_is_acknowledged_at_rest_without_demand_once_the_demand_is_back(void)
{
    start_in(MODE_RUN);
    in.demand_lost = true;
    step();
    in.fault_reset = true; /* still lost: it comes again at once */
    TEST_ASSERT_EQUAL_INT(REASON_DEMAND_TIMEOUT, step().warning);
    in.demand_lost = false;
    TEST_ASSERT_EQUAL_INT(REASON_DEMAND_TIMEOUT, step().warning); /* not the edge */
    in.fault_reset = false;
    step();
    in.at_rest = false;
    in.fault_reset = true;
    TEST_ASSERT_EQUAL_INT(REASON_DEMAND_TIMEOUT, step().warning);
    in.fault_reset = false;
    in.at_rest = true;
    in.brake_demanded = true;
    step();
    in.fault_reset = true;
    TEST_ASSERT_EQUAL_INT(REASON_DEMAND_TIMEOUT, step().warning);
    in.fault_reset = false;
    in.brake_demanded = false;
    step();
    in.fault_reset = true;
    TEST_ASSERT_EQUAL_INT(REASON_NONE, step().warning);
}

void test_demand_that_is_not_there_before_run_is_no_warning_but_run_waits_for_it(void)
{
    start_in(MODE_READY);
    in.enable = true;
    in.demand_lost = true;
    const modes_output_t out = run(1000);
    assert_mode(MODE_READY, out);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, out.warning);
    in.demand_lost = false;
    assert_mode(MODE_RUN, step());
    in.enable = false; /* switched off: the vehicle may stop sending */
    in.bound_mrad_s = ROLLING_mrad_s;
    in.demand_lost = true;
    TEST_ASSERT_EQUAL_INT(REASON_NONE, step().warning);
}

void test_monitor_s_warning_is_shown_beneath_the_latched_one(void)
{
    start_in(MODE_RUN);
    in.warning = FINDING_ROTOR_READING;
    TEST_ASSERT_EQUAL_INT(REASON_ROTOR_UNCERTAIN, step().warning);
    in.demand_lost = true;
    TEST_ASSERT_EQUAL_INT(REASON_DEMAND_TIMEOUT, step().warning);
    in.warning = FINDING_COUNT;
    TEST_ASSERT_EQUAL_INT(REASON_DEMAND_TIMEOUT, step().warning);
}

static void assert_waits_for(waits_for_t expected)
{
    TEST_ASSERT_EQUAL_INT(expected, step().waits_for);
}

void test_on_the_way_to_driving_every_mode_names_what_it_waits_for(void)
{
    start_in(MODE_BOOT);
    assert_waits_for(WAITS_FOR_CONFIGURATION);
    start_in(MODE_SELFTEST);
    assert_waits_for(WAITS_FOR_SELFTEST);
    start_in(MODE_OFFSET_CAL);
    assert_waits_for(WAITS_FOR_OFFSETS);
    in.emf_conducts = true;
    assert_waits_for(WAITS_FOR_LOWER_SPEED);
    start_in(MODE_READY);
    in.angle_valid = false;
    in.drive_demanded = true;
    in.demand_lost = true;
    in.neutral = true;
    assert_waits_for(WAITS_FOR_ENABLE);
    in.enable = true;
    assert_waits_for(WAITS_FOR_DEMAND_LINK);
    in.demand_lost = false;
    assert_waits_for(WAITS_FOR_PEDAL_RELEASE);
    in.drive_demanded = false;
    assert_waits_for(WAITS_FOR_ROTOR_ANGLE);
    in.angle_valid = true;
    assert_waits_for(WAITS_FOR_DIRECTION);
    TEST_ASSERT_EQUAL_INT(MODE_RUN, state.mode);
    in.neutral = false;
    assert_waits_for(WAITS_FOR_NONE);
    in.warning = FINDING_BATTERY_UNKNOWN;
    assert_waits_for(WAITS_FOR_BATTERY);
}

/* READY that waits for nothing has become RUN in the same step, and the other way round. */
void test_ready_waits_for_something_exactly_as_long_as_it_stays(void)
{
    for (unsigned flags = 0; flags < 32U; flags++) {
        start_in(MODE_READY);
        in.enable = (flags & 1U) != 0;
        in.demand_lost = (flags & 2U) != 0;
        in.drive_demanded = (flags & 4U) != 0;
        in.angle_valid = (flags & 8U) != 0;
        in.bound_mrad_s = (flags & 16U) != 0 ? ROLLING_mrad_s : 0;
        const modes_output_t out = step();
        TEST_ASSERT_EQUAL(out.mode == MODE_READY, out.waits_for != WAITS_FOR_NONE);
    }
}

void test_a_fault_waits_for_rest_then_for_an_acknowledgement_or_for_its_cause(void)
{
    start_in(MODE_RUN);
    in.fault = REASON_WINDING_OVERTEMPERATURE;
    in.at_rest = false;
    assert_waits_for(WAITS_FOR_REST);
    in.at_rest = true;
    assert_waits_for(WAITS_FOR_ACKNOWLEDGEMENT);
    in.fault_reset = true;
    (void)run(MODES_ACKNOWLEDGE_STEPS + 1);
    assert_waits_for(WAITS_FOR_FAULT_CAUSE);
    in.fault = REASON_NONE;
    in.fault_reset = false;
    (void)step();
    in.fault_reset = true;
    TEST_ASSERT_EQUAL_INT(MODE_SELFTEST, step().mode);
}

/* SPDX-License-Identifier: Apache-2.0 */
/*
 * What the slow step gives to its parts and takes from them: where the road is seen, that the
 * limits of both sides are solved, what the bridge and the monitor show, the hold, and the reason
 * shown.
 */
#include <string.h>

#include "torque/closing_voltage.h"
#include "torque_rig.h"
#include "unity.h"

enum { HOLD = 30000, CREEP_mrad_s = 100 };

void setUp(void)
{
    torque_rig_reset();
}

void tearDown(void) {}

void test_every_part_begins_anew(void)
{
    torque_state_t used;
    available_ahead_state_t ahead;
    memset(&used, 0x5A, sizeof used);
    memset(&ahead, 0x5A, sizeof ahead);
    torque_init(&used, &config);
    available_ahead_init(&ahead);
    TEST_ASSERT_EQUAL_INT32(0, used.hold.torque_mNm);
    TEST_ASSERT_FALSE(used.hold.holds);
    TEST_ASSERT_EQUAL_UINT32(ahead.step, used.ahead.step);
    TEST_ASSERT_EQUAL_INT32(ahead.now.driving.torque_mNm, used.ahead.now.driving.torque_mNm);
    TEST_ASSERT_EQUAL_INT32(ahead.ahead.braking.torque_mNm, used.ahead.ahead.braking.torque_mNm);
}

/* ---- the road is seen where speed and motor torque can be trusted ---- */

static bool is_seen(void)
{
    step();
    return state.road.rolls;
}

void test_the_road_is_seen_with_healthy_sensors(void)
{
    for (int reason = 0; reason < 128; reason++) {
        in.torque_enable.reason = (reason_t)reason;
        const bool trusted = reason == REASON_NONE || reason == REASON_TORQUE_ENABLE ||
                             reason == REASON_HYDRAULIC_FEEDBACK ||
                             reason == REASON_HYDRAULIC_WEAK || reason == REASON_HYDRAULIC_DEAD ||
                             reason == REASON_HYDRAULIC_STRONG ||
                             reason == REASON_HYDRAULIC_STUCK || reason == REASON_HYDRAULIC_LATE;
        TEST_ASSERT_EQUAL_INT(trusted, is_seen());
    }
}

void test_the_road_is_seen_with_a_valid_angle_and_without_slip_only(void)
{
    TEST_ASSERT_TRUE(is_seen());
    in.angle_valid = false;
    TEST_ASSERT_FALSE(is_seen());
    in.angle_valid = true;
    TEST_ASSERT_TRUE(is_seen());
    in.abs_active = true;
    in.abs_share_percent = 100;
    TEST_ASSERT_FALSE(is_seen());
}

/* The brake system's own path: neither the command nor a report of it says anything. */
void test_a_brake_that_is_not_commanded_shows_no_road_and_is_not_read(void)
{
    in.hydraulic.age_ms = 0;
    in.hydraulic.valid = true;
    TEST_ASSERT_TRUE(is_seen());
    TEST_ASSERT_TRUE(state.blending.feedback.seen);
    in.demand_age_ms = UINT32_MAX;
    TEST_ASSERT_TRUE(is_seen()); /* the demand is kept */
    run(config.driver.lost_hold_ms + 10);
    TEST_ASSERT_FALSE(is_seen());
    const int32_t since_ms = state.blending.feedback.since_ms;
    step();
    TEST_ASSERT_EQUAL_INT32(since_ms + 1, state.blending.feedback.since_ms);
}

/* Uphill without a motor: what slows the wheel down is the road, less what the hydraulic brake
 * makes of it; filtered with 64 ms. */
void test_the_road_is_what_slows_the_wheel_down_beside_the_brakes(void)
{
    in.hydraulic.valid = true;
    in.hydraulic.torque_mNm = 2000; /* of a brake that drags a little */
    for (int n = 0; n < 600; n++) {
        in.hydraulic.age_ms = 0;
        in.speed_mrad_s = 60000 - 2 * n; /* 2 rad/s^2 */
        step();
    }
    TEST_ASSERT_INT32_WITHIN(state.road.inertia_g_m2 / 50, 2 * state.road.inertia_g_m2 - 2000,
                             -state.road.torque_mNm);
}

/* The reason of the hydraulic command: what is found of the brake, before what its limit is. */
void test_what_is_found_of_the_hydraulic_brake_is_the_reason_of_its_command(void)
{
    in.brake_torque_mNm = 1000000;
    TEST_ASSERT_EQUAL_INT(REASON_HYDRAULIC_LIMIT, step().hydraulic_reason);
    in.hydraulic.valid = true;
    for (int n = 0; n < 900; n++) {
        in.hydraulic.age_ms = 0;
        step();
    }
    TEST_ASSERT_EQUAL_INT(REASON_HYDRAULIC_WEAK, step().hydraulic_reason);
    in.hydraulic.age_ms = 1000;
    run(config.brake.hydraulic_timeout_ms + 1002);
    TEST_ASSERT_EQUAL_INT(REASON_HYDRAULIC_FEEDBACK, step().hydraulic_reason);
}

/* ---- what bridge, angle and battery show ---- */

/* 50 A by the model of the diodes; 40 A of phase current, 34.64 A into the bus, where they conduct
 * in pulses. */
void test_pwm_that_takes_over_from_charging_diodes_has_the_voltage_without_their_current(void)
{
    enum { SEEN_mV = 20000, MODELLED_mA = 50000, MEASURED_mA = 34641 };
    in.phase_voltage_mV = SEEN_mV;
    in.bridge = BRIDGE_OFF;
    in.safe.freewheel.charging_mA = MODELLED_mA;
    const int32_t by_model_mV =
        closing_voltage_mV(&config, SEEN_mV, in.bus_voltage_mV, MODELLED_mA);
    TEST_ASSERT_LESS_THAN_INT32(SEEN_mV, by_model_mV);
    in.current.d_mA = -60000;
    in.current.q_mA = -80000;
    TEST_ASSERT_EQUAL_INT32(by_model_mV, torque_case_step().phase_voltage_mV);
    in.current.d_mA = 24000;
    in.current.q_mA = -32000;
    TEST_ASSERT_INT32_WITHIN(1,
                             closing_voltage_mV(&config, SEEN_mV, in.bus_voltage_mV, MEASURED_mA),
                             torque_case_step().phase_voltage_mV);
    in.bridge = BRIDGE_PWM; /* has taken over */
    TEST_ASSERT_EQUAL_INT32(SEEN_mV, torque_case_step().phase_voltage_mV);
    in.bridge = BRIDGE_OFF;
    in.safe.bridge = BRIDGE_SHORT; /* in which no diode charges */
    TEST_ASSERT_EQUAL_INT32(SEEN_mV, torque_case_step().phase_voltage_mV);
    in.safe.bridge = BRIDGE_OFF;
    in.torque_enable.drive_q15 = in.torque_enable.brake_q15 = 0; /* will not take over */
    TEST_ASSERT_EQUAL_INT32(SEEN_mV, torque_case_step().phase_voltage_mV);
    in.torque_enable = FULL_ENABLE;
    in.safe.freewheel.charging_mA = 0;
    TEST_ASSERT_EQUAL_INT32(SEEN_mV, torque_case_step().phase_voltage_mV);
}

/* A full battery takes no current, whatever the sensor of the bus shows. */
void test_the_battery_s_own_voltage_counts_where_it_contradicts_the_bus_sensor(void)
{
    static const finding_t ROWS[] = {FINDING_BUS_CONTRADICTED, FINDING_FLUX_HIGH, FINDING_FLUX_LOW};
    for (int k = 0; k < 3; k++) {
        torque_rig_reset();
        in.battery_voltage_mV = config.battery.max_voltage_mV;
        in.brake_torque_mNm = 30000;
        findings_set(&findings, ROWS[k], true);
        TEST_ASSERT_TRUE(findings_present(&findings, ROWS[k]));
        TEST_ASSERT_EQUAL_INT(k < 2 ? REASON_BUS_VOLTAGE_HIGH : REASON_MAX_TORQUE,
                              run(4000).available.reason);
    }
}

/* There is no torque that could ramp out of an open bridge, or without any angle. */
void test_after_an_open_bridge_or_without_any_angle_the_torque_begins_at_zero(void)
{
    const int32_t rate_mNm = demand_rate_mNm_per_step(&config);
    in.drive_torque_mNm = 30000;
    TEST_ASSERT_EQUAL_INT32(30000, run(200).command_mNm);
    in.sensor_wrong = true;
    in.angle_by = ANGLE_BY_OBSERVER;
    TEST_ASSERT_EQUAL_INT32(30000, step().command_mNm);
    in.angle_by = ANGLE_BY_SENSOR;
    TEST_ASSERT_EQUAL_INT32(rate_mNm, step().command_mNm);
    in.sensor_wrong = false;
    TEST_ASSERT_EQUAL_INT32(30000, run(200).command_mNm);
    in.bridge = BRIDGE_OFF;
    TEST_ASSERT_EQUAL_INT32(rate_mNm, step().command_mNm);
}

/* The iron loss of 1.4 N m is more than an eighth of the 8 N m: it shows that the motor brakes. */
void test_a_shorted_motor_brakes_with_the_torque_of_its_model_while_the_angle_is_valid(void)
{
    static const bridge_mode_t BRIDGES[] = {BRIDGE_SHORT, BRIDGE_SHORT_HIGH, BRIDGE_OFF};
    const torque_enable_t none = {.reason = REASON_OVERSPEED};
    in.brake_torque_mNm = 30000;
    in.torque_enable = none;
    in.safe.torque_mNm = 8000;
    for (int k = 0; k < 6; k++) {
        in.bridge = BRIDGES[k % 3];
        in.angle_valid = k < 3;
        TEST_ASSERT_EQUAL_INT32(k < 2 ? 30000 - 8000 : 30000, torque_case_step().hydraulic_mNm);
    }
}

/* ---- limits of both sides ---- */

/* The current's circle bounds both sides, by less the more iron loss the speed makes; and it rises
 * in each step. */
static void assert_both_sides_follow_the_speed(void)
{
    const limit_t *const driving = &state.table.driving[TORQUE_LINE_PHASE_CURRENT];
    const limit_t *const braking = &state.table.braking[TORQUE_LINE_PHASE_CURRENT];
    for (int n = 0; n < 8; n++) {
        const int32_t driving_mNm = driving->torque_mNm;
        const int32_t braking_mNm = braking->torque_mNm;
        in.speed_mrad_s += in.speed_mrad_s > 0 ? 100 : -100;
        step();
        TEST_ASSERT_LESS_THAN_INT32(driving_mNm, driving->torque_mNm);
        TEST_ASSERT_GREATER_THAN_INT32(braking_mNm, braking->torque_mNm);
    }
}

void test_the_limits_of_both_sides_are_of_this_step_whatever_is_demanded(void)
{
    config.motor.max_phase_current_mA = 20000; /* less than the largest torque takes */
    torque_rig_start();
    step();
    assert_both_sides_follow_the_speed();
    in.drive_torque_mNm = 1;
    assert_both_sides_follow_the_speed();
    in.drive_torque_mNm = -1; /* lift-off braking */
    assert_both_sides_follow_the_speed();
    in.drive_torque_mNm = 0;
    in.brake_torque_mNm = 1;
    assert_both_sides_follow_the_speed();
    in.brake_torque_mNm = 0;
    in.drive_torque_mNm = 1000;
    in.speed_mrad_s = -in.speed_mrad_s; /* rolls back */
    step();
    assert_both_sides_follow_the_speed();
}

/* ---- the hold ---- */

static void stand_still(void)
{
    config.driver.hold_torque_mNm = HOLD;
    in.speed_mrad_s = 0;
    in.standstill = true;
}

void test_the_hold_counts_for_braking_and_lift_off_at_standstill(void)
{
    stand_still();
    in.brake_torque_mNm = 10000;
    torque_output_t out = step();
    TEST_ASSERT_EQUAL_INT32(HOLD, out.hydraulic_mNm);
    TEST_ASSERT_EQUAL_INT(REASON_HILL_HOLD, out.hydraulic_reason);
    TEST_ASSERT_EQUAL_INT32(HOLD - 10000, out.hydraulic_added_mNm);
    in.brake_torque_mNm = HOLD; /* no more than is demanded */
    out = step();
    TEST_ASSERT_EQUAL_INT32(HOLD, out.hydraulic_mNm);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, out.hydraulic_reason);
    torque_rig_reset();
    stand_still();
    in.drive_torque_mNm = -5000;
    TEST_ASSERT_EQUAL_INT32(HOLD, step().hydraulic_mNm);
}

/* Uphill, a stop by less than the slope pulls with. What the hold makes more than the brake is
 * asked for is the driver's demand, until the wheel stands. */
void test_a_hold_before_standstill_is_part_of_the_demand(void)
{
    config.driver.hold_torque_mNm = HOLD;
    in.brake_torque_mNm = 10000;
    in.speed_mrad_s = 6000;
    bool begun = false;
    while (in.speed_mrad_s > 12) {
        in.speed_mrad_s -= 12;
        const torque_output_t out = step();
        begun = begun || out.hydraulic_reason == REASON_HILL_HOLD;
        TEST_ASSERT_EQUAL_INT32(0, out.hydraulic_apart_mNm);
        TEST_ASSERT_TRUE(!begun || out.hydraulic_added_mNm > 0);
    }
    TEST_ASSERT_TRUE(begun);
    stand_still();
    const torque_output_t out = step();
    TEST_ASSERT_EQUAL_INT32(HOLD, out.hydraulic_mNm);
    TEST_ASSERT_EQUAL_INT32(out.hydraulic_added_mNm, out.hydraulic_apart_mNm);
}

/* While the controller starts, no edge of a hall sensor shows yet that the wheel turns. */
void test_no_hold_begins_before_a_turning_wheel_has_shown_its_speed(void)
{
    stand_still();
    in.brake_torque_mNm = 10000;
    in.starts = true;
    TEST_ASSERT_EQUAL_INT32(10000, run(50).hydraulic_mNm);
    in.speed_mrad_s = 40000;
    in.standstill = false;
    in.starts = false;
    in.brake_torque_mNm = 0;
    TEST_ASSERT_EQUAL_INT32(0, run(5000).hydraulic_mNm);
    TEST_ASSERT_FALSE(findings_present(&findings, FINDING_HOLD_FAILS));
    in.brake_torque_mNm = 10000;
    in.speed_mrad_s = 0;
    in.standstill = true;
    TEST_ASSERT_EQUAL_INT32(HOLD, step().hydraulic_mNm);
}

/* The driver holds the pedal with less or more than the hold, and the link is lost: the command
 * stays, and stays valid, until the wheel turns. */
void test_a_lost_demand_leaves_a_held_vehicle_with_the_larger_of_hold_and_pedal(void)
{
    for (int32_t pedal_mNm = 10000; pedal_mNm <= 3 * HOLD; pedal_mNm += 10000) {
        torque_rig_reset();
        stand_still();
        in.brake_torque_mNm = pedal_mNm;
        step();
        in.demand_age_ms = UINT32_MAX;
        const int32_t hold_mNm = pedal_mNm > HOLD ? pedal_mNm : HOLD;
        for (int ms = 0; ms < 5000; ms++) {
            const torque_output_t out = step();
            TEST_ASSERT_TRUE(out.hydraulic_valid);
            TEST_ASSERT_EQUAL_INT32(hold_mNm, out.hydraulic_mNm);
        }
        in.speed_mrad_s = config.monitor.standstill_mrad_s + 1;
        in.standstill = false;
        run(HILL_HOLD_CAUGHT_ms - 1);
        TEST_ASSERT_TRUE(state.hold.rolls_ms < HILL_HOLD_CAUGHT_ms);
        TEST_ASSERT_FALSE(findings_present(&findings, FINDING_HOLD_FAILS));
        const torque_output_t rolls = step(); /* the driver's own pedal helps */
        TEST_ASSERT_FALSE(rolls.hydraulic_valid);
        TEST_ASSERT_TRUE(findings_present(&findings, FINDING_HOLD_FAILS));
    }
}

void test_a_demand_that_is_lost_without_a_hold_is_handed_over_as_ever(void)
{
    stand_still();
    config.driver.hold_torque_mNm = 0;
    in.brake_torque_mNm = 10000;
    step();
    in.demand_age_ms = UINT32_MAX;
    TEST_ASSERT_FALSE(run(config.driver.lost_hold_ms + 1).hydraulic_valid);
}

/* Another controller, which has no demand yet. */
static void restart(hill_hold_kept_t kept)
{
    torque_rig_start();
    torque_start_hold(&state, kept);
    in.brake_torque_mNm = 0;
    in.demand_age_ms = UINT32_MAX;
    in.torque_enable.drive_q15 = 0;
}

void test_a_hold_goes_on_after_a_restart_without_a_demand_in_its_direction(void)
{
    static const drive_direction_t DIRECTIONS[] = {DRIVE_DIRECTION_FORWARD,
                                                   DRIVE_DIRECTION_REVERSE};
    for (int k = 0; k < 2; k++) {
        torque_rig_reset();
        stand_still();
        in.direction = DIRECTIONS[k];
        in.brake_torque_mNm = 10000;
        step();
        const hill_hold_kept_t kept = torque_hold(&state);
        TEST_ASSERT_EQUAL_INT(DIRECTIONS[k], kept.direction);
        restart(kept);
        torque_output_t out = step();
        TEST_ASSERT_EQUAL_INT32(HOLD, out.hydraulic_mNm);
        TEST_ASSERT_TRUE(out.hydraulic_valid);
        TEST_ASSERT_EQUAL_INT(DIRECTIONS[k], out.engaged);
        in.demand_age_ms = 0;
        out = step();
        TEST_ASSERT_EQUAL_INT32(HOLD, out.hydraulic_mNm);
        in.direction = DRIVE_DIRECTION_NEUTRAL;
        TEST_ASSERT_LESS_THAN_INT32(HOLD, step().hydraulic_mNm);
    }
    torque_rig_reset();
    stand_still();
    restart(torque_hold(&state));
    TEST_ASSERT_EQUAL_INT32(0, step().hydraulic_mNm);
}

/* An encoder counts before its index comes: a roll back is one whatever angle is in use. */
void test_a_hold_is_not_resumed_on_a_wheel_whose_encoder_turns_without_an_angle(void)
{
    for (int32_t sign = -1; sign <= 1; sign += 2) {
        torque_rig_reset();
        stand_still();
        const hill_hold_kept_t kept = {.direction = DRIVE_DIRECTION_FORWARD};
        restart(kept);
        in.angle_valid = false;
        in.sensor_mrad_s = sign * config.driver.direction_change_mrad_s;
        TEST_ASSERT_EQUAL_INT32(HOLD, step().hydraulic_mNm);
        in.sensor_mrad_s += sign;
        TEST_ASSERT_EQUAL_INT32(0, step().hydraulic_mNm);
        TEST_ASSERT_TRUE(findings_present(&findings, FINDING_HOLD_FAILS));
    }
}

void test_a_motor_whose_driving_torque_is_not_enabled_releases_no_hold(void)
{
    stand_still();
    in.brake_torque_mNm = 10000;
    step();
    in.brake_torque_mNm = 0;
    in.drive_torque_mNm = 20000;
    in.torque_enable.drive_q15 = 0;
    TEST_ASSERT_EQUAL_INT32(HOLD, run(2 * config.driver.hold_release_ms).hydraulic_mNm);
    in.torque_enable.drive_q15 = 1;
    TEST_ASSERT_LESS_THAN_INT32(HOLD, run(10).hydraulic_mNm);
}

void test_the_hydraulic_brake_has_what_the_blend_out_takes_of_lift_off_braking(void)
{
    in.speed_mrad_s = CREEP_mrad_s;
    in.drive_torque_mNm = -5000;
    TEST_ASSERT_EQUAL_INT32(5000, step().hydraulic_mNm);
}

/* The hydraulic brake fills up what the motor's optimum leaves of 60 N m: of lift-off braking it
 * takes over none. */
void test_lift_off_braking_stays_with_the_motor_while_the_hydraulic_brake_arrives(void)
{
    in.speed_mrad_s = mrad_s_of_rpm(60.0);
    in.brake_torque_mNm = 60000;
    const int32_t optimum_mNm = run(1000).command_mNm;
    torque_rig_reset();
    in.speed_mrad_s = mrad_s_of_rpm(60.0);
    in.brake_torque_mNm = 60000;
    in.drive_torque_mNm = -5000;
    int32_t most_mNm = 0;
    for (int n = 0; n < 1000; n++) {
        const torque_output_t out = step();
        TEST_ASSERT_LESS_OR_EQUAL_INT32(most_mNm, out.command_mNm);
        most_mNm = out.command_mNm;
    }
    TEST_ASSERT_EQUAL_INT32(optimum_mNm - 5000, most_mNm);
}

/* ---- the reason shown ---- */

void test_one_millinewton_metre_beyond_coasting_shows_its_reason(void)
{
    in.speed_mrad_s = CREEP_mrad_s;
    in.brake_torque_mNm = step().coasting_mNm + 1;
    TEST_ASSERT_EQUAL_INT(REASON_LOSS_OPTIMUM, step().reason); /* none, so slowly */
    in.brake_torque_mNm = 0;
    TEST_ASSERT_EQUAL_INT(REASON_NONE, step().reason);
}

/* The hydraulic brake's torque falls after the motor's: that is no limit of the motor any more. */
void test_released_pedals_show_no_reason_once_the_motor_coasts(void)
{
    in.brake_torque_mNm = 60000;
    run(1000);
    in.brake_torque_mNm = 0;
    int shown = 0;
    for (int n = 0; n < 500; n++) {
        const torque_output_t out = step();
        if (-out.command_mNm == out.coasting_mNm && state.blending.covered_mNm > 0) {
            shown++;
            TEST_ASSERT_EQUAL_INT(REASON_NONE, out.reason);
        }
    }
    TEST_ASSERT_GREATER_THAN_INT(10, shown);
}

/* 2 A a motor of 53 V at 15.7 rad/s: 6.7 N m and the losses. */
void test_lift_off_braking_shows_the_limit_that_bounds_it(void)
{
    in.drive_torque_mNm = -30000;
    in.bms_charge_current_mA = 8000;
    const torque_output_t out = run(300);
    TEST_ASSERT_GREATER_THAN_INT32(-20000, out.command_mNm);
    TEST_ASSERT_LESS_THAN_INT32(-5000, out.command_mNm);
    TEST_ASSERT_EQUAL_INT(REASON_CHARGE_CURRENT, out.reason);
}

/* The limit of the setpoint alone; the table's is that of the start. */
void test_phase_current_comes_before_the_torque_rate_and_after_other_limits(void)
{
    in.drive_torque_mNm = 30000;
    run(300);
    config.motor.max_phase_current_mA = 5000;
    TEST_ASSERT_EQUAL_INT(REASON_PHASE_CURRENT, step().reason);
    in.drive_torque_mNm = 35000;
    TEST_ASSERT_EQUAL_INT(REASON_PHASE_CURRENT, step().reason);
    in.winding_temperature_cC = config.motor.max_winding_temperature_cC - 1000;
    TEST_ASSERT_EQUAL_INT(REASON_WINDING_TEMPERATURE, run(300).reason);
}

/* ---- estimate and look ahead ---- */

/* More than 32.768 N m: one of 32 768 parts of the flux is a millinewton-metre. */
void test_the_estimate_lacks_the_missing_flux_s_part(void)
{
    in.drive_torque_mNm = 38000;
    run(300);
    int32_t estimates_mNm[3];
    for (int k = 0; k < 3; k++) {
        in.flux_missing_q15 = k - 1;
        estimates_mNm[k] = torque_case_step().estimate_mNm;
    }
    TEST_ASSERT_GREATER_THAN_INT32(32768, estimates_mNm[1]);
    TEST_ASSERT_EQUAL_INT32(estimates_mNm[1], estimates_mNm[0]);
    TEST_ASSERT_EQUAL_INT32(estimates_mNm[1] - 1, estimates_mNm[2]);
}

void test_looking_ahead_goes_on_with_every_step(void)
{
    step();
    const uint32_t before = state.ahead.step;
    step();
    TEST_ASSERT_NOT_EQUAL_UINT32(before, state.ahead.step);
}

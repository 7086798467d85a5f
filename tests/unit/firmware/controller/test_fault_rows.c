/* SPDX-License-Identifier: Apache-2.0 */
/* Every row of the list of faults (core/reason.h), brought about in the whole controller: torque,
 * bridge, mode and acknowledgement are what its reaction and its clearing say. */
#include "controller_rig.h"
#include "core/fault.h"
#include "fault_rows.h"
#include "unity.h"

enum { LONG_ms = 3000, LATCHED_ms = 2500, LOST_ms = 100000 };
static rig_t rig;
static slow_output_t healthy;

/* Braking with 20 N m at 300 r/min, in RUN. */
static void brake(void)
{
    rig_start_running(&rig);
    rig.follows = true;
    rig_set_speed_rpm(&rig, 300.0);
    rig_run(&rig, 300);
    rig.slow_in.demand.brake_torque_mNm = 20000;
    rig_run(&rig, 200);
    TEST_ASSERT_EQUAL_INT(MODE_RUN, rig.out.mode);
    TEST_ASSERT_EQUAL_INT(BRIDGE_PWM, rig.pwm.bridge);
    TEST_ASSERT_LESS_THAN_INT32(-10000, rig.out.motor_torque_command_mNm);
    healthy = rig.out;
}

void setUp(void)
{
    brake();
}

void tearDown(void) {}

/* ---- what a row is brought about by ---- */

/* In the next slow step: a trip in its report, or what is withdrawn from it. */
static void put_fault(reason_t reason)
{
    rig.slow_in.config_accepted = reason != REASON_CONFIG_INVALID;
    rig.slow_in.selftest_passed = reason != REASON_SELFTEST_FAILED;
    const bool withdrawn = !rig.slow_in.config_accepted || !rig.slow_in.selftest_passed;
    rig.to_slow.trip = withdrawn ? REASON_NONE : reason;
    rig_slow(&rig);
}

/* A start on a wheel whose EMF drives a current, as with three times the flux; then as brake(). */
static void brake_with_stored_offsets(void)
{
    rig_start(&rig);
    rig.follows = true;
    rig_set_speed_rpm(&rig, 300.0);
    const int32_t flux_nWb = rig.config.motor.flux_linkage_nWb;
    rig.config.motor.flux_linkage_nWb = 3 * flux_nWb;
    rig_run(&rig, 100 + rig.config.modes.offset_wait_ms);
    rig.slow_in.demand.enable = true;
    rig_run(&rig, 2);
    rig.config.motor.flux_linkage_nWb = flux_nWb;
    rig_run(&rig, 300);
    rig.slow_in.demand.brake_torque_mNm = 20000;
    rig_run(&rig, 200);
}

static void run_with_warning(reason_t reason, int milliseconds)
{
    static uint16_t rotor_faults;
    if (reason == REASON_ROTOR_UNCERTAIN) {
        rig.config.monitor.rotor_warning_time_ms = 3;
    } else if (reason == REASON_HYDRAULIC_FEEDBACK) { /* there has been a report once */
        rig.config.brake.hydraulic_timeout_ms = 5;
        rig.slow_in.hydraulic.valid = true;
        rig.slow_in.hydraulic.age_ms = 0;
    } else if (reason == REASON_OFFSETS_STORED) {
        brake_with_stored_offsets();
    } else { /* any code of a fault may come with the demand */
        TEST_ASSERT_GREATER_OR_EQUAL_INT(REASON_FIRST_FAULT, reason);
        rig.slow_in.demand.reason = reason;
    }
    for (int n = 0; n < milliseconds; n++) {
        for (int k = 0; k < RIG_FAST_PER_SLOW; k++) {
            rig_fast(&rig);
        }
        if (reason == REASON_ROTOR_UNCERTAIN) {
            rig.to_slow.rotor_faults = ++rotor_faults;
        }
        rig_slow(&rig);
        rig.slow_in.hydraulic.age_ms++;
    }
    rig.slow_in.demand.reason = REASON_NONE;
}

/* Until nothing of the warning is left. */
static void run_without_warning(reason_t reason)
{
    if (reason == REASON_HYDRAULIC_FEEDBACK) {
        for (int ms = 0; ms < HYDRAULIC_FEEDBACK_HEAL_ms; ms++) {
            rig.slow_in.hydraulic.age_ms = 0;
            rig_run(&rig, 1);
        }
    } else if (reason ==
               REASON_OFFSETS_STORED) { /* they are measured as soon as the wheel coasts */
        rig.config.modes.coast_delay_ms = 1;
        rig.slow_in.demand.brake_torque_mNm = 0;
        rig_run(&rig, 500);
        rig.slow_in.demand.brake_torque_mNm = 20000;
    }
    rig_run(&rig, 20);
}

/* ---- what there is after it ---- */

static void assert_no_torque(const fault_t *row)
{
    const char *name = reason_name(row->reason);
    TEST_ASSERT_EQUAL_INT32_MESSAGE(0, rig.out.motor_torque_command_mNm, name);
    TEST_ASSERT_EQUAL_INT32_MESSAGE(0, rig.out.electric_brake_available_mNm, name);
    TEST_ASSERT_EQUAL_INT32_MESSAGE(20000, rig.out.hydraulic_torque_mNm, name);
    TEST_ASSERT_FALSE_MESSAGE(rig.to_fast.torque_enabled, name);
}

static void assert_whole_brake(const fault_t *row)
{
    const char *name = reason_name(row->reason);
    TEST_ASSERT_EQUAL_INT_MESSAGE(REASON_NONE, rig.out.fault_reason, name);
    TEST_ASSERT_EQUAL_INT_MESSAGE(row->reason, rig.out.warning_reason, name);
    TEST_ASSERT_EQUAL_INT_MESSAGE(row->reason, rig.out.present_warning, name);
    TEST_ASSERT_EQUAL_INT_MESSAGE(BRIDGE_PWM, rig.pwm.bridge, name);
    TEST_ASSERT_INT32_WITHIN_MESSAGE(20, healthy.motor_torque_command_mNm,
                                     rig.out.motor_torque_command_mNm, name);
    TEST_ASSERT_INT32_WITHIN_MESSAGE(20, healthy.electric_brake_available_mNm,
                                     rig.out.electric_brake_available_mNm, name);
}

/* LIMP: the configured share of the driving torque. */
static void assert_less_drive(const fault_t *row)
{
    const char *name = reason_name(row->reason);
    const int64_t share_q15 = rig.config.modes.limp_drive_share_q15;
    TEST_ASSERT_EQUAL_INT_MESSAGE(MODE_LIMP, rig.out.mode, name);
    TEST_ASSERT_GREATER_THAN_INT32_MESSAGE(0, rig.out.drive_available_mNm, name);
    TEST_ASSERT_LESS_OR_EQUAL_INT32_MESSAGE(
        (int32_t)(share_q15 * rig.config.motor.max_torque_mNm / 32768) + 1,
        rig.out.drive_available_mNm, name);
    TEST_ASSERT_LESS_THAN_INT32_MESSAGE(healthy.drive_available_mNm, rig.out.drive_available_mNm,
                                        name);
}

static void assert_healed(const fault_t *row)
{
    const char *name = reason_name(row->reason);
    TEST_ASSERT_EQUAL_INT_MESSAGE(MODE_RUN, rig.out.mode, name);
    TEST_ASSERT_EQUAL_INT_MESSAGE(REASON_NONE, rig.out.fault_reason, name);
    TEST_ASSERT_EQUAL_INT_MESSAGE(REASON_NONE, rig.out.present_warning, name);
    rig_fast(&rig);
    TEST_ASSERT_EQUAL_INT_MESSAGE(BRIDGE_PWM, rig.pwm.bridge, name);
}

/* ---- reactions ---- */

static void check_none(const fault_t *row)
{
    run_with_warning(row->reason, 20);
    assert_whole_brake(row);
    TEST_ASSERT_EQUAL_INT(MODE_RUN, rig.out.mode);
    TEST_ASSERT_INT32_WITHIN(20, healthy.drive_available_mNm, rig.out.drive_available_mNm);
    run_without_warning(row->reason);
    assert_healed(row);
}

static void check_limit(const fault_t *row)
{
    run_with_warning(row->reason, 20);
    assert_whole_brake(row);
    assert_less_drive(row);
    run_without_warning(row->reason);
    assert_healed(row);
}

/* The bus sensor against the battery's message, then by a jump that no bus makes. */
static void check_limit_or_off(const fault_t *row)
{
    TEST_ASSERT_EQUAL_INT(REASON_BUS_SENSOR, row->reason);
    rig.slow_in.bms.voltage_mV = 44000;
    rig_run(&rig, 1000);
    TEST_ASSERT_EQUAL_INT(REASON_BUS_SENSOR, rig.out.warning_reason);
    TEST_ASSERT_EQUAL_INT(BRIDGE_PWM, rig.pwm.bridge);
    TEST_ASSERT_LESS_THAN_INT32(-10000, rig.out.motor_torque_command_mNm);
    assert_less_drive(row);
    rig.slow_in.bms.voltage_mV = 53000;
    rig_run(&rig, 1000);
    assert_healed(row);

    rig.fast_in.bus_voltage_code = rig_bus_code(&rig, 62.0);
    rig_fast(&rig);
    TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, rig.pwm.bridge);
    rig_slow(&rig);
    TEST_ASSERT_EQUAL_INT(REASON_BUS_SENSOR, rig.out.warning_reason);
    TEST_ASSERT_EQUAL_INT(MODE_LIMP, rig.out.mode);
    assert_no_torque(row);
    rig.fast_in.bus_voltage_code = rig_bus_code(&rig, 53.0);
    rig_run(&rig, 300);
    assert_healed(row);
}

static void show_no_current(void)
{
    uint16_t *const code = rig.fast_in.phase_current_code;
    rig.follows = false;
    code[0] = code[1] = code[2] = 2048;
}

/* Far beyond the speed at which a current holds the voltage. */
static void check_least(const fault_t *row)
{
    rig.slow_in.demand.brake_torque_mNm = 0;
    rig_run(&rig, 500);
    rig.config.rotor.observer_takeover = 0;
    rig_set_speed_rpm(&rig, 2.5 * rig.config.motor.max_speed_mrad_s * 60e-3 / 6.2832);
    show_no_current();
    rig_run(&rig, 100);
    TEST_ASSERT_EQUAL_INT(row->reason, rig.out.warning_reason);
    TEST_ASSERT_EQUAL_INT(MODE_LIMP, rig.out.mode); /* no fault */
    TEST_ASSERT_EQUAL_INT(rig.to_fast.safe_bridge, rig.pwm.bridge);
    rig_set_speed_rpm(&rig, 300.0);
    rig_run(&rig, LONG_ms);
    assert_healed(row);
}

static void check_hand_over(const fault_t *row)
{
    rig.slow_in.demand_age_ms = LOST_ms;
    rig_run(&rig, 1);
    TEST_ASSERT_EQUAL_INT(row->reason, rig.out.warning_reason);
    TEST_ASSERT_INT32_WITHIN(200, healthy.motor_torque_command_mNm,
                             rig.out.motor_torque_command_mNm);
    int32_t before_mNm = rig.out.motor_torque_command_mNm;
    for (int ms = 0; ms < LONG_ms; ms++) {
        rig_run(&rig, 1);
        TEST_ASSERT_EQUAL_INT(MODE_RUN, rig.out.mode);
        TEST_ASSERT_EQUAL_INT(BRIDGE_PWM, rig.pwm.bridge);
        TEST_ASSERT_LESS_OR_EQUAL_INT32(before_mNm + rig.config.brake.torque_rate_mNm_s / 1000,
                                        rig.out.motor_torque_command_mNm);
        before_mNm = rig.out.motor_torque_command_mNm;
    }
    TEST_ASSERT_EQUAL_INT32(0, rig.out.motor_torque_command_mNm);
    TEST_ASSERT_FALSE(rig.out.hydraulic_valid);

    brake();
    rig.slow_in.demand.brake_torque_mNm = 0;
    rig.slow_in.demand.drive_torque_mNm = 4000;
    rig_run(&rig, 300);
    TEST_ASSERT_EQUAL_INT32(4000, rig.out.motor_torque_command_mNm);
    rig.slow_in.demand_age_ms = LOST_ms;
    rig_run(&rig, 1);
    TEST_ASSERT_EQUAL_INT32(0, rig.out.motor_torque_command_mNm);
}

/* Halls that are plugged off at standstill while the motor drives. With an observer that would take
 * over they are taken for wrong at once, without it there is a ramp. */
static void lose_rotor(const fault_t *row, bool takeover)
{
    rig_start(&rig);
    rig.config.rotor.observer_takeover = takeover ? 1 : 0;
    rig.config.rotor.sensor = CONFIG_ROTOR_HALL;
    controller_init(&rig.controller, &rig.config, BASES_MODEL_TIMER_Hz);
    rig.fast_in.hall_state = 5;
    rig.slow_in.demand.enable = true;
    rig_run(&rig, 100);
    rig.slow_in.demand.drive_torque_mNm = 4000;
    rig_run(&rig, 20);
    TEST_ASSERT_EQUAL_INT32(4000, rig.out.motor_torque_command_mNm);
    rig.fast_in.hall_state = 7;
    const int32_t step_mNm = rig.config.brake.torque_rate_mNm_s / 1000;
    int steps = 0;
    for (int ms = 0; ms < LONG_ms && rig.out.mode != MODE_FAULT; ms++) {
        const int32_t before_mNm = rig.out.motor_torque_command_mNm;
        rig_run(&rig, 1);
        const int32_t now_mNm = rig.out.motor_torque_command_mNm;
        TEST_ASSERT_TRUE(now_mNm <= before_mNm);
        TEST_ASSERT_TRUE(takeover || now_mNm >= before_mNm - step_mNm);
        steps += now_mNm < before_mNm ? 1 : 0;
        TEST_ASSERT_TRUE(rig.out.mode != MODE_FAULT || before_mNm == 0);
    }
    TEST_ASSERT_EQUAL_INT(takeover ? 1 : 4000 / step_mNm, steps);
    TEST_ASSERT_EQUAL_INT(row->reason, rig.out.fault_reason);
    rig_fast(&rig);
    TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, rig.pwm.bridge);
}

static void check_ramp(const fault_t *row)
{
    lose_rotor(row, false);
    lose_rotor(row, true);
}

/* psi/L of 81.6 A, which is admissible, and nothing may be charged: beyond the speed at which the
 * EMF reaches the bus the short circuit is the safe state. */
static void prefer_short(void)
{
    rig.config.motor.d_inductance_nH = 250000;
    rig.config.motor.q_inductance_nH = 250000;
    rig.config.motor.max_phase_current_mA = 85000;
    rig.config.drive.diode_drop_mV = 0;
    rig.slow_in.bms.charge_current_mA = 0;
    rig_set_speed_rpm(&rig, 1.2 * rig.config.motor.max_speed_mrad_s * 60e-3 / 6.2832);
    show_no_current();
}

static void bring_about(const fault_t *row)
{
    if (row->reason == REASON_BATTERY_DISCONNECTED) {
        rig.slow_in.bms.contactor = CONTACTOR_OPEN;
        rig_slow(&rig);
    } else {
        put_fault(row->reason);
    }
}

static void check_safe_state(const fault_t *row)
{
    const char *name = reason_name(row->reason);
    bring_about(row);
    assert_no_torque(row);
    rig_fast(&rig);
    TEST_ASSERT_EQUAL_INT_MESSAGE(BRIDGE_OFF, rig.pwm.bridge, name);
    rig_slow(&rig);
    TEST_ASSERT_EQUAL_INT_MESSAGE(BRIDGE_OFF, rig.to_fast.safe_bridge, name);
    if (is_latched(row)) {
        prefer_short();
        rig_run(&rig, 300);
        TEST_ASSERT_EQUAL_INT_MESSAGE(MODE_FAULT, rig.out.mode, name);
        TEST_ASSERT_EQUAL_INT_MESSAGE(BRIDGE_SHORT, rig.pwm.bridge, name);
        return;
    }
    TEST_ASSERT_EQUAL_INT_MESSAGE(MODE_LIMP, rig.out.mode, name);
    rig.slow_in.bms.contactor = CONTACTOR_CLOSED;
    rig_run(&rig, 300);
    assert_healed(row);
}

/* In the fast loop; the bridge leaves PWM before the next slow step. */
static void trip(reason_t reason)
{
    if (reason == REASON_BUS_OVERVOLTAGE) {
        rig.fast_in.bus_voltage_code = rig_bus_code(&rig, 59.8);
        rig_fast(&rig);
        rig.fast_in.bus_voltage_code = rig_bus_code(&rig, 60.7); /* trips at 60.564 V */
    } else if (reason == REASON_OVERCURRENT) {
        rig.follows = false;
        rig.fast_in.phase_current_code[0] = 2048 + 1365;
        rig.fast_in.phase_current_code[1] = 2048 - 1365;
        rig.fast_in.phase_current_code[2] = 2048;
        rig_fast(&rig);
    } else {
        rig.fast_in.power_stage_fault = true;
    }
    rig_fast(&rig);
    TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, rig.pwm.bridge);
    rig_slow(&rig);
}

static void check_trip(const fault_t *row)
{
    const char *name = reason_name(row->reason);
    trip(row->reason);
    assert_no_torque(row);
    rig_run(&rig, 2 * rig.config.monitor.battery_message_time_ms);
    TEST_ASSERT_EQUAL_INT_MESSAGE(row->reason, rig.out.fault_reason, name);
}

/* A switch that is stuck closed: half waves through the diodes of its side, 42 A at most. */
static void check_stuck_side(const fault_t *row, bridge_mode_t side)
{
    const char *name = reason_name(row->reason);
    const int sign = side == BRIDGE_SHORT_HIGH ? 1 : -1;
    brake();
    trip(row->reason);
    rig.follows = false;
    rig.fast_in.power_stage_fault = false;
    rig.fast_in.bus_voltage_code = rig_bus_code(&rig, 53.0);
    rig.fast_in.phase_current_code[0] = (uint16_t)(2048 + sign * 522);
    rig.fast_in.phase_current_code[1] = (uint16_t)(2048 - sign * 261);
    rig.fast_in.phase_current_code[2] = (uint16_t)(2048 - sign * 261);
    rig_run(&rig, 50);
    TEST_ASSERT_EQUAL_INT_MESSAGE(side, rig.pwm.bridge, name);
}

static void check_reaction(const fault_t *row)
{
    switch (row->reaction) {
    case FAULT_REACTION_NONE:
        check_none(row);
        break;
    case FAULT_REACTION_LIMIT:
        check_limit(row);
        break;
    case FAULT_REACTION_LIMIT_OR_OFF:
        check_limit_or_off(row);
        break;
    case FAULT_REACTION_LEAST:
        check_least(row);
        break;
    case FAULT_REACTION_HAND_OVER:
        check_hand_over(row);
        break;
    case FAULT_REACTION_RAMP:
        check_ramp(row);
        break;
    case FAULT_REACTION_SAFE_STATE:
        check_safe_state(row);
        break;
    case FAULT_REACTION_TRIP:
        check_trip(row);
        check_stuck_side(row, BRIDGE_SHORT);
        check_stuck_side(row, BRIDGE_SHORT_HIGH);
        break;
    }
}

void test_torque_and_bridge_of_each_row_follow_from_its_reaction(void)
{
    const fault_t *row = fault_row(0);
    unsigned rows = 0;
    for (; row != NULL; row = fault_row(++rows)) {
        brake();
        check_reaction(row);
    }
    TEST_ASSERT_GREATER_THAN_UINT(40, rows);
}

/* ---- clearing ---- */

/* A rising edge. */
static void acknowledge(void)
{
    rig.slow_in.demand.fault_reset = false;
    rig_run(&rig, 2);
    rig.slow_in.demand.fault_reset = true;
    rig_run(&rig, 3);
}

static void check_latched(const fault_t *row)
{
    const char *name = reason_name(row->reason);
    rig_start_running(&rig);
    put_fault(row->reason);
    if (row->reason == REASON_BUS_OVERVOLTAGE) { /* a warning until it is qualified */
        rig.fast_in.bus_voltage_code = rig_bus_code(&rig, 62.0);
        rig_run(&rig, rig.config.monitor.battery_message_time_ms + 10);
        rig.fast_in.bus_voltage_code = rig_bus_code(&rig, 53.0);
    }
    /* A bus beyond its trip may be an EMF; rest is known once a wheel has coasted from there. */
    rig.config.monitor.coasting_mm_s2 = rig.config.monitor.tyre_grip_mm_s2;
    rig_run(&rig, LATCHED_ms);
    TEST_ASSERT_TRUE_MESSAGE(rig.out.standstill, name);
    TEST_ASSERT_EQUAL_INT_MESSAGE(MODE_FAULT, rig.out.mode, name);
    TEST_ASSERT_EQUAL_INT_MESSAGE(row->reason, rig.out.fault_reason, name);
    rig.slow_in.demand.brake_torque_mNm = 1;
    acknowledge();
    TEST_ASSERT_EQUAL_INT_MESSAGE(MODE_FAULT, rig.out.mode, name);
    rig.slow_in.demand.brake_torque_mNm = 0;
    acknowledge();
    TEST_ASSERT_EQUAL_INT_MESSAGE(row->clearing == FAULT_CLEARING_RESTART,
                                  rig.out.mode == MODE_FAULT, name);
}

/* What node and pedals may say of a demand that is lost. */
static bool comes_with_the_demand(reason_t reason)
{
    return reason == REASON_DEMAND_TIMEOUT || reason == REASON_DEMAND_IMPLAUSIBLE ||
           reason == REASON_ACCELERATOR_SENSOR || reason == REASON_BRAKE_PEDAL_SENSOR;
}

/* By itself: what it did ends; after a lost demand it is shown until it is acknowledged. */
static void check_warning(const fault_t *row)
{
    const char *name = reason_name(row->reason);
    const bool shown = row->clearing == FAULT_CLEARING_SHOWN;
    TEST_ASSERT_EQUAL_INT_MESSAGE(comes_with_the_demand(row->reason), shown, name);
    if (!shown && (int)row->reason < (int)REASON_FIRST_FAULT) {
        return; /* not with a demand */
    }
    rig_start_running(&rig);
    rig.slow_in.demand.reason =
        shown && row->reason != REASON_DEMAND_TIMEOUT ? row->reason : REASON_NONE;
    rig.slow_in.demand_age_ms = shown ? LOST_ms : 0;
    rig_run(&rig, 10);
    rig.slow_in.demand.reason = REASON_NONE;
    rig.slow_in.demand_age_ms = 0;
    rig_run(&rig, 10);
    TEST_ASSERT_EQUAL_INT_MESSAGE(MODE_RUN, rig.out.mode, name);
    TEST_ASSERT_EQUAL_INT_MESSAGE(shown ? row->reason : REASON_NONE, rig.out.warning_reason, name);
    rig.slow_in.demand.brake_torque_mNm = 1;
    acknowledge();
    TEST_ASSERT_EQUAL_INT_MESSAGE(shown ? row->reason : REASON_NONE, rig.out.warning_reason, name);
    rig.slow_in.demand.brake_torque_mNm = 0;
    acknowledge();
    TEST_ASSERT_EQUAL_INT_MESSAGE(REASON_NONE, rig.out.warning_reason, name);
}

/* A hydraulic brake whose reports show that it does not release: while the driver brakes or drives
 * it is still to be seen, also at rest. */
void test_a_finding_of_the_hydraulic_brake_is_acknowledged_at_rest_without_a_demand_only(void)
{
    const int32_t demands_mNm[][2] = {{0, 1}, {1, 0}, {-1, 0}};
    rig_run(&rig, 1000); /* until the road is known */
    rig_report_brake(&rig, 10000);
    rig_run(&rig, 100);
    TEST_ASSERT_EQUAL_INT(REASON_HYDRAULIC_STUCK, rig.out.warning_reason);
    rig.slow_in.demand.brake_torque_mNm = 0;
    for (int rpm = 300; rpm >= 0; rpm -= 3) {
        rig_set_speed_rpm(&rig, rpm);
        rig_run(&rig, 10);
    }
    rig_run(&rig, LONG_ms);
    TEST_ASSERT_TRUE(rig.out.standstill);
    for (unsigned i = 0; i < sizeof demands_mNm / sizeof demands_mNm[0]; i++) {
        rig.slow_in.demand.drive_torque_mNm = demands_mNm[i][0];
        rig.slow_in.demand.brake_torque_mNm = demands_mNm[i][1];
        acknowledge();
        TEST_ASSERT_EQUAL_INT(REASON_HYDRAULIC_STUCK, rig.out.warning_reason);
    }
    rig.slow_in.demand.drive_torque_mNm = 0;
    rig.slow_in.demand.brake_torque_mNm = 0;
    acknowledge();
    TEST_ASSERT_EQUAL_INT(REASON_NONE, rig.out.warning_reason);
}

void test_end_of_each_row_follows_from_its_clearing(void)
{
    const fault_t *row = fault_row(0);
    for (unsigned i = 0; row != NULL; row = fault_row(++i)) {
        if (is_latched(row)) {
            check_latched(row);
        } else {
            check_warning(row);
        }
    }
}

/* SPDX-License-Identifier: Apache-2.0 */
/* Every row of the table of findings (core/findings.h), brought about in the whole controller:
 * torque, bridge and mode are what its reaction says. And the end of every fault (core/reason.h):
 * what its clearing says. */
#include "controller_rig.h"
#include "core/findings.h"
#include "fault_rows.h"
#include "unity.h"

enum { LONG_ms = 3000, LATCHED_ms = 2500, LOST_ms = 100000, HEAL_ms = 1100 };
#define LOW_BUS_V 30.0

static rig_t rig;
static slow_output_t healthy;

/* Braking with 20 N m at 300 r/min, in RUN. Findings of the rotor heal soon. */
static void brake(void)
{
    rig_start(&rig);
    rig.config.monitor.rotor_warning_time_ms = 10;
    controller_init(&rig.controller, &rig.config, BASES_MODEL_TIMER_Hz);
    rig.slow_in.demand.enable = true;
    rig_run(&rig, 100);
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

/* What node and pedals may say of a demand that is lost. */
static bool comes_with_the_demand(reason_t reason)
{
    return reason == REASON_DEMAND_TIMEOUT || reason == REASON_TRANSMIT_TIMEOUT ||
           reason == REASON_DEMAND_IMPLAUSIBLE || reason == REASON_DEMAND_CONTRADICTED ||
           reason == REASON_ACCELERATOR_SENSOR || reason == REASON_BRAKE_PEDAL_SENSOR;
}

static bool is_of_rotor(finding_t row)
{
    return row == FINDING_OBSERVER_IN_USE || row == FINDING_ROTOR_GLITCH ||
           (row >= FINDING_ROTOR_SLIPS && row <= FINDING_ROTOR_UNNAMED);
}

static bool is_of_brake(finding_t row)
{
    return row == FINDING_HOLD_FAILS || (row >= FINDING_BRAKE_DEAD && row <= FINDING_BRAKE_LATE);
}

/* Whole brake, less or all of the drive: before the first millisecond of the cause. */
static void begin_cause(finding_t row)
{
    slow_input_t *in = &rig.slow_in;
    rig.config.monitor.sensor_fault_time_ms = 5;
    rig.config.rotor.observer_takeover = is_of_rotor(row) ? 1 : 0;
    if (row == FINDING_WINDING_THERMISTOR) {
        in->temperature.winding_cC = 29999;
    } else if (row == FINDING_SWITCH_THERMISTOR) {
        in->temperature.switch_cC = 29999;
    } else if (row == FINDING_WINDING_HOT) {
        in->temperature.winding_cC = rig.config.motor.max_winding_temperature_cC + 1001;
    } else if (row == FINDING_SWITCH_HOT) {
        in->temperature.switch_cC = rig.config.drive.max_switch_temperature_cC + 1001;
    } else if (row == FINDING_BRAKE_REPORT) { /* there has been one */
        rig.config.brake.hydraulic_timeout_ms = 5;
        in->hydraulic.valid = true;
        in->hydraulic.age_ms = 0;
    } else if (is_of_brake(row)) {
        const finding_times_t at_once = {.qualify_steps = 1, .heal_steps = 1};
        rig.controller.slow.findings.times[row] = at_once;
    } else if (comes_with_the_demand(findings_row(row).reason)) {
        in->demand.reason = findings_row(row).reason;
    } else if (row == FINDING_BUS_CONTRADICTED) {
        in->bms.voltage_mV = 44000;
    } else if (row == FINDING_OFFSETS_OLD) {
        brake_with_stored_offsets();
    } else if (row == FINDING_GAIN) {
        rig.config.battery.driven_wheels = 1;
        rig.config.battery.current_filter_ms = 0;
        in->bms.current_given = true;
        in->demand.brake_torque_mNm = 0;
    }
}

/* Half a turn, and a speed; once the sensor is wrong it is the observer's that count. That is gone
 * for the moment in which an unnamed sensor would get its name. */
static void show_wrong_rotor(finding_t row, int ms)
{
    fast_report_t *report = &rig.to_slow;
    report->observer.sensor_turn = (uint16_t)(report->observer.sensor_turn + 32768U);
    if (ms < 2) {
        return;
    }
    if (row == FINDING_ROTOR_FREEZES) {
        report->speed_q32 = 0;
    } else if (row == FINDING_ROTOR_REVERSES) {
        report->speed_q32 = -report->speed_q32;
    } else if (row == FINDING_ROTOR_UNNAMED && ms < 20) {
        report->observer.flux_q14.v = q_pair(0, 0);
    }
}

/* The voltage of a motor with this share of its flux. */
static void show_flux(double share)
{
    const config_motor_t *m = &rig.config.motor;
    const dq_t i_pu = dq_of(rig.to_slow.i_pu);
    const double i_d_a = i_pu.d * rig.config.drive.current_full_scale_mA / 32768e3;
    const double i_q_a = i_pu.q * rig.config.drive.current_full_scale_mA / 32768e3;
    const double w = 300.0 / 60.0 * 6.283185307179586 * m->pole_pairs;
    const double r = m->phase_resistance_uOhm * 1e-6;
    const double u_d = r * i_d_a - w * m->q_inductance_nH * 1e-9 * i_q_a;
    const double u_q =
        r * i_q_a + w * (m->d_inductance_nH * 1e-9 * i_d_a + share * m->flux_linkage_nWb * 1e-9);
    const double per_v = 32768.0 * 32768.0 * sqrt(3.0) /
                         (53.0 * foc_modulation_limit_q15(&rig.config, BASES_MODEL_TIMER_Hz));
    const dq_t u_pu = {.d = (int32_t)lround(u_d * per_v), .q = (int32_t)lround(u_q * per_v)};
    rig.to_slow.u_pu = dq16_of(u_pu);
}

/* In the report of each millisecond, from zero on. */
static void show_cause(finding_t row, int ms)
{
    static uint16_t rotor_faults;
    if (row >= FINDING_CURRENT_A && row <= FINDING_CURRENT_C) {
        rig.to_slow.wrong_current_sensor = (uint8_t)(1 + (int)row - (int)FINDING_CURRENT_A);
    } else if (row == FINDING_ROTOR_READING || row == FINDING_ROTOR_GLITCH) {
        rig.to_slow.rotor_faults = ++rotor_faults;
    } else if (row == FINDING_OBSERVER_IN_USE) {
        rig.to_slow.sensor_valid = false;
    } else if (row >= FINDING_ROTOR_SLIPS && row <= FINDING_ROTOR_UNNAMED) {
        show_wrong_rotor(row, ms);
    } else if (is_of_brake(row) || row == FINDING_ROTOR_STOPS) {
        /* As brake blending and monitor do it, after the modes have acted. */
        findings_set(&rig.controller.slow.findings, row, true);
    } else if (row == FINDING_FLUX_LOW || row == FINDING_FLUX_HIGH) {
        show_flux(row == FINDING_FLUX_LOW ? 0.6 : 1.4);
    } else if (row == FINDING_GAIN) { /* too much is shown, so that no torque is withheld */
        rig.slow_in.bms.current_mA = rig.out.bus_current_mA / 2;
        rig.slow_in.demand.brake_torque_mNm = ms < 100 ? 0 : 20000;
    }
    rig.slow_in.hydraulic.age_ms++;
}

static void run_periods(void)
{
    for (int k = 0; k < RIG_FAST_PER_SLOW; k++) {
        rig_fast(&rig);
    }
}

/* Windows of 200 ms; a rotor sensor without a name, until the torque is back; a window of 1024 ms.
 */
static int time_of_cause_ms(finding_t row)
{
    if (row == FINDING_GAIN) {
        return 1200;
    }
    const bool slow = row == FINDING_FLUX_LOW || row == FINDING_FLUX_HIGH ||
                      row == FINDING_BUS_CONTRADICTED || row == FINDING_ROTOR_UNNAMED ||
                      row == FINDING_OBSERVER_IN_USE;
    return slow ? 1000 : 60;
}

static void run_with(finding_t row)
{
    const int milliseconds = time_of_cause_ms(row);
    begin_cause(row);
    for (int ms = 0; ms < milliseconds; ms++) {
        run_periods();
        show_cause(row, ms);
        rig_slow(&rig);
        rig.to_fast.observer.used = false; /* it has no motor to follow */
    }
}

/* Until nothing of it is left; stored offsets are measured as soon as the wheel coasts. */
static void run_without(finding_t row)
{
    slow_input_t *in = &rig.slow_in;
    in->temperature.winding_cC = 2500;
    in->temperature.switch_cC = 2500;
    in->demand.reason = REASON_NONE;
    in->bms.voltage_mV = 0;
    in->bms.current_given = false;
    if (row == FINDING_OFFSETS_OLD) {
        rig.config.modes.coast_delay_ms = 1;
        in->demand.brake_torque_mNm = 0;
        rig_run(&rig, 500);
        in->demand.brake_torque_mNm = 20000;
    }
    for (int ms = 0; ms < HEAL_ms; ms++) {
        in->hydraulic.age_ms = 0;
        run_periods();
        if (row == FINDING_FLUX_LOW || row == FINDING_FLUX_HIGH) {
            show_flux(1.0);
        }
        rig_slow(&rig);
    }
}

/* ---- what there is after it ---- */

static void assert_no_torque(reason_t reason)
{
    const char *name = reason_name(reason);
    TEST_ASSERT_EQUAL_INT32_MESSAGE(0, rig.out.motor_torque_command_mNm, name);
    TEST_ASSERT_EQUAL_INT32_MESSAGE(0, rig.out.electric_brake_available_mNm, name);
    TEST_ASSERT_EQUAL_INT32_MESSAGE(20000, rig.out.hydraulic_torque_mNm, name);
    TEST_ASSERT_FALSE_MESSAGE(rig.to_fast.torque_enabled, name);
}

static void assert_whole_brake(reason_t reason)
{
    const char *name = reason_name(reason);
    TEST_ASSERT_EQUAL_INT_MESSAGE(REASON_NONE, rig.out.fault_reason, name);
    TEST_ASSERT_EQUAL_INT_MESSAGE(reason, rig.out.warning_reason, name);
    TEST_ASSERT_EQUAL_INT_MESSAGE(reason, rig.out.present_warning, name);
    TEST_ASSERT_EQUAL_INT_MESSAGE(BRIDGE_PWM, rig.pwm.bridge, name);
    TEST_ASSERT_INT32_WITHIN_MESSAGE(20, healthy.motor_torque_command_mNm,
                                     rig.out.motor_torque_command_mNm, name);
    TEST_ASSERT_INT32_WITHIN_MESSAGE(20, healthy.electric_brake_available_mNm,
                                     rig.out.electric_brake_available_mNm, name);
}

/* LIMP: the configured share of the driving torque. */
static void assert_less_drive(reason_t reason)
{
    const char *name = reason_name(reason);
    const int64_t share_q15 = rig.config.modes.limp_drive_share_q15;
    TEST_ASSERT_EQUAL_INT_MESSAGE(MODE_LIMP, rig.out.mode, name);
    TEST_ASSERT_GREATER_THAN_INT32_MESSAGE(0, rig.out.drive_available_mNm, name);
    TEST_ASSERT_LESS_OR_EQUAL_INT32_MESSAGE(
        (int32_t)(share_q15 * rig.config.motor.max_torque_mNm / 32768) + 1,
        rig.out.drive_available_mNm, name);
    TEST_ASSERT_LESS_THAN_INT32_MESSAGE(healthy.drive_available_mNm, rig.out.drive_available_mNm,
                                        name);
}

static void assert_healed(reason_t reason)
{
    const char *name = reason_name(reason);
    TEST_ASSERT_EQUAL_INT_MESSAGE(MODE_RUN, rig.out.mode, name);
    TEST_ASSERT_EQUAL_INT_MESSAGE(REASON_NONE, rig.out.fault_reason, name);
    TEST_ASSERT_EQUAL_INT_MESSAGE(REASON_NONE, rig.out.present_warning, name);
    rig_fast(&rig);
    TEST_ASSERT_EQUAL_INT_MESSAGE(BRIDGE_PWM, rig.pwm.bridge, name);
}

/* ---- reactions ---- */

static void check_none(finding_t row)
{
    run_with(row);
    assert_whole_brake(findings_row(row).reason);
    TEST_ASSERT_EQUAL_INT(MODE_RUN, rig.out.mode);
    TEST_ASSERT_INT32_WITHIN(20, healthy.drive_available_mNm, rig.out.drive_available_mNm);
    run_without(row);
    assert_healed(findings_row(row).reason);
}

static void check_limit(finding_t row)
{
    run_with(row);
    assert_whole_brake(findings_row(row).reason);
    assert_less_drive(findings_row(row).reason);
    run_without(row);
    assert_healed(findings_row(row).reason);
}

/* A contactor that opens, a reading that jumps as no bus does, a bus that falls: in the next slow
 * step. The last has no name in its first millisecond. */
static void leave_bus(finding_t row)
{
    if (row == FINDING_BATTERY_LEFT) {
        rig.slow_in.bms.contactor = CONTACTOR_OPEN;
    } else {
        rig.fast_in.bus_voltage_code =
            rig_bus_code(&rig, row == FINDING_BUS_JUMPED ? 62.0 : LOW_BUS_V);
        rig_fast(&rig);
    }
    if (row == FINDING_BUS_JUMPED) {
        TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, rig.pwm.bridge);
    }
    rig_slow(&rig);
}

static void return_to_bus(void)
{
    rig.slow_in.bms.contactor = CONTACTOR_CLOSED;
    rig.fast_in.bus_voltage_code = rig_bus_code(&rig, 53.0);
}

/* Until a second after its sensor shows less. */
static void check_hot(finding_t row)
{
    run_with(row);
    assert_no_torque(findings_row(row).reason);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, rig.out.fault_reason);
    run_without(row);
    assert_healed(findings_row(row).reason);
}

static void check_off(finding_t row)
{
    if (row == FINDING_WINDING_HOT || row == FINDING_SWITCH_HOT) {
        check_hot(row);
        return;
    }
    const reason_t reason = findings_row(row).reason;
    leave_bus(row);
    assert_no_torque(reason);
    TEST_ASSERT_EQUAL_INT(reason, rig.out.warning_reason);
    TEST_ASSERT_EQUAL_INT(reason != REASON_NONE ? MODE_LIMP : MODE_RUN, rig.out.mode);
    rig_fast(&rig);
    TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, rig.pwm.bridge);
    return_to_bus();
    rig_slow(&rig);
    TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, rig.to_fast.safe_bridge);
    TEST_ASSERT_EQUAL_INT(MODE_LIMP, rig.out.mode);
    rig_run(&rig, 300);
    assert_healed(reason);
}

static void show_no_current(void)
{
    uint16_t *const code = rig.fast_in.phase_current_code;
    rig.follows = false;
    code[0] = code[1] = code[2] = 2048;
}

/* Far beyond the speed at which a current holds the voltage. */
static void check_least(reason_t reason)
{
    rig.slow_in.demand.brake_torque_mNm = 0;
    rig_run(&rig, 500);
    rig.config.rotor.observer_takeover = 0;
    rig_set_speed_rpm(&rig, 2.5 * rig.config.motor.max_speed_mrad_s * 60e-3 / 6.2832);
    show_no_current();
    rig_run(&rig, 100);
    TEST_ASSERT_EQUAL_INT(reason, rig.out.warning_reason);
    TEST_ASSERT_EQUAL_INT(MODE_LIMP, rig.out.mode); /* no fault */
    TEST_ASSERT_EQUAL_INT(rig.to_fast.safe_bridge, rig.pwm.bridge);
    rig_set_speed_rpm(&rig, 300.0);
    rig_run(&rig, LONG_ms);
    assert_healed(reason);
}

static void check_hand_over(reason_t reason)
{
    /* A demand that only grows old is lost without a row: modes sees its age. */
    const bool by_row = reason != REASON_DEMAND_TIMEOUT;
    rig.slow_in.demand.reason = by_row ? reason : REASON_NONE;
    rig.slow_in.demand_age_ms = LOST_ms;
    rig_run(&rig, 1);
    TEST_ASSERT_EQUAL_INT(reason, rig.out.warning_reason);
    TEST_ASSERT_INT32_WITHIN(200, healthy.motor_torque_command_mNm,
                             rig.out.motor_torque_command_mNm);
    int32_t before_mNm = rig.out.motor_torque_command_mNm;
    for (int ms = 0; ms < LONG_ms; ms++) {
        rig_run(&rig, 1);
        TEST_ASSERT_EQUAL_INT(by_row ? MODE_LIMP : MODE_RUN, rig.out.mode);
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
static void lose_rotor(reason_t reason, bool takeover)
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
    TEST_ASSERT_EQUAL_INT(reason, rig.out.fault_reason);
    rig_fast(&rig);
    TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, rig.pwm.bridge);
}

static void check_ramp(reason_t reason)
{
    lose_rotor(reason, false);
    lose_rotor(reason, true);
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

static void check_safe_state(reason_t reason)
{
    const char *name = reason_name(reason);
    put_fault(reason);
    assert_no_torque(reason);
    rig_fast(&rig);
    TEST_ASSERT_EQUAL_INT_MESSAGE(BRIDGE_OFF, rig.pwm.bridge, name);
    rig_slow(&rig);
    TEST_ASSERT_EQUAL_INT_MESSAGE(BRIDGE_OFF, rig.to_fast.safe_bridge, name);
    TEST_ASSERT_TRUE_MESSAGE(is_latched(reason), name);
    prefer_short();
    rig_run(&rig, 300);
    TEST_ASSERT_EQUAL_INT_MESSAGE(MODE_FAULT, rig.out.mode, name);
    TEST_ASSERT_EQUAL_INT_MESSAGE(BRIDGE_SHORT, rig.pwm.bridge, name);
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

static void check_trip(reason_t reason)
{
    const char *name = reason_name(reason);
    trip(reason);
    assert_no_torque(reason);
    rig_run(&rig, 2 * rig.config.monitor.battery_message_time_ms);
    TEST_ASSERT_EQUAL_INT_MESSAGE(reason, rig.out.fault_reason, name);
}

/* A switch that is stuck closed: half waves through the diodes of its side, 42 A at most. */
static void check_stuck_side(reason_t reason, bridge_mode_t side)
{
    const char *name = reason_name(reason);
    const int sign = side == BRIDGE_SHORT_HIGH ? 1 : -1;
    brake();
    trip(reason);
    rig.follows = false;
    rig.fast_in.power_stage_fault = false;
    rig.fast_in.bus_voltage_code = rig_bus_code(&rig, 53.0);
    rig.fast_in.phase_current_code[0] = (uint16_t)(2048 + sign * 522);
    rig.fast_in.phase_current_code[1] = (uint16_t)(2048 - sign * 261);
    rig.fast_in.phase_current_code[2] = (uint16_t)(2048 - sign * 261);
    rig_run(&rig, 50);
    TEST_ASSERT_EQUAL_INT_MESSAGE(side, rig.pwm.bridge, name);
}

/* Each that the fast monitor finds has the row TRIP; a stuck switch and a bus have rows of their
 * own as well. */
static void check_trips(finding_t row)
{
    static const struct {
        finding_t row;
        reason_t reason;
    } TRIPS[] = {{FINDING_TRIP, REASON_OVERCURRENT},
                 {FINDING_BUS_HIGH, REASON_BUS_OVERVOLTAGE},
                 {FINDING_SWITCH_STUCK, REASON_HARDWARE_BREAK}};
    for (unsigned k = 0; k < sizeof TRIPS / sizeof TRIPS[0]; k++) {
        if (TRIPS[k].row == row) {
            check_trip(TRIPS[k].reason);
            check_stuck_side(TRIPS[k].reason, BRIDGE_SHORT);
            check_stuck_side(TRIPS[k].reason, BRIDGE_SHORT_HIGH);
            return;
        }
    }
    TEST_FAIL_MESSAGE(reason_name(findings_row(row).reason));
}

static void check_reaction(finding_t row)
{
    const reason_t reason = findings_row(row).reason;
    switch (findings_row(row).reaction) {
    case FINDING_REACTION_NONE:
        check_none(row);
        break;
    case FINDING_REACTION_LIMIT:
        check_limit(row);
        break;
    case FINDING_REACTION_LEAST:
        check_least(reason);
        break;
    case FINDING_REACTION_OFF:
        check_off(row);
        break;
    case FINDING_REACTION_HAND_OVER:
        check_hand_over(reason);
        break;
    case FINDING_REACTION_RAMP:
        check_ramp(reason);
        break;
    case FINDING_REACTION_SAFE_STATE:
        check_safe_state(reason);
        break;
    case FINDING_REACTION_TRIP:
        check_trips(row);
        break;
    }
}

void test_torque_and_bridge_of_each_row_follow_from_its_reaction(void)
{
    for (finding_t row = (finding_t)0; row < FINDING_COUNT; row++) {
        brake();
        check_reaction(row);
    }
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

static void check_latched(reason_t reason)
{
    const char *name = reason_name(reason);
    rig_start_running(&rig);
    put_fault(reason);
    if (reason == REASON_BUS_OVERVOLTAGE) { /* a warning until it is qualified */
        rig.fast_in.bus_voltage_code = rig_bus_code(&rig, 62.0);
        rig_run(&rig, rig.config.monitor.battery_message_time_ms + 10);
        rig.fast_in.bus_voltage_code = rig_bus_code(&rig, 53.0);
    }
    /* A bus beyond its trip may be an EMF; rest is known once a wheel has coasted from there. */
    rig.config.monitor.coasting_mm_s2 = rig.config.monitor.tyre_grip_mm_s2;
    rig_run(&rig, LATCHED_ms);
    TEST_ASSERT_TRUE_MESSAGE(rig.out.standstill, name);
    TEST_ASSERT_EQUAL_INT_MESSAGE(MODE_FAULT, rig.out.mode, name);
    TEST_ASSERT_EQUAL_INT_MESSAGE(reason, rig.out.fault_reason, name);
    rig.slow_in.demand.brake_torque_mNm = 1;
    acknowledge();
    TEST_ASSERT_EQUAL_INT_MESSAGE(MODE_FAULT, rig.out.mode, name);
    rig.slow_in.demand.brake_torque_mNm = 0;
    acknowledge();
    TEST_ASSERT_EQUAL_INT_MESSAGE(fault_clearing(reason) == FAULT_CLEARING_RESTART,
                                  rig.out.mode == MODE_FAULT, name);
}

/* By itself: what it did ends; after a lost demand it is shown until it is acknowledged. */
static void check_warning(reason_t reason)
{
    const char *name = reason_name(reason);
    const bool shown = fault_clearing(reason) == FAULT_CLEARING_SHOWN;
    TEST_ASSERT_EQUAL_INT_MESSAGE(comes_with_the_demand(reason), shown, name);
    if (!shown && (int)reason < (int)REASON_FIRST_FAULT) {
        return; /* not with a demand */
    }
    rig_start_running(&rig);
    rig.slow_in.demand.reason = shown && reason != REASON_DEMAND_TIMEOUT ? reason : REASON_NONE;
    rig.slow_in.demand_age_ms = shown ? LOST_ms : 0;
    rig_run(&rig, 10);
    rig.slow_in.demand.reason = REASON_NONE;
    rig.slow_in.demand_age_ms = 0;
    rig_run(&rig, 10);
    TEST_ASSERT_EQUAL_INT_MESSAGE(MODE_RUN, rig.out.mode, name);
    TEST_ASSERT_EQUAL_INT_MESSAGE(shown ? reason : REASON_NONE, rig.out.warning_reason, name);
    rig.slow_in.demand.brake_torque_mNm = 1;
    acknowledge();
    TEST_ASSERT_EQUAL_INT_MESSAGE(shown ? reason : REASON_NONE, rig.out.warning_reason, name);
    rig.slow_in.demand.brake_torque_mNm = 0;
    acknowledge();
    TEST_ASSERT_EQUAL_INT_MESSAGE(REASON_NONE, rig.out.warning_reason, name);
}

/* A hydraulic brake whose reports show that it does not release: until they show that it does. */
void test_a_finding_of_the_hydraulic_brake_is_no_acknowledgements_to_end(void)
{
    rig_report_brake(&rig, 10000);
    rig_run(&rig, 300);
    TEST_ASSERT_EQUAL_INT(REASON_HYDRAULIC_STUCK, rig.out.warning_reason);
    rig.slow_in.demand.brake_torque_mNm = 0;
    for (int rpm = 300; rpm >= 0; rpm -= 3) {
        rig_set_speed_rpm(&rig, rpm);
        rig_run(&rig, 10);
    }
    rig_run(&rig, LONG_ms);
    TEST_ASSERT_TRUE(rig.out.standstill);
    acknowledge();
    TEST_ASSERT_EQUAL_INT(REASON_HYDRAULIC_STUCK, rig.out.warning_reason);
    rig_report_brake(&rig, 0);
    rig_run(&rig, 1100);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, rig.out.warning_reason);
}

void test_end_of_each_fault_follows_from_its_clearing(void)
{
    reason_t reason = REASON_NONE;
    for (uint32_t place = 0; fault_listed(place, &reason); place++) {
        if (is_latched(reason)) {
            check_latched(reason);
        } else {
            check_warning(reason);
        }
    }
}

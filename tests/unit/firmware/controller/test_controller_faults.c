/* SPDX-License-Identifier: Apache-2.0 */
#include "config/bases.h"
#include "controller_rig.h"
#include "unity.h"

static rig_t rig;

static const double TRIP_SPEED_RPM = 300.0;

/* Braking with 20 Nm at 300 r/min, in RUN. */
void setUp(void)
{
    rig_start_running(&rig);
    rig.follows = true; /* so that voltage and current belong together, as the observer expects */
    rig_set_speed_rpm(&rig, TRIP_SPEED_RPM);
    rig_run(&rig, 300);
    rig.slow_in.demand.brake_torque_mNm = 20000;
    rig_run(&rig, 20);
    TEST_ASSERT_EQUAL_INT(MODE_RUN, rig.out.mode);
    TEST_ASSERT_EQUAL_INT(BRIDGE_PWM, rig.pwm.bridge);
}

void tearDown(void) {}

static void put_codes(uint16_t a, uint16_t b, uint16_t c)
{
    rig.follows = false;
    rig.fast_in.phase_current_code[0] = a;
    rig.fast_in.phase_current_code[1] = b;
    rig.fast_in.phase_current_code[2] = c;
}

/* 110 A in phases a and b; the limit is 97.5 A, a code 80.6 mA. */
static void put_over_current(void)
{
    put_codes(2048 + 1365, 2048 - 1365, 2048);
}

static void assert_fault(reason_t reason)
{
    TEST_ASSERT_EQUAL_INT(MODE_FAULT, rig.out.mode);
    TEST_ASSERT_EQUAL_INT(reason, rig.out.fault_reason);
    TEST_ASSERT_EQUAL_INT32(20000, rig.out.hydraulic_torque_mNm);
    TEST_ASSERT_EQUAL_INT32(0, rig.out.motor_torque_command_mNm);
    TEST_ASSERT_EQUAL_INT32(0, rig.out.electric_brake_available_mNm);
    TEST_ASSERT_EQUAL_INT(reason, rig.out.available_reason);
    rig_fast(&rig);
    TEST_ASSERT_NOT_EQUAL_INT(BRIDGE_PWM, rig.pwm.bridge);
}

void test_the_bridge_switches_with_the_enable_and_without_a_trip_and_is_safe_otherwise(void)
{
    static const bridge_mode_t SAFE[] = {BRIDGE_OFF, BRIDGE_SHORT};
    for (int k = 0; k < 8; k++) {
        const bool enabled = (k & 1) != 0;
        const bool tripped = (k & 2) != 0;
        rig_start_running(&rig);
        rig.to_fast.torque_enabled = enabled;
        rig.to_fast.safe_bridge = SAFE[k >> 2];
        rig.fast_in.power_stage_fault = tripped;
        rig_fast(&rig);
        TEST_ASSERT_EQUAL_INT(enabled && !tripped ? BRIDGE_PWM : SAFE[k >> 2], rig.pwm.bridge);
        TEST_ASSERT_EQUAL_INT(rig.pwm.bridge, rig.to_slow.bridge);
    }
}

/* psi/L = 81.6 A instead of 268 A, which are admissible, and nothing may be charged. */
static void with_admissible_short(void)
{
    rig.config.motor.d_inductance_nH = 250000;
    rig.config.motor.q_inductance_nH = 250000;
    rig.config.motor.max_phase_current_mA = 85000;
    rig.config.drive.diode_drop_mV = 0;
    rig.slow_in.bms.charge_current_mA = 0;
}

void test_active_short_circuit_above_the_freewheel_limit_in_every_mode_without_torque(void)
{
    rig_start(&rig);
    with_admissible_short();
    rig_set_speed_rpm(&rig, 1.2 * rig.config.motor.max_speed_mrad_s * 60e-3 / 6.2832);
    rig.slow_in.selftest_passed = false; /* SELFTEST, then FAULT */
    rig_run(&rig, 100); /* 163 A on the way to 81.6: it waits for PWM, which does not come */
    TEST_ASSERT_EQUAL_INT(MODE_SELFTEST, rig.out.mode);
    TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, rig.pwm.bridge);
    rig_run(&rig, 200);
    TEST_ASSERT_EQUAL_INT(MODE_SELFTEST, rig.out.mode);
    TEST_ASSERT_EQUAL_INT(BRIDGE_SHORT, rig.pwm.bridge);
    rig_run(&rig, 2000);
    TEST_ASSERT_EQUAL_INT(MODE_FAULT, rig.out.mode);
    TEST_ASSERT_EQUAL_INT(BRIDGE_SHORT, rig.pwm.bridge);
}

void test_overcurrent_stops_the_bridge_in_its_second_period(void)
{
    put_over_current();
    rig_fast(&rig);
    TEST_ASSERT_EQUAL_INT(BRIDGE_PWM, rig.pwm.bridge);
    rig_fast(&rig);
    TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, rig.pwm.bridge);
    put_codes(2048, 2048, 2048);
    rig_fast(&rig);
    TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, rig.pwm.bridge);
    TEST_ASSERT_EQUAL_INT(REASON_OVERCURRENT, rig.to_slow.trip);
}

void test_current_loop_is_idle_after_a_trip_before_the_next_slow_step(void)
{
    put_over_current();
    rig_fast(&rig);
    rig_fast(&rig);
    rig_fast(&rig);
    TEST_ASSERT_TRUE(rig.to_fast.torque_enabled);
    for (int x = 0; x < 3; x++) {
        TEST_ASSERT_EQUAL_UINT16(bases_pwm_period_counts(&rig.config, BASES_MODEL_TIMER_Hz) / 2,
                                 rig.pwm.compare_counts[x]);
    }
}

void test_hydraulic_brake_has_the_whole_demand_one_slow_step_after_a_trip(void)
{
    put_over_current();
    rig_fast(&rig);
    rig_fast(&rig);
    rig_slow(&rig);
    assert_fault(REASON_OVERCURRENT);
}

void test_the_power_stage_s_fault_stops_the_bridge_in_the_same_period(void)
{
    rig.fast_in.power_stage_fault = true;
    rig_fast(&rig);
    TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, rig.pwm.bridge);
    rig_slow(&rig);
    assert_fault(REASON_HARDWARE_BREAK);
}

void test_overvoltage_stops_the_bridge_in_the_same_period(void)
{
    rig.fast_in.bus_voltage_code = rig_bus_code(&rig, 59.8);
    rig_fast(&rig);
    TEST_ASSERT_EQUAL_INT(BRIDGE_PWM, rig.pwm.bridge);
    rig.fast_in.bus_voltage_code = rig_bus_code(&rig, 60.7); /* trips at 60.564 V */
    rig_fast(&rig);
    TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, rig.pwm.bridge);
    rig_slow(&rig);
    TEST_ASSERT_EQUAL_INT(MODE_LIMP, rig.out.mode);
    TEST_ASSERT_EQUAL_INT32(20000, rig.out.hydraulic_torque_mNm);
    TEST_ASSERT_EQUAL_INT32(0, rig.out.motor_torque_command_mNm);
    TEST_ASSERT_EQUAL_INT(REASON_BATTERY_DISCONNECTED, rig.out.available_reason);
    rig_run(&rig, 298);
    TEST_ASSERT_EQUAL_INT(MODE_LIMP, rig.out.mode);
    TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, rig.pwm.bridge);
    rig_run(&rig, 2);
    assert_fault(REASON_BUS_OVERVOLTAGE);
}

/* The battery's message explains the over-voltage; with the battery back the brake returns. */
void test_an_opened_contactor_is_a_warning_and_the_brake_returns_by_itself(void)
{
    rig.fast_in.bus_voltage_code = rig_bus_code(&rig, 60.7);
    rig_run(&rig, 100);
    rig.slow_in.bms.contactor = CONTACTOR_OPEN;
    rig_run(&rig, 2000);
    TEST_ASSERT_EQUAL_INT(MODE_LIMP, rig.out.mode);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, rig.out.fault_reason);
    TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, rig.pwm.bridge);
    TEST_ASSERT_EQUAL_INT32(20000, rig.out.hydraulic_torque_mNm);
    rig.slow_in.bms.contactor = CONTACTOR_CLOSED;
    rig.fast_in.bus_voltage_code = rig_bus_code(&rig, 53.0);
    rig_run(&rig, 440); /* it has left and come back before, at the start */
    TEST_ASSERT_EQUAL_INT(MODE_RUN, rig.out.mode);
    TEST_ASSERT_EQUAL_INT(BRIDGE_PWM, rig.pwm.bridge);
    rig_run(&rig, 2000); /* the braking torque rises as slowly */
    TEST_ASSERT_TRUE(rig.out.motor_torque_command_mNm < 0);
}

void test_trip_selects_active_short_circuit_above_the_freewheel_limit(void)
{
    with_admissible_short();
    rig.follows = false;
    rig.config.rotor.observer_takeover =
        0; /* no machine: no field weakening shows in the voltage */
    /* at 640 r/min and 53 V, sqrt(3) psi w = 54.5 V */
    rig_set_speed_rpm(&rig, 640.0);
    rig_run(&rig, 500);
    TEST_ASSERT_EQUAL_INT(MODE_RUN, rig.out.mode);
    rig.fast_in.power_stage_fault = true;
    rig_fast(&rig);
    TEST_ASSERT_EQUAL_INT(BRIDGE_SHORT, rig.pwm.bridge);
    rig_run(&rig, 100);
    TEST_ASSERT_EQUAL_INT(BRIDGE_SHORT, rig.pwm.bridge);
    rig_set_speed_rpm(&rig, TRIP_SPEED_RPM);
    rig_run(&rig, 500);
    TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, rig.pwm.bridge);
    TEST_ASSERT_EQUAL_INT(MODE_FAULT, rig.out.mode);
}

void test_fast_loop_stops_the_bridge_when_the_slow_loop_stops(void)
{
    /* four of its steps, 80 periods, may be missing; the step before the first of them is still on
     * its way */
    for (int n = 0; n < 80; n++) {
        rig_fast(&rig);
        TEST_ASSERT_EQUAL_INT(BRIDGE_PWM, rig.pwm.bridge);
    }
    rig_fast(&rig);
    rig_fast(&rig);
    TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, rig.pwm.bridge);
    rig_slow(&rig);
    assert_fault(REASON_PROGRAM_FLOW);
}

void test_stopped_fast_loop_is_a_fault_in_the_third_slow_step(void)
{
    for (int n = 0; n < 2; n++) {
        rig_slow(&rig);
        TEST_ASSERT_EQUAL_INT(MODE_RUN, rig.out.mode);
    }
    rig_slow(&rig);
    assert_fault(REASON_PROGRAM_FLOW);
}

/* Zero current instead of more than 128 codes: a very large error, so that readings that do not
 * move are frozen eight periods after the first of the looks, one in every fourth period. */
void test_frozen_current_readings_stop_the_bridge_in_the_same_period(void)
{
    rig_run(&rig, 50);
    TEST_ASSERT_GREATER_THAN_INT32(128 * 16, -rig.to_fast.i_reference_pu.q);
    put_codes(2048, 2048, 2048);
    int periods = 0;
    do {
        TEST_ASSERT_EQUAL_INT(BRIDGE_PWM, rig.pwm.bridge);
        rig_period(&rig);
        periods++;
    } while (rig.to_slow.trip == REASON_NONE && periods < 20);
    TEST_ASSERT_EQUAL_INT(REASON_CURRENT_SENSOR, rig.to_slow.trip);
    TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, rig.pwm.bridge);
    TEST_ASSERT_GREATER_THAN_INT(8, periods);
    TEST_ASSERT_LESS_OR_EQUAL_INT(12, periods);
    rig_slow(&rig);
    assert_fault(REASON_CURRENT_SENSOR);
}

/* Without movement no observer sees the rotor's angle. */
void test_invalid_hall_states_at_standstill_end_torque_at_once_and_then_run(void)
{
    rig_start(&rig);
    rig.config.rotor.sensor = CONFIG_ROTOR_HALL;
    controller_init(&rig.controller, &rig.config, BASES_MODEL_TIMER_Hz);
    rig.fast_in.hall_state = 5;
    rig.slow_in.demand.enable = true;
    rig_run(&rig, 100);
    TEST_ASSERT_EQUAL_INT(MODE_RUN, rig.out.mode);
    rig.slow_in.demand.drive_torque_mNm = 4000;
    rig_run(&rig, 20);
    TEST_ASSERT_EQUAL_INT32(4000, rig.out.motor_torque_command_mNm);
    rig.fast_in.hall_state = 7;
    rig_run(&rig, 3); /* 64 periods are 3.2 ms */
    TEST_ASSERT_EQUAL_INT32(4000, rig.out.motor_torque_command_mNm);
    rig_run(&rig, 2);
    TEST_ASSERT_EQUAL_INT(MODE_LIMP, rig.out.mode);
    TEST_ASSERT_EQUAL_INT32(0, rig.out.motor_torque_command_mNm);
    rig_run(&rig, 13);
    TEST_ASSERT_EQUAL_INT(MODE_LIMP, rig.out.mode);
    TEST_ASSERT_EQUAL_INT32(0, rig.out.motor_torque_command_mNm);
    rig_run(&rig, 360); /* 40 Nm would need 100 ms, and a fault may heal for 250 ms */
    TEST_ASSERT_EQUAL_INT(MODE_FAULT, rig.out.mode);
    TEST_ASSERT_EQUAL_INT(REASON_ROTOR_LOST, rig.out.fault_reason);
}

/* 7.3 % of full scale; 5 % are allowed. */
void test_one_wrong_current_sensor_leads_to_limp_and_the_brake_remains(void)
{
    rig.follows = true;
    rig_run(&rig, 2);
    rig.wrong_codes[1] = 150.0;
    rig_run(&rig, 2);
    TEST_ASSERT_EQUAL_INT(MODE_LIMP, rig.out.mode);
    TEST_ASSERT_EQUAL_INT(REASON_CURRENT_SENSOR_B, rig.out.warning_reason);
    TEST_ASSERT_EQUAL_INT(BRIDGE_PWM, rig.pwm.bridge);
    TEST_ASSERT_GREATER_THAN_INT32(10000, rig.out.electric_brake_available_mNm);
}

void test_two_wrong_current_sensors_lead_to_fault_in_the_next_slow_step(void)
{
    rig.follows = true;
    rig_run(&rig, 2);
    rig.wrong_codes[0] = 150.0;
    rig.wrong_codes[1] = 150.0;
    rig_run(&rig, 1);
    assert_fault(REASON_CURRENT_SUM);
}

void test_undetermined_sum_of_currents_ends_with_the_acknowledgement(void)
{
    rig.follows = true;
    rig_run(&rig, 2);
    rig.wrong_codes[0] = 150.0;
    rig.wrong_codes[1] = 150.0;
    rig_run(&rig, 2);
    rig.follows = false;
    put_codes(2048, 2048, 2048);
    rig_run(&rig, 30);
    assert_fault(REASON_CURRENT_SUM);
    rig_set_speed_rpm(&rig, 0.0);
    rig.slow_in.demand.brake_torque_mNm = 0;
    rig_run(&rig, 100000);
    rig.slow_in.demand.fault_reset = true;
    rig_run(&rig, 200);
    TEST_ASSERT_NOT_EQUAL_INT(MODE_FAULT, rig.out.mode);
}

void test_torque_without_a_command_leads_to_fault(void)
{
    rig_start_running(&rig);                /* at rest */
    rig.config.rotor.observer_takeover = 0; /* the sensor returns */
    rig.angle_turn = 0.25;                  /* a jump, for which it is uncertain */
    rig_run(&rig, 300);
    TEST_ASSERT_EQUAL_INT(MODE_LIMP, rig.out.mode);
    put_codes(2048 - 248, 2048 + 124, 2048 + 124); /* 20 A of i_q: 14 Nm without a command */
    rig_run(&rig, 45);
    TEST_ASSERT_EQUAL_INT(MODE_LIMP, rig.out.mode);
    rig_run(&rig, 20);
    TEST_ASSERT_EQUAL_INT(MODE_FAULT, rig.out.mode);
    TEST_ASSERT_EQUAL_INT(REASON_TORQUE_IMPLAUSIBLE, rig.out.fault_reason);
}

/* ---- acknowledgement ---- */

static void trip(void)
{
    put_over_current();
    rig_fast(&rig);
    rig_fast(&rig);
    put_codes(2048, 2048, 2048);
    rig_run(&rig, 10);
    assert_fault(REASON_OVERCURRENT);
}

/* Standstill and zero demand, the conditions of an acknowledgement. A wheel of 0.25 m slows down by
 * 0.4 rpm a millisecond at 10.5 m/s^2, within the tyre's grip. */
static void come_to_rest(void)
{
    rig.slow_in.demand.brake_torque_mNm = 0;
    for (double speed_rpm = TRIP_SPEED_RPM; speed_rpm > 0.0; speed_rpm -= 0.4) {
        rig_set_speed_rpm(&rig, speed_rpm);
        rig_run(&rig, 1);
    }
    rig_set_speed_rpm(&rig, 0.0);
    rig_run(&rig, 500);
}

void test_fault_is_latched_until_an_acknowledgement(void)
{
    trip();
    come_to_rest();
    rig_run(&rig, 10000);
    TEST_ASSERT_EQUAL_INT(MODE_FAULT, rig.out.mode);
    TEST_ASSERT_EQUAL_INT(REASON_OVERCURRENT, rig.out.fault_reason);
}

void test_acknowledgement_clears_the_trip_in_both_loops_and_recalibrates(void)
{
    trip();
    come_to_rest();
    put_codes(2060, 2050, 2040); /* the sensors have drifted with the heat */
    rig.slow_in.demand.fault_reset = true;
    rig_run(&rig, 3);
    TEST_ASSERT_NOT_EQUAL_INT(MODE_FAULT, rig.out.mode);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, rig.out.fault_reason);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, rig.to_slow.trip);
    rig_run(&rig, 100);
    TEST_ASSERT_EQUAL_INT(MODE_RUN, rig.out.mode); /* still enabled */
    TEST_ASSERT_EQUAL_INT(BRIDGE_PWM, rig.pwm.bridge);
    TEST_ASSERT_EQUAL_INT32(2060 * 16, rig.to_slow.offset_q4[0]);
    TEST_ASSERT_EQUAL_INT32(2050 * 16, rig.to_slow.offset_q4[1]);
    TEST_ASSERT_EQUAL_INT32(2040 * 16, rig.to_slow.offset_q4[2]);
}

/* The sensor freezes at TRIP_SPEED_RPM: valid, and its speed falls to zero within milliseconds. */
void test_acknowledgement_is_ignored_while_a_frozen_sensor_alone_shows_standstill(void)
{
    trip();
    rig.slow_in.demand.brake_torque_mNm = 0;
    rig_set_speed_rpm(&rig, 0.0);
    for (int n = 0; n < 100; n++) { /* 10 s: the bound by tyre grip has long been zero */
        rig.slow_in.demand.fault_reset = n % 2 == 0;
        rig_run(&rig, 100);
        TEST_ASSERT_EQUAL_INT(MODE_FAULT, rig.out.mode);
        TEST_ASSERT_EQUAL_INT(WAITS_FOR_REST, rig.out.waits_for);
        TEST_ASSERT_FALSE(rig.out.standstill);
    }
}

void test_acknowledgement_while_rolling_or_with_a_demand_is_ignored(void)
{
    trip();
    rig.slow_in.demand.fault_reset = true; /* rolling, braking */
    rig_run(&rig, 100);
    TEST_ASSERT_EQUAL_INT(MODE_FAULT, rig.out.mode);
    rig.slow_in.demand.fault_reset = false;
    come_to_rest();
    rig.slow_in.demand.drive_torque_mNm = 1;
    rig.slow_in.demand.fault_reset = true;
    rig_run(&rig, 100);
    TEST_ASSERT_EQUAL_INT(MODE_FAULT, rig.out.mode);
}

void test_acknowledgement_of_a_present_fault_has_no_effect(void)
{
    trip();
    come_to_rest();
    rig.fast_in.power_stage_fault = true;
    rig.slow_in.demand.fault_reset = true;
    for (int n = 0; n < 200; n++) {
        rig_run(&rig, 1);
        TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, rig.pwm.bridge);
    }
    TEST_ASSERT_EQUAL_INT(MODE_FAULT, rig.out.mode);
    TEST_ASSERT_EQUAL_INT(REASON_OVERCURRENT, rig.out.fault_reason);
    rig.fast_in.power_stage_fault = false;
    rig_run(&rig, 1000);
    TEST_ASSERT_EQUAL_INT(MODE_FAULT, rig.out.mode);
}

/* ---- battery's own voltage ---- */

/* A full battery behind a sensor that shows the middle of its range: nothing more is returned, and
 * nothing either once the battery has left. */
void test_full_battery_ends_the_return_although_the_bus_sensor_shows_less(void)
{
    rig.slow_in.bms.contactor = CONTACTOR_CLOSED;
    rig_run(&rig, 500);
    TEST_ASSERT_GREATER_THAN_INT32(0, rig.out.electric_brake_available_mNm);
    rig.slow_in.bms.voltage_mV = rig.config.battery.max_voltage_mV;
    rig_run(&rig, 1000);
    TEST_ASSERT_EQUAL_INT(REASON_BUS_SENSOR, rig.out.warning_reason);
    TEST_ASSERT_EQUAL_INT(REASON_BUS_VOLTAGE_HIGH, rig.out.available_reason);
    rig.slow_in.bms.contactor = CONTACTOR_OPEN;
    rig_slow(&rig);
    TEST_ASSERT_EQUAL_INT(REASON_BATTERY_DISCONNECTED, rig.out.available_reason);
}

/* SPDX-License-Identifier: Apache-2.0 */
/* What the slow step passes to its checks and takes from them: each condition that switches a check
 * off, and each field of the output. */
#include "monitor_rig.h"
#include "safe_state_case.h"

enum {
    WINDOW_ms = MONITOR_WINDOW_STEPS + MONITOR_WINDOW_QUALIFY_STEPS,
    TOLERANCE_mNm = 4000,
    FAST_mrad_s = 90000 /* sqrt(3) w psi is 73 V */
};

void setUp(void)
{
    rig_up(&TURNING);
    in.last.torque_command_mNm = 0;
    in.last.torque_estimate_mNm = 0;
    in.battery.voltage_mV = 53000;
    config.battery.overvoltage_trip_mV = 60564;
    config.battery.undervoltage_trip_mV = 36000;
    config.battery.driven_wheels = 1;
    config.monitor.flux_tolerance_permille = 150;
    config.monitor.torque_tolerance_mNm = TOLERANCE_mNm;
    config.monitor.torque_fault_time_ms = 50;
}

void tearDown(void) {}

/* ---- flux and bus sensor ---- */

void test_bus_sensor_is_compared_with_the_message_where_the_battery_holds_the_bus(void)
{
    in.now.bus_voltage_mV = 45000;
    TEST_ASSERT_EQUAL_INT(REASON_NONE, run(WINDOW_ms - 1).flux_warning);
    TEST_ASSERT_EQUAL_INT(REASON_BUS_SENSOR, step().flux_warning);
    in.battery.contactor = CONTACTOR_OPEN;
    TEST_ASSERT_EQUAL_INT(REASON_NONE, run(1000).flux_warning);
    setUp();
    in.now.bus_voltage_mV = 61000; /* beyond its trip: nothing is known of the battery */
    in.battery.voltage_mV = 50000;
    TEST_ASSERT_EQUAL_INT(REASON_NONE, run(1000).flux_warning);
    setUp();
    in.battery.voltage_mV = 0;
    in.now.bus_voltage_mV = 45000;
    TEST_ASSERT_EQUAL_INT(REASON_NONE, run(1000).flux_warning);
}

void test_flux_is_named_weak_or_as_a_bus_voltage_that_reads_high(void)
{
    TEST_ASSERT_EQUAL_INT(REASON_NONE, run(1000).flux_warning);
    in.now.latest_u_q_mV = 7000;
    TEST_ASSERT_EQUAL_INT(REASON_FLUX_WEAK, run(1000).flux_warning);
    /* While the message contradicts the bus voltage, the EMF says nothing of the flux. */
    in.battery.voltage_mV = 40000;
    TEST_ASSERT_EQUAL_INT(REASON_NONE, step().flux_warning);
    TEST_ASSERT_EQUAL_INT(REASON_BUS_SENSOR, run(WINDOW_ms).flux_warning);
    setUp();
    in.now.latest_u_q_mV = 21000;
    TEST_ASSERT_EQUAL_INT(REASON_BUS_SENSOR, run(1000).flux_warning);
}

/* Without the message a bus voltage that reads low may be the cause. */
void test_flux_that_is_missing_is_a_figure_only_beside_a_message_of_the_bus_voltage(void)
{
    in.now.latest_u_q_mV = 7000;
    TEST_ASSERT_GREATER_THAN_INT32(0, run(1000).monitored.flux_missing_q15);
    in.battery.voltage_mV = 0;
    const shown_t alone = step();
    TEST_ASSERT_EQUAL_INT(REASON_FLUX_WEAK, alone.flux_warning);
    TEST_ASSERT_EQUAL_INT32(0, alone.monitored.flux_missing_q15);
}

/* ---- currents ---- */

void test_missing_current_is_a_fault_with_pwm_within_the_voltage(void)
{
    in.last.reference_pu.q = 10000;
    TEST_ASSERT_EQUAL_INT(REASON_NONE, run(2).fault);
    TEST_ASSERT_EQUAL_INT(REASON_CURRENT_SENSOR, step().fault);
    in.report.bridge = BRIDGE_OFF;
    TEST_ASSERT_EQUAL_INT(REASON_NONE, run(100).fault);
    setUp();
    in.last.reference_pu.q = 10000;
    in.report.voltage_limited = true;
    TEST_ASSERT_EQUAL_INT(REASON_NONE, run(100).fault);
    setUp();
    in.last.reference_pu.q = 10000;
    in.now.sampled_pu.q = 10000;
    in.report.i_pu.v = q_pair(0, 10000);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, run(100).fault);
}

/* In windows of 1024 ms: one in which both currents begin to flow, then one of twice the current.
 */
static void show_gain(void)
{
    setUp();
    config.battery.current_filter_ms = 0;
    in.battery.current_given = true;
    (void)step();
    in.now.bus_current_mA = 50000;
    in.battery.current_mA = 50000;
    (void)run(1023);
    in.battery.current_mA = 100000;
    TEST_ASSERT_EQUAL_INT(REASON_NONE, run(1023).warning);
    const shown_t named = step();
    TEST_ASSERT_EQUAL_INT(REASON_CURRENT_GAIN, named.warning);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, named.fault);
    TEST_ASSERT_EQUAL_INT32(13107, named.monitored.current_missing_q15);
}

void test_gain_of_the_current_sensors_is_a_warning_where_it_can_be_compared(void)
{
    show_gain();
    in.battery.current_mA = 50000;
    TEST_ASSERT_EQUAL_INT(REASON_CURRENT_GAIN, run(1023).warning);
    const shown_t healed = step();
    TEST_ASSERT_EQUAL_INT(REASON_NONE, healed.warning);
    TEST_ASSERT_EQUAL_INT32(0, healed.monitored.current_missing_q15);
    show_gain();
    in.battery.contactor = CONTACTOR_OPEN;
    TEST_ASSERT_FALSE(findings_present(&findings, (step(), FINDING_GAIN)));
    show_gain();
    in.battery.current_given = false;
    TEST_ASSERT_FALSE(findings_present(&findings, (step(), FINDING_GAIN)));
}

/* An open bridge carries no current, whatever was measured last, and neither does a short circuit
 * to the bus; diodes that conduct carry one that is not known. */
void test_current_into_the_bus_is_zero_without_pwm_unless_diodes_conduct(void)
{
    static const bridge_mode_t BRIDGES[] = {BRIDGE_OFF, BRIDGE_SHORT, BRIDGE_SHORT_HIGH};
    for (int k = 0; k < 3; k++) {
        show_gain();
        in.report.bridge = BRIDGES[k];
        in.now.bus_current_mA = 100000;
        in.battery.current_mA = 0;
        (void)run(2048);
        TEST_ASSERT_EQUAL_INT32(0, state.gain.loop_high_mA);
        TEST_ASSERT_GREATER_THAN_INT32(0, state.gain.steps + 1);
    }
    show_gain();
    in.report.bridge = BRIDGE_OFF;
    in.now.speed_mrad_s = FAST_mrad_s;
    (void)run(500);
    TEST_ASSERT_EQUAL_INT32(0, state.gain.steps);
    TEST_ASSERT_TRUE(findings_present(&findings, FINDING_GAIN));
    in.report.bridge = BRIDGE_SHORT;
    (void)run(500);
    TEST_ASSERT_EQUAL_INT32(500, state.gain.steps);
}

/* Without PWM: 15/16 of the range is a sensor at its rail, less is a sum. */
void test_sum_at_the_end_of_the_range_is_exact(void)
{
    in.report.bridge = BRIDGE_OFF;
    for (int sign = -1; sign <= 1; sign += 2) {
        in.report.current_sum_pu = sign * 30720;
        TEST_ASSERT_EQUAL_INT(REASON_CURRENT_SUM, run(100).fault);
        in.report.current_sum_pu = sign * 30721;
        TEST_ASSERT_EQUAL_INT(REASON_CURRENT_SENSOR, run(100).fault);
        in.report.offsets_done = false;
        TEST_ASSERT_EQUAL_INT(REASON_NONE, run(100).fault);
        in.report.offsets_done = true;
    }
}

/* The fast loop calls a sum undetermined beside a named sensor if another one is wrong as well. */
void test_an_undetermined_sum_is_a_fault_whether_a_sensor_has_a_name_or_not(void)
{
    for (uint8_t wrong = 0; wrong <= 3; wrong++) {
        in.report.wrong_current_sensor = wrong;
        in.report.current_undetermined = false;
        TEST_ASSERT_EQUAL_INT(REASON_NONE, run(100).fault);
        in.report.current_undetermined = true;
        TEST_ASSERT_EQUAL_INT(REASON_CURRENT_SUM, step().fault);
    }
}

void test_a_sum_is_a_fault_again_once_its_sensor_has_no_name_any_more(void)
{
    in.report.current_sum_pu = config.monitor.current_sum_pu_q15 + 1;
    in.report.wrong_current_sensor = 2;
    TEST_ASSERT_EQUAL_INT(REASON_NONE, run(100).fault);
    in.report.wrong_current_sensor = 0;
    TEST_ASSERT_EQUAL_INT(REASON_NONE, run(config.monitor.sensor_fault_time_ms - 1).fault);
    TEST_ASSERT_EQUAL_INT(REASON_CURRENT_SUM, step().fault);
}

/* ---- a switch that is stuck ---- */

/* Half waves of half the trip current in phase a, `sign` along it, for two windows. */
static shown_t half_waves_after(reason_t trip, int sign)
{
    in.now.trip = trip;
    in.report.bridge = BRIDGE_OFF;
    for (int ms = 0; ms < 30; ms++) {
        in.report.idle_alpha_pu +=
            (uint32_t)(sign * FAST_PER_SLOW * config.monitor.overcurrent_pu_q15 / 2);
        const shown_t out = step();
        if (out.monitored.safe.bridge != BRIDGE_OFF) {
            return out;
        }
    }
    return step();
}

static shown_t half_waves(int sign)
{
    return half_waves_after(REASON_HARDWARE_BREAK, sign);
}

/* Found while coasting: a fault of the power stage, until the wheel is at rest. */
void test_half_waves_without_a_trip_are_a_fault_of_the_power_stage(void)
{
    for (int sign = -1; sign <= 1; sign += 2) {
        setUp();
        shown_t out = half_waves_after(REASON_NONE, sign);
        TEST_ASSERT_EQUAL_INT(sign > 0 ? BRIDGE_SHORT_HIGH : BRIDGE_SHORT,
                              out.monitored.safe.bridge);
        TEST_ASSERT_EQUAL_INT(REASON_HARDWARE_BREAK, out.fault);
        TEST_ASSERT_FALSE(out.monitored.release_break);
        in.now.trip = REASON_OVERCURRENT; /* the trip has its own name */
        TEST_ASSERT_EQUAL_INT(REASON_OVERCURRENT, step().fault);
    }
}

/* Frozen readings have a mean that is no current. */
void test_readings_that_a_trip_has_called_wrong_show_no_stuck_switch(void)
{
    TEST_ASSERT_EQUAL_INT(BRIDGE_SHORT_HIGH,
                          half_waves_after(REASON_OVERCURRENT, 1).monitored.safe.bridge);
    setUp();
    TEST_ASSERT_EQUAL_INT(BRIDGE_OFF,
                          half_waves_after(REASON_CURRENT_SENSOR, 1).monitored.safe.bridge);
}

void test_stuck_switch_calls_for_the_short_circuit_on_its_side(void)
{
    shown_t out = half_waves(1);
    TEST_ASSERT_EQUAL_INT(BRIDGE_SHORT_HIGH, out.monitored.safe.bridge);
    TEST_ASSERT_TRUE(out.monitored.release_break && out.monitored.emf_conducts &&
                     out.monitored.safe.torque_mNm > 0);
    TEST_ASSERT_EQUAL_INT32(0, out.charging_mA);
    setUp();
    out = half_waves(-1);
    TEST_ASSERT_EQUAL_INT(BRIDGE_SHORT, out.monitored.safe.bridge);
    in.now.trip = REASON_NONE; /* acknowledged */
    out = step();
    TEST_ASSERT_FALSE(out.monitored.release_break);
}

void test_stuck_switch_needs_sensors_that_are_good(void)
{
    for (int part = 0; part < 6; part++) {
        setUp();
        in.report.offsets_done = part != 1;
        in.report.wrong_current_sensor = part == 2 ? 3 : 0;
        in.now.angle_valid = part != 3;
        const int32_t sum_pu = config.monitor.current_sum_pu_q15 + (part < 4 ? 0 : 1);
        in.report.current_sum_pu = part == 5 ? -sum_pu : sum_pu;
        const bridge_mode_t expected = part == 0 ? BRIDGE_SHORT_HIGH : BRIDGE_OFF;
        TEST_ASSERT_EQUAL_INT(expected, half_waves(1).monitored.safe.bridge);
    }
}

/* ---- torque that the voltage forces ---- */

static void assert_unwanted(int32_t speed_mrad_s, int32_t estimate_mNm, bool unwanted)
{
    setUp();
    in.report.voltage_limited = true; /* the angle is not this test's */
    in.now.speed_mrad_s = speed_mrad_s;
    in.last.torque_estimate_mNm = estimate_mNm;
    TEST_ASSERT_EQUAL_INT(REASON_NONE, run(49).fault);
    TEST_ASSERT_EQUAL_INT(unwanted ? REASON_TORQUE_IMPLAUSIBLE : REASON_NONE, step().fault);
}

/* Against the speed and no further than the largest torque. */
void test_torque_that_the_voltage_forces_is_wanted_while_it_brakes(void)
{
    const int32_t most_mNm = TOLERANCE_mNm + config.motor.max_torque_mNm;
    for (int sign = -1; sign <= 1; sign += 2) {
        assert_unwanted(sign * FAST_mrad_s, -sign * most_mNm, false);
        assert_unwanted(sign * FAST_mrad_s, -sign * (most_mNm + 1), true);
        assert_unwanted(sign * FAST_mrad_s, sign * TOLERANCE_mNm, false);
        assert_unwanted(sign * FAST_mrad_s, sign * (TOLERANCE_mNm + 1), true);
        assert_unwanted(sign * 10000, -sign * TOLERANCE_mNm, false);
        assert_unwanted(sign * 10000, -sign * (TOLERANCE_mNm + 1), true);
    }
}

/* ---- what the safe state does ---- */

void test_safe_state_is_that_of_the_speed_bound(void)
{
    in.report.bridge = BRIDGE_OFF;
    shown_t out = step();
    TEST_ASSERT_FALSE(out.monitored.emf_conducts);
    TEST_ASSERT_EQUAL_INT32(0, out.charging_mA);
    TEST_ASSERT_EQUAL_INT32(0, out.monitored.safe.torque_mNm);
    in.now.speed_mrad_s = 70000; /* 56.9 V, beyond 50 V and two diodes */
    in.now.bus_voltage_mV = 50000;
    in.battery.voltage_mV = 50000;
    in.battery.charge_current_mA = 1000000;
    out = step();
    const safe_state_case_t turning = {.bound_mrad_s = 70000,
                                       .winding_temperature_cC = 2500,
                                       .bus_voltage_mV = 50000,
                                       .charge_current_mA = 1000000};
    const steady_state_t off = freewheel_of(&config, &turning);
    TEST_ASSERT_TRUE(off.charging_mA > 0 && off.torque_mNm > 0);
    TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, out.monitored.safe.bridge);
    TEST_ASSERT_TRUE(out.monitored.emf_conducts);
    TEST_ASSERT_EQUAL_INT32(off.charging_mA, out.charging_mA);
    TEST_ASSERT_EQUAL_INT32(off.torque_mNm, out.monitored.safe.torque_mNm);
    in.battery.contactor = CONTACTOR_OPEN; /* nothing takes a current */
    out = step();
    TEST_ASSERT_FALSE(out.monitored.emf_conducts);
    TEST_ASSERT_EQUAL_INT32(0, out.charging_mA);
}

void test_rest_and_standstill_are_below_the_configured_speed(void)
{
    config.monitor.standstill_mrad_s = 500;
    in.now.latest_u_q_mV = 0;
    in.now.speed_mrad_s = 500;
    shown_t out = step();
    TEST_ASSERT_FALSE(out.monitored.at_rest || out.monitored.standstill);
    TEST_ASSERT_EQUAL_INT32(500, out.monitored.bound_mrad_s);
    in.now.speed_mrad_s = 499;
    out = run(100);
    TEST_ASSERT_TRUE(out.monitored.at_rest && out.monitored.standstill);
}

void test_there_is_no_rest_for_a_second_after_an_impossible_reading(void)
{
    in.now.latest_u_q_mV = 0;
    in.now.speed_mrad_s = 0;
    TEST_ASSERT_TRUE(run(100).monitored.at_rest);
    in.report.rotor_faults++;
    for (int n = 0; n < MONITOR_READING_STEPS; n++) {
        TEST_ASSERT_FALSE(step().monitored.at_rest);
    }
    TEST_ASSERT_TRUE(step().monitored.at_rest);
}

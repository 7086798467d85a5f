/* SPDX-License-Identifier: Apache-2.0 */
/* What the slow step passes to its checks and takes from them: each condition that switches a check
 * off, and each field of the output. */
#include "freewheel.h"
#include "monitor_rig.h"

enum {
    MID_OFFSET_Q4 = 2048 * 16,
    WINDOW_ms = MONITOR_WINDOW_STEPS + MONITOR_WINDOW_QUALIFY_STEPS,
    TOLERANCE_mNm = 4000,
    FAST_mrad_s = 90000 /* sqrt(3) w psi is 73 V */
};

static const monitor_slow_input_t HEALTHY = {
    .fast_trip = REASON_NONE,
    .offsets_known = true,
    .rotor_valid = true,
    .bus_voltage_mV = 53000,
    .battery_voltage_mV = 53000,
    .battery_current_mA = MONITOR_GAIN_NOT_GIVEN,
    .speed_mrad_s = 30000,
    .winding_temperature_cC = 2500,
    .switch_temperature_cC = 2500,
    .u_q_mV = 14076, /* 30 rad/s * 23 * 20.4 mWb */
    .offset_q4 = {MID_OFFSET_Q4, MID_OFFSET_Q4, MID_OFFSET_Q4},
    .bridge = BRIDGE_PWM,
};

void setUp(void)
{
    rig_up(&HEALTHY);
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
    in.bus_voltage_mV = 45000;
    TEST_ASSERT_EQUAL_INT(REASON_NONE, run(WINDOW_ms - 1).flux_warning);
    TEST_ASSERT_EQUAL_INT(REASON_BUS_SENSOR, step().flux_warning);
    in.battery_open = true;
    TEST_ASSERT_EQUAL_INT(REASON_NONE, run(1000).flux_warning);
    setUp();
    in.bus_voltage_mV = 61000; /* beyond its trip: nothing is known of the battery */
    in.battery_voltage_mV = 50000;
    TEST_ASSERT_EQUAL_INT(REASON_NONE, run(1000).flux_warning);
    setUp();
    in.battery_voltage_mV = 0;
    in.bus_voltage_mV = 45000;
    TEST_ASSERT_EQUAL_INT(REASON_NONE, run(1000).flux_warning);
}

void test_flux_is_named_weak_or_as_a_bus_voltage_that_reads_high(void)
{
    TEST_ASSERT_EQUAL_INT(REASON_NONE, run(1000).flux_warning);
    in.u_q_mV = 7000;
    TEST_ASSERT_EQUAL_INT(REASON_FLUX_WEAK, run(1000).flux_warning);
    /* While the message contradicts the bus voltage, the EMF says nothing of the flux. */
    in.battery_voltage_mV = 40000;
    TEST_ASSERT_EQUAL_INT(REASON_NONE, step().flux_warning);
    TEST_ASSERT_EQUAL_INT(REASON_BUS_SENSOR, run(WINDOW_ms).flux_warning);
    setUp();
    in.u_q_mV = 21000;
    TEST_ASSERT_EQUAL_INT(REASON_BUS_SENSOR, run(1000).flux_warning);
}

/* Without the message a bus voltage that reads low may be the cause. */
void test_flux_that_is_missing_is_a_figure_only_beside_a_message_of_the_bus_voltage(void)
{
    in.u_q_mV = 7000;
    TEST_ASSERT_GREATER_THAN_INT32(0, run(1000).flux_missing_q15);
    in.battery_voltage_mV = 0;
    const monitor_output_t alone = step();
    TEST_ASSERT_EQUAL_INT(REASON_FLUX_WEAK, alone.flux_warning);
    TEST_ASSERT_EQUAL_INT32(0, alone.flux_missing_q15);
}

/* ---- currents ---- */

void test_missing_current_is_a_fault_with_pwm_within_the_voltage(void)
{
    in.reference_pu.q = 10000;
    TEST_ASSERT_EQUAL_INT(REASON_NONE, run(2).fault);
    TEST_ASSERT_EQUAL_INT(REASON_CURRENT_SENSOR, step().fault);
    in.bridge = BRIDGE_OFF;
    TEST_ASSERT_EQUAL_INT(REASON_NONE, run(100).fault);
    setUp();
    in.reference_pu.q = 10000;
    in.voltage_limited = true;
    TEST_ASSERT_EQUAL_INT(REASON_NONE, run(100).fault);
    setUp();
    in.reference_pu.q = 10000;
    in.sampled_pu.q = 10000;
    in.latest_pu.q = 10000;
    TEST_ASSERT_EQUAL_INT(REASON_NONE, run(100).fault);
}

void test_gain_of_the_current_sensors_is_a_fault_where_it_can_be_compared(void)
{
    in.bus_current_mA = 100000;
    in.battery_current_mA = 50000;
    TEST_ASSERT_EQUAL_INT(REASON_NONE, run(WINDOW_ms - 1).fault);
    TEST_ASSERT_EQUAL_INT(REASON_CURRENT_GAIN, step().fault);
    in.bridge = BRIDGE_OFF;
    TEST_ASSERT_EQUAL_INT(REASON_NONE, run(1000).fault);
    in.bridge = BRIDGE_PWM;
    in.battery_open = true;
    TEST_ASSERT_EQUAL_INT(REASON_NONE, run(1000).fault);
    in.battery_open = false;
    in.battery_current_mA = MONITOR_GAIN_NOT_GIVEN;
    TEST_ASSERT_EQUAL_INT(REASON_NONE, run(1000).fault);
}

/* Without PWM: 15/16 of the range is a sensor at its rail, less is a sum. */
void test_sum_at_the_end_of_the_range_is_exact(void)
{
    in.bridge = BRIDGE_OFF;
    for (int sign = -1; sign <= 1; sign += 2) {
        in.current_sum_pu = sign * 30720;
        TEST_ASSERT_EQUAL_INT(REASON_CURRENT_SUM, run(100).fault);
        in.current_sum_pu = sign * 30721;
        TEST_ASSERT_EQUAL_INT(REASON_CURRENT_SENSOR, run(100).fault);
        in.offsets_known = false;
        TEST_ASSERT_EQUAL_INT(REASON_NONE, run(100).fault);
        in.offsets_known = true;
    }
}

void test_a_sum_whose_sensor_has_a_name_is_no_fault_either_way(void)
{
    in.current_undetermined = true;
    in.wrong_current_sensor = 2;
    TEST_ASSERT_EQUAL_INT(REASON_NONE, run(100).fault);
    in.wrong_current_sensor = 0;
    TEST_ASSERT_EQUAL_INT(REASON_CURRENT_SUM, step().fault);
}

/* ---- a switch that is stuck ---- */

/* Half waves of half the trip current in phase a, `sign` along it, for two windows. */
static monitor_output_t half_waves_after(reason_t trip, int sign)
{
    in.fast_trip = trip;
    in.bridge = BRIDGE_OFF;
    for (int ms = 0; ms < 30; ms++) {
        in.idle_alpha_pu +=
            (uint32_t)(sign * FAST_PER_SLOW * config.monitor.overcurrent_pu_q15 / 2);
        const monitor_output_t out = step();
        if (out.safe_bridge != BRIDGE_OFF) {
            return out;
        }
    }
    return step();
}

static monitor_output_t half_waves(int sign)
{
    return half_waves_after(REASON_HARDWARE_BREAK, sign);
}

/* Found while coasting: a fault of the power stage, until the wheel is at rest. */
void test_half_waves_without_a_trip_are_a_fault_of_the_power_stage(void)
{
    for (int sign = -1; sign <= 1; sign += 2) {
        setUp();
        monitor_output_t out = half_waves_after(REASON_NONE, sign);
        TEST_ASSERT_EQUAL_INT(sign > 0 ? BRIDGE_SHORT_HIGH : BRIDGE_SHORT, out.safe_bridge);
        TEST_ASSERT_EQUAL_INT(REASON_HARDWARE_BREAK, out.fault);
        TEST_ASSERT_FALSE(out.release_break);
        in.fast_trip = REASON_OVERCURRENT; /* the trip has its own name */
        TEST_ASSERT_EQUAL_INT(REASON_OVERCURRENT, step().fault);
    }
}

/* Frozen readings have a mean that is no current. */
void test_readings_that_a_trip_has_called_wrong_show_no_stuck_switch(void)
{
    TEST_ASSERT_EQUAL_INT(BRIDGE_SHORT_HIGH, half_waves_after(REASON_OVERCURRENT, 1).safe_bridge);
    setUp();
    TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, half_waves_after(REASON_CURRENT_SENSOR, 1).safe_bridge);
}

void test_stuck_switch_calls_for_the_short_circuit_on_its_side(void)
{
    monitor_output_t out = half_waves(1);
    TEST_ASSERT_EQUAL_INT(BRIDGE_SHORT_HIGH, out.safe_bridge);
    TEST_ASSERT_TRUE(out.release_break && out.emf_conducts && out.safe_torque_mNm > 0);
    TEST_ASSERT_EQUAL_INT32(0, out.charging_mA);
    setUp();
    out = half_waves(-1);
    TEST_ASSERT_EQUAL_INT(BRIDGE_SHORT, out.safe_bridge);
    in.fast_trip = REASON_NONE; /* acknowledged */
    out = step();
    TEST_ASSERT_FALSE(out.release_break);
}

void test_stuck_switch_needs_sensors_that_are_good(void)
{
    for (int part = 0; part < 6; part++) {
        setUp();
        in.offsets_known = part != 1;
        in.wrong_current_sensor = part == 2 ? 3 : 0;
        in.rotor_valid = part != 3;
        const int32_t sum_pu = config.monitor.current_sum_pu_q15 + (part < 4 ? 0 : 1);
        in.current_sum_pu = part == 5 ? -sum_pu : sum_pu;
        const bridge_mode_t expected = part == 0 ? BRIDGE_SHORT_HIGH : BRIDGE_OFF;
        TEST_ASSERT_EQUAL_INT(expected, half_waves(1).safe_bridge);
    }
}

/* ---- torque that the voltage forces ---- */

static void assert_unwanted(int32_t speed_mrad_s, int32_t estimate_mNm, bool unwanted)
{
    setUp();
    in.voltage_limited = true; /* the angle is not this test's */
    in.speed_mrad_s = speed_mrad_s;
    in.torque_estimate_mNm = estimate_mNm;
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
    in.bridge = BRIDGE_OFF;
    monitor_output_t out = step();
    TEST_ASSERT_FALSE(out.emf_conducts);
    TEST_ASSERT_EQUAL_INT32(0, out.charging_mA);
    TEST_ASSERT_EQUAL_INT32(0, out.safe_torque_mNm);
    in.speed_mrad_s = 70000; /* 56.9 V, beyond 50 V and two diodes */
    in.bus_voltage_mV = 50000;
    in.battery_voltage_mV = 50000;
    in.charge_current_mA = 1000000;
    out = step();
    const safe_state_input_t turning = {.speed_mrad_s = 70000,
                                        .winding_temperature_cC = 2500,
                                        .bus_voltage_mV = 50000,
                                        .charge_current_mA = 1000000};
    const letting_go_t off = freewheel_of(&config, &turning);
    TEST_ASSERT_TRUE(off.charging_mA > 0 && off.torque_mNm > 0);
    TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, out.safe_bridge);
    TEST_ASSERT_TRUE(out.emf_conducts);
    TEST_ASSERT_EQUAL_INT32(off.charging_mA, out.charging_mA);
    TEST_ASSERT_EQUAL_INT32(off.torque_mNm, out.safe_torque_mNm);
    in.battery_open = true; /* nothing takes a current */
    out = step();
    TEST_ASSERT_FALSE(out.emf_conducts);
    TEST_ASSERT_EQUAL_INT32(0, out.charging_mA);
}

void test_rest_and_standstill_are_below_the_configured_speed(void)
{
    config.monitor.standstill_mrad_s = 500;
    in.u_q_mV = 0;
    in.speed_mrad_s = 500;
    monitor_output_t out = step();
    TEST_ASSERT_FALSE(out.at_rest || out.standstill);
    TEST_ASSERT_EQUAL_INT32(500, out.speed_bound_mrad_s);
    in.speed_mrad_s = 499;
    out = run(100);
    TEST_ASSERT_TRUE(out.at_rest && out.standstill);
}

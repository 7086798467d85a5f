/* SPDX-License-Identifier: Apache-2.0 */
/* Times, margins and tolerances of the monitor are those of the configuration. */
#include "monitor/monitor_fast.h"
#include "monitor_rig.h"

void setUp(void)
{
    rig_up(&SWITCHING);
}

void tearDown(void) {}

void test_sensor_fault_time_qualifies_currents_and_temperatures(void)
{
    config.monitor.sensor_fault_time_ms = 7;
    in.report.current_sum_pu = 32767;
    assert_fault_after(7, REASON_CURRENT_SUM);
    in.report.adc_saturated = true;
    assert_fault_after(7, REASON_CURRENT_SENSOR);
    in.shown.winding_cC = 25000;
    TEST_ASSERT_EQUAL_INT(REASON_NONE, run(6).warning);
    TEST_ASSERT_EQUAL_INT(REASON_WINDING_OVERTEMPERATURE, step().warning);
}

void test_voltage_fault_time_qualifies_the_bus_voltage(void)
{
    config.monitor.voltage_fault_time_ms = 40;
    config.monitor.battery_message_time_ms = 60;
    in.now.bus_voltage_mV = config.battery.overvoltage_trip_mV + 1;
    assert_fault_after(60, REASON_BUS_OVERVOLTAGE);
    in.now.bus_voltage_mV = config.battery.undervoltage_trip_mV - 1;
    assert_fault_after(60 + 40, REASON_BUS_UNDERVOLTAGE);
}

void test_rotor_fault_time_begins_after_the_torque_ramp(void)
{
    config.motor.max_torque_mNm = 40000;
    config.brake.torque_rate_mNm_s = 400000; /* 100 ms to zero */
    config.monitor.rotor_fault_time_ms = 30;
    in.now.angle_valid = false;
    assert_fault_after(100 + 30, REASON_ROTOR_LOST);
}

void test_angle_fault_time_qualifies_an_angle_against_the_back_emf(void)
{
    monitor_case_t turned = TURNING;
    turned.now.latest_u_d_mV = turned.now.latest_u_q_mV; /* the EMF on the wrong axis */
    turned.now.latest_u_q_mV = 0;
    monitor_emf_state_t level = {.level = 0};
    config.rotor.sensor = CONFIG_ROTOR_ANGLE; /* whose speed is known at once */
    config.monitor.angle_fault_time_ms = 9;
    for (int n = 1; n < 9; n++) {
        TEST_ASSERT_FALSE(monitor_emf_step(&level, &config, measured_of(&turned)));
    }
    TEST_ASSERT_TRUE(monitor_emf_step(&level, &config, measured_of(&turned)));
}

void test_rotor_warning_time_heals_the_warning(void)
{
    config.monitor.rotor_warning_time_ms = 25;
    in.report.rotor_faults = 1;
    for (int n = 0; n < 25; n++) {
        TEST_ASSERT_EQUAL_INT(REASON_ROTOR_UNCERTAIN, step().warning);
    }
    TEST_ASSERT_EQUAL_INT(REASON_NONE, step().warning);
}

void test_overtemperature_margin_lies_above_the_end_of_the_derating(void)
{
    config.motor.max_winding_temperature_cC = 15000;
    config.monitor.overtemperature_margin_cC = 250;
    in.shown.winding_cC = 15250;
    TEST_ASSERT_EQUAL_INT(REASON_NONE, run(100).warning);
    in.shown.winding_cC = 15251;
    TEST_ASSERT_EQUAL_INT(REASON_WINDING_OVERTEMPERATURE, run(20).warning);
}

/* What the bound falls by in a second, rad/s, from 60 rad/s at a wheel of 0.25 m. */
static int32_t fall_in_a_second_mrad_s(bool angle_valid)
{
    monitor_speed_state_t bound = {.windows = 0};
    monitor_case_t seen = TURNING;
    seen.now.speed_mrad_s = 60000;
    const int32_t before_mrad_s = monitor_speed_step(&bound, &config, measured_of(&seen));
    seen.now.speed_mrad_s = 0;
    seen.now.angle_valid = angle_valid;
    int32_t now_mrad_s = before_mrad_s;
    for (int n = 0; n < 1000; n++) {
        now_mrad_s = monitor_speed_step(&bound, &config, measured_of(&seen));
    }
    return before_mrad_s - now_mrad_s;
}

void test_the_speed_bound_falls_with_tyre_grip_or_coasting(void)
{
    config.monitor.tyre_grip_mm_s2 = 5000; /* 5 m/s^2 over 0.25 m */
    config.monitor.coasting_mm_s2 = 500;
    TEST_ASSERT_INT32_WITHIN(20, 20000, fall_in_a_second_mrad_s(true));
    TEST_ASSERT_INT32_WITHIN(20, 2000, fall_in_a_second_mrad_s(false));
}

void test_standstill_is_below_the_configured_speed(void)
{
    config.monitor.standstill_mrad_s = 1000;
    in.now.speed_mrad_s = 1000;
    TEST_ASSERT_FALSE(step().monitored.standstill);
    in.now.speed_mrad_s = 999;
    TEST_ASSERT_TRUE(run(1000).monitored.standstill);
}

void test_diode_fault_time_qualifies_a_current_in_freewheel(void)
{
    monitor_speed_state_t bound = {.windows = 0};
    const monitor_case_t conducting = {
        .report = {.offsets_done = true, .bridge = BRIDGE_OFF},
        .now = {.latest_i_q_mA = 30000, .bus_voltage_mV = 53000},
    };
    config.monitor.diode_fault_time_ms = 3;
    TEST_ASSERT_EQUAL_INT32(0, monitor_speed_step(&bound, &config, measured_of(&conducting)));
    TEST_ASSERT_EQUAL_INT32(0, monitor_speed_step(&bound, &config, measured_of(&conducting)));
    /* 53 V / (sqrt(3) 20.4 mWb 23) = 65.2 rad/s, and 2 % more */
    TEST_ASSERT_INT32_WITHIN(200, 66520,
                             monitor_speed_step(&bound, &config, measured_of(&conducting)));
}

void test_an_over_current_trips_after_the_configured_periods_in_a_row(void)
{
    const int32_t most[] = {1, 4, 16};
    for (int k = 0; k < 3; k++) {
        config.monitor.overcurrent_periods = most[k];
        monitor_fast_state_t fast;
        monitor_fast_init(&fast, &config);
        monitor_fast_input_t seen = {.v_dc_pu = 28102, .switching = true};
        for (int32_t n = 0; n < 3 * most[k]; n++) { /* never so many in a row */
            const bool last = n % most[k] == most[k] - 1;
            seen.i_pu.v = q_pair(0, last ? 0 : config.monitor.overcurrent_pu_q15 + 1);
            TEST_ASSERT_EQUAL_INT(REASON_NONE, monitor_fast_step(&fast, &seen));
        }
        seen.i_pu.v = q_pair(0, config.monitor.overcurrent_pu_q15 + 1);
        for (int32_t n = 1; n < most[k]; n++) {
            TEST_ASSERT_EQUAL_INT(REASON_NONE, monitor_fast_step(&fast, &seen));
        }
        TEST_ASSERT_EQUAL_INT(REASON_OVERCURRENT, monitor_fast_step(&fast, &seen));
    }
}

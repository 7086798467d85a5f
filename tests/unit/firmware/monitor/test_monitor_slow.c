/* SPDX-License-Identifier: Apache-2.0 */
#include "random_values.h"
#include "watched.h"

enum {
    TOLERANCE_mNm = 4000,
    TORQUE_TIME_ms = 50,
    MID_OFFSET_Q4 = 2048 * 16,
    OFFSET_TOLERANCE_Q4 = 200 * 16
};

static const monitor_slow_input_t HEALTHY = {
    .fast_trip = REASON_NONE,
    .current_sum_pu = 0,
    .offsets_known = true,
    .current_saturated = false,
    .rotor_valid = true,
    .rotor_faults = 0,
    .fast_step_count = 0,
    .bus_voltage_mV = 53000,
    .speed_mrad_s = 30000,
    .winding_temperature_cC = 2500,
    .switch_temperature_cC = 2500,
    .u_q_mV = 14076, /* 30 rad/s * 23 * 20.4 mWb */
    .torque_command_mNm = 10000,
    .torque_estimate_mNm = 10000,
    .offset_q4 = {MID_OFFSET_Q4, MID_OFFSET_Q4, MID_OFFSET_Q4},
    .bridge = BRIDGE_PWM,
    .switching = true,
};

void setUp(void)
{
    watch(&HEALTHY);
    config.monitor.torque_tolerance_mNm = TOLERANCE_mNm;
    config.monitor.torque_fault_time_ms = TORQUE_TIME_ms;
    config.monitor.offset_tolerance_codes = 200;
    config.motor.max_winding_temperature_cC = 15000;
    config.drive.max_switch_temperature_cC = 10000;
    config.battery.overvoltage_trip_mV = 60564;
    config.battery.undervoltage_trip_mV = 36000;
}

void tearDown(void) {}

void test_a_healthy_drive_has_neither_fault_nor_warning(void)
{
    for (int n = 0; n < 10000; n++) { /* the fast loop's counter wraps three times */
        const monitor_output_t out = step();
        TEST_ASSERT_EQUAL_INT(REASON_NONE, out.fault);
        TEST_ASSERT_EQUAL_INT(REASON_NONE, out.warning);
    }
}

void test_a_trip_of_the_fast_part_is_a_fault_at_once(void)
{
    in.fast_trip = REASON_OVERCURRENT;
    TEST_ASSERT_EQUAL_INT(REASON_OVERCURRENT, step().fault);
}

/* ---- currents ---- */

void test_currents_that_do_not_add_up_to_zero_are_a_fault(void)
{
    in.current_sum_pu = config.monitor.current_sum_pu_q15 + 1;
    assert_fault_after(20, REASON_CURRENT_SUM);
    in.current_sum_pu = -(config.monitor.current_sum_pu_q15 + 1);
    assert_fault_after(20, REASON_CURRENT_SUM);
    in.current_sum_pu = config.monitor.current_sum_pu_q15;
    assert_never_a_fault();
}

void test_a_sum_of_sensors_whose_zeros_are_not_known_yet_is_no_fault(void)
{
    in.current_sum_pu = 32767;
    in.offsets_known = false;
    assert_never_a_fault();
}

void test_a_sum_that_is_wrong_now_and_then_is_noise(void)
{
    for (int n = 0; n < 1000; n++) {
        in.current_sum_pu = n % 20 == 19 ? 0 : config.monitor.current_sum_pu_q15 + 1;
        TEST_ASSERT_EQUAL_INT(REASON_NONE, step().fault);
    }
}

void test_a_sensor_at_the_end_of_its_range_is_a_fault_while_the_bridge_switches(void)
{
    in.current_saturated = true;
    assert_fault_after(20, REASON_CURRENT_SENSOR);
    in.current_saturated = true;
    in.switching = false;
    assert_never_a_fault();
}

void test_zero_current_codes_are_plausible_within_the_tolerance_and_not_beyond(void)
{
    for (int x = 0; x < 3; x++) {
        const int32_t edge[] = {-OFFSET_TOLERANCE_Q4, OFFSET_TOLERANCE_Q4};
        for (int k = 0; k < 2; k++) {
            in.offset_q4[x] = MID_OFFSET_Q4 + edge[k];
            TEST_ASSERT_TRUE(step().offsets_plausible);
            in.offset_q4[x] += edge[k] > 0 ? 1 : -1;
            TEST_ASSERT_FALSE(step().offsets_plausible);
            in.offset_q4[x] = MID_OFFSET_Q4;
        }
    }
}

/* ---- rotor ---- */

void test_a_lost_rotor_is_a_fault_while_the_bridge_switches(void)
{
    in.rotor_valid = false;
    /* 40 Nm leave at 400 Nm/s in 100 ms; only after them may the valve close. */
    config.motor.max_torque_mNm = 40000;
    config.brake.torque_rate_mNm_s = 400000;
    assert_fault_after(100 + 250, REASON_ROTOR_LOST);
    in.rotor_valid = false;
    in.switching = false;
    assert_never_a_fault();
}

void test_a_skipped_hall_sector_is_a_warning_of_ten_seconds_and_no_fault(void)
{
    in.rotor_faults = 1;
    for (int n = 0; n < 10000; n++) {
        const monitor_output_t out = step();
        TEST_ASSERT_EQUAL_INT(REASON_ROTOR_UNCERTAIN, out.warning);
        TEST_ASSERT_EQUAL_INT(REASON_NONE, out.fault);
    }
    TEST_ASSERT_EQUAL_INT(REASON_NONE, step().warning);
}

void test_a_dead_hall_sensor_keeps_the_warning_up_for_ever(void)
{
    in.rotor_faults = 1;
    for (int n = 1; n < 1000000; n++) { /* a sector in ten milliseconds: the counter wraps */
        in.rotor_faults = (uint16_t)(in.rotor_faults + (n % 10 == 0 ? 1 : 0));
        TEST_ASSERT_EQUAL_INT(REASON_ROTOR_UNCERTAIN, step().warning);
    }
}

/* ---- bus voltage ---- */

void test_over_voltage_is_a_fault_whether_the_bridge_switches_or_not(void)
{
    in.bus_voltage_mV = 60565;
    assert_fault_after(5, REASON_BUS_OVERVOLTAGE);
    in.bus_voltage_mV = 60565;
    in.switching = false;
    assert_fault_after(5, REASON_BUS_OVERVOLTAGE);
    in.bus_voltage_mV = 60564;
    assert_never_a_fault();
}

void test_under_voltage_is_a_fault_only_while_the_bridge_switches(void)
{
    in.bus_voltage_mV = 35999;
    assert_fault_after(5, REASON_BUS_UNDERVOLTAGE);
    in.bus_voltage_mV = 35999;
    in.switching = false;
    assert_never_a_fault();
    in.bus_voltage_mV = 36000;
    assert_never_a_fault();
}

/* ---- torque ---- */

static void torque(int32_t command_mNm, int32_t estimate_mNm)
{
    in.torque_command_mNm = command_mNm;
    in.torque_estimate_mNm = estimate_mNm;
}

void test_more_torque_than_commanded_is_a_fault_in_either_direction(void)
{
    torque(10000, 10000 + TOLERANCE_mNm + 1);
    assert_fault_after(TORQUE_TIME_ms, REASON_TORQUE_IMPLAUSIBLE);
    torque(-10000, -10000 - TOLERANCE_mNm - 1);
    assert_fault_after(TORQUE_TIME_ms, REASON_TORQUE_IMPLAUSIBLE);
    torque(10000, 10000 + TOLERANCE_mNm);
    assert_never_a_fault();
    torque(-10000, -10000 - TOLERANCE_mNm);
    assert_never_a_fault();
}

void test_torque_against_the_command_is_a_fault(void)
{
    torque(10000, -TOLERANCE_mNm - 1);
    assert_fault_after(TORQUE_TIME_ms, REASON_TORQUE_IMPLAUSIBLE);
    torque(-10000, TOLERANCE_mNm + 1);
    assert_fault_after(TORQUE_TIME_ms, REASON_TORQUE_IMPLAUSIBLE);
}

void test_torque_without_a_command_is_a_fault(void)
{
    torque(0, TOLERANCE_mNm + 1);
    assert_fault_after(TORQUE_TIME_ms, REASON_TORQUE_IMPLAUSIBLE);
    torque(0, -TOLERANCE_mNm - 1);
    assert_fault_after(TORQUE_TIME_ms, REASON_TORQUE_IMPLAUSIBLE);
}

void test_less_torque_than_commanded_is_no_fault(void)
{
    torque(40000, 0);
    assert_never_a_fault();
    torque(-40000, 0);
    assert_never_a_fault();
}

void test_torque_of_a_bridge_at_rest_is_nobody_s_fault(void)
{
    torque(0, -20000); /* a short brakes */
    in.switching = false;
    assert_never_a_fault();
}

/* ---- program flow ---- */

void test_a_fast_loop_that_stands_still_is_a_fault_after_five_milliseconds(void)
{
    step();
    fast_steps_per_slow = 0;
    for (int n = 1; n < 5; n++) {
        TEST_ASSERT_EQUAL_INT(REASON_NONE, step().fault);
    }
    TEST_ASSERT_EQUAL_INT(REASON_PROGRAM_FLOW, step().fault);
    fast_steps_per_slow = FAST_PER_SLOW;
}

void test_the_fast_loop_may_be_a_quarter_off_its_rate_and_no_more(void)
{
    const uint16_t good[] = {15, 25};
    const uint16_t bad[] = {14, 26, 40};
    for (int k = 0; k < 2; k++) {
        setUp();
        fast_steps_per_slow = good[k];
        TEST_ASSERT_EQUAL_INT(REASON_NONE, run(100).fault);
    }
    for (int k = 0; k < 3; k++) {
        setUp();
        fast_steps_per_slow = bad[k];
        TEST_ASSERT_EQUAL_INT(REASON_PROGRAM_FLOW, run(100).fault);
    }
    fast_steps_per_slow = FAST_PER_SLOW;
}

void test_a_single_late_slow_step_is_no_fault(void)
{
    run(10);
    in.fast_step_count = (uint16_t)(in.fast_step_count + 40);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, run(100).fault);
}

void test_the_first_step_cannot_know_how_far_the_fast_loop_had_counted(void)
{
    in.fast_step_count = 12345;
    TEST_ASSERT_EQUAL_INT(REASON_NONE, run(10).fault);
    setUp();
    fast_steps_per_slow = 0;
    TEST_ASSERT_EQUAL_INT(REASON_NONE, run(5).fault); /* the first of these five does not count */
    TEST_ASSERT_EQUAL_INT(REASON_PROGRAM_FLOW, step().fault);
    fast_steps_per_slow = FAST_PER_SLOW;
}

void test_every_verdict_is_counted_so_that_a_watchdog_can_see_the_monitor_live(void)
{
    const uint16_t before = state.steps;
    run(100);
    TEST_ASSERT_EQUAL_UINT16((uint16_t)(before + 100), state.steps);
}

/* ---- which of several ---- */

void test_a_cause_is_named_before_its_consequences(void)
{
    const reason_t order[] = {REASON_OVERCURRENT,        REASON_PROGRAM_FLOW,
                              REASON_CURRENT_SENSOR,     REASON_CURRENT_SUM,
                              REASON_BUS_OVERVOLTAGE,    REASON_ROTOR_LOST,
                              REASON_TORQUE_IMPLAUSIBLE, REASON_WINDING_OVERTEMPERATURE};
    in.fast_trip = REASON_OVERCURRENT;
    in.current_saturated = true;
    in.current_sum_pu = 32767;
    in.bus_voltage_mV = 61000;
    in.rotor_valid = false;
    torque(0, 40000);
    in.winding_temperature_cC = 20000;
    fast_steps_per_slow = 0;
    TEST_ASSERT_EQUAL_INT(order[0], run(400).fault);
    in.fast_trip = REASON_NONE;
    TEST_ASSERT_EQUAL_INT(order[1], step().fault);
    fast_steps_per_slow = FAST_PER_SLOW;
    TEST_ASSERT_EQUAL_INT(order[2], step().fault);
    in.current_saturated = false;
    TEST_ASSERT_EQUAL_INT(order[3], step().fault);
    in.current_sum_pu = 0;
    TEST_ASSERT_EQUAL_INT(order[4], step().fault);
    in.bus_voltage_mV = 53000;
    TEST_ASSERT_EQUAL_INT(order[5], step().fault);
    in.rotor_valid = true;
    TEST_ASSERT_EQUAL_INT(order[6], step().fault);
    torque(0, 0);
    TEST_ASSERT_EQUAL_INT(order[7], step().fault);
}

void test_no_number_from_outside_leads_to_undefined_behaviour(void)
{
    /* The assertion is the sanitizer's. */
    random_t random = random_seeded(2);
    for (int n = 0; n < 100000; n++) {
        in.current_sum_pu = random_wild(&random);
        in.fast_step_count = (uint16_t)random_u64(&random);
        in.bus_voltage_mV = random_wild(&random);
        in.i_d_mA = random_wild(&random);
        in.i_q_mA = random_wild(&random);
        in.current_quarters = (uint16_t)random_u64(&random);
        in.quarter_step = (uint16_t)random_u64(&random);
        in.bridge = (bridge_mode_t)random_between(&random, 0, 2);
        in.speed_mrad_s = random_wild(&random);
        in.winding_temperature_cC = random_wild(&random);
        in.switch_temperature_cC = random_wild(&random);
        torque(random_wild(&random), random_wild(&random));
        in.offset_q4[random_between(&random, 0, 2)] = random_wild(&random);
        const monitor_output_t out = monitor_slow_step(&state, &config, &in);
        TEST_ASSERT_NOT_EQUAL_INT(BRIDGE_PWM, out.safe_bridge);
    }
}

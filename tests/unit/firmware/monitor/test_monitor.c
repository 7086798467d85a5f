/* SPDX-License-Identifier: Apache-2.0 */
#include "monitor_rig.h"
#include "random_values.h"

enum { TOLERANCE_mNm = 4000, TORQUE_TIME_ms = 50, OFFSET_TOLERANCE_Q4 = 200 * 16 };

void setUp(void)
{
    rig_up(&TURNING);
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
        const shown_t out = step();
        TEST_ASSERT_EQUAL_INT(REASON_NONE, out.fault);
        TEST_ASSERT_EQUAL_INT(REASON_NONE, out.warning);
    }
}

void test_trip_of_the_fast_monitor_is_a_fault_in_the_same_step(void)
{
    in.now.trip = REASON_OVERCURRENT;
    TEST_ASSERT_EQUAL_INT(REASON_OVERCURRENT, step().fault);
}

/* ---- currents ---- */

void test_sum_of_phase_currents_away_from_zero_is_a_fault(void)
{
    in.report.current_sum_pu = config.monitor.current_sum_pu_q15 + 1;
    assert_fault_after(20, REASON_CURRENT_SUM);
    in.report.current_sum_pu = -(config.monitor.current_sum_pu_q15 + 1);
    assert_fault_after(20, REASON_CURRENT_SUM);
    in.report.current_sum_pu = config.monitor.current_sum_pu_q15;
    assert_never_a_fault();
}

void test_named_current_sensor_is_a_warning_and_no_fault(void)
{
    static const reason_t REASONS[] = {REASON_CURRENT_SENSOR_A, REASON_CURRENT_SENSOR_B,
                                       REASON_CURRENT_SENSOR_C};
    in.report.current_sum_pu = config.monitor.current_sum_pu_q15 + 1;
    for (uint8_t k = 0; k < 3; k++) {
        in.report.wrong_current_sensor = (uint8_t)(k + 1);
        const shown_t out = run(100);
        TEST_ASSERT_EQUAL_INT(REASONS[k], out.warning);
        TEST_ASSERT_EQUAL_INT(REASON_NONE, out.fault);
    }
}

void test_undetermined_sum_of_currents_is_a_fault_at_once(void)
{
    in.report.current_undetermined = true;
    TEST_ASSERT_EQUAL_INT(REASON_CURRENT_SUM, step().fault);
}

void test_current_sum_is_no_fault_before_the_offsets_are_known(void)
{
    in.report.current_sum_pu = 32767;
    in.report.offsets_done = false;
    assert_never_a_fault();
}

void test_occasional_deviations_of_the_current_sum_are_no_fault(void)
{
    for (int n = 0; n < 1000; n++) {
        in.report.current_sum_pu = n % 20 == 19 ? 0 : config.monitor.current_sum_pu_q15 + 1;
        TEST_ASSERT_EQUAL_INT(REASON_NONE, step().fault);
    }
}

void test_adc_saturation_is_a_fault_while_the_bridge_switches(void)
{
    in.report.adc_saturated = true;
    assert_fault_after(20, REASON_CURRENT_SENSOR);
    in.report.adc_saturated = true;
    in.report.bridge = BRIDGE_OFF;
    assert_never_a_fault();
}

void test_current_offsets_are_plausible_within_the_tolerance(void)
{
    for (int x = 0; x < 3; x++) {
        const int32_t edge[] = {-OFFSET_TOLERANCE_Q4, OFFSET_TOLERANCE_Q4};
        for (int k = 0; k < 2; k++) {
            in.report.offset_q4[x] = MID_OFFSET_Q4 + edge[k];
            TEST_ASSERT_TRUE(step().monitored.offsets_plausible);
            in.report.offset_q4[x] += edge[k] > 0 ? 1 : -1;
            TEST_ASSERT_FALSE(step().monitored.offsets_plausible);
            in.report.offset_q4[x] = MID_OFFSET_Q4;
        }
    }
}

/* ---- rotor ---- */

void test_invalid_rotor_angle_is_a_fault_while_the_bridge_switches(void)
{
    in.now.angle_valid = false;
    /* 40 Nm fall to zero at 400 Nm/s in 100 ms. The torque enable is withdrawn only after that. */
    config.motor.max_torque_mNm = 40000;
    config.brake.torque_rate_mNm_s = 400000;
    assert_fault_after(100 + 250, REASON_ROTOR_LOST);
    in.now.angle_valid = false;
    in.report.bridge = BRIDGE_OFF;
    assert_never_a_fault();
}

void test_skipped_hall_sector_is_a_warning_for_ten_seconds(void)
{
    in.report.rotor_faults = 1;
    for (int n = 0; n < 10000; n++) {
        const shown_t out = step();
        TEST_ASSERT_EQUAL_INT(REASON_ROTOR_UNCERTAIN, out.warning);
        TEST_ASSERT_EQUAL_INT(REASON_NONE, out.fault);
    }
    TEST_ASSERT_EQUAL_INT(REASON_NONE, step().warning);
}

void test_dead_hall_sensor_keeps_the_warning(void)
{
    in.report.rotor_faults = 1;
    for (int n = 1; n < 10000; n++) { /* the counter wraps */
        in.report.rotor_faults = (uint16_t)(in.report.rotor_faults + (n % 10 == 0 ? 97 : 0));
        TEST_ASSERT_EQUAL_INT(REASON_ROTOR_UNCERTAIN, step().warning);
    }
}

/* ---- bus voltage ---- */

void test_overvoltage_is_a_fault_with_and_without_pwm(void)
{
    in.now.bus_voltage_mV = 60564;
    assert_never_a_fault();
    in.now.bus_voltage_mV = 60565;
    assert_fault_after(300, REASON_BUS_OVERVOLTAGE);
    in.now.bus_voltage_mV = 60565;
    in.report.bridge = BRIDGE_OFF;
    assert_fault_after(300, REASON_BUS_OVERVOLTAGE);
}

/* An opening contactor: the bus rises at once, the battery's message comes later. */
void test_overvoltage_ends_torque_at_once_and_is_no_fault_once_the_contactor_is_open(void)
{
    in.now.bus_voltage_mV = 61000;
    in.now.trip = REASON_BUS_OVERVOLTAGE;
    in.report.bridge = BRIDGE_OFF;
    for (int n = 0; n < 299; n++) {
        const shown_t out = step();
        TEST_ASSERT_EQUAL_INT(REASON_NONE, out.fault);
        TEST_ASSERT_EQUAL_INT(REASON_BATTERY_DISCONNECTED, out.warning);
        TEST_ASSERT_TRUE(out.battery_lost);
        TEST_ASSERT_FALSE(out.monitored.release_trip);
    }
    in.battery.contactor = CONTACTOR_OPEN;
    const shown_t out = run(10000);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, out.fault);
    TEST_ASSERT_EQUAL_INT(REASON_BATTERY_DISCONNECTED, out.warning);
    TEST_ASSERT_TRUE(out.battery_lost);
}

void test_torque_returns_by_itself_a_tenth_of_a_second_after_the_bus_has_come_back(void)
{
    in.now.bus_voltage_mV = 61000;
    in.now.trip = REASON_BUS_OVERVOLTAGE;
    (void)run(10);
    in.now.bus_voltage_mV = 59482; /* the middle of 58.4 and 60.564 V */
    TEST_ASSERT_FALSE(step().monitored.release_trip);
    in.now.bus_voltage_mV = 59481;
    TEST_ASSERT_TRUE(step().monitored.release_trip);
    in.now.trip = REASON_NONE;
    TEST_ASSERT_TRUE(run(MONITOR_BUS_RETURN_STEPS - 1).battery_lost);
    const shown_t out = step();
    TEST_ASSERT_FALSE(out.battery_lost);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, out.warning);
}

void test_an_open_contactor_alone_takes_the_torque_and_is_a_warning(void)
{
    in.battery.contactor = CONTACTOR_OPEN;
    const shown_t out = step();
    TEST_ASSERT_TRUE(out.battery_lost);
    TEST_ASSERT_EQUAL_INT(REASON_BATTERY_DISCONNECTED, out.warning);
    in.now.bus_voltage_mV = 20000; /* nothing holds the bus */
    TEST_ASSERT_EQUAL_INT(REASON_NONE, run(1000).fault);
    in.battery.contactor = CONTACTOR_CLOSED;
    in.now.bus_voltage_mV = 53000;
    TEST_ASSERT_TRUE(run(MONITOR_BUS_RETURN_STEPS - 1).battery_lost);
    TEST_ASSERT_FALSE(step().battery_lost);
}

void test_no_torque_between_the_contacts_of_a_contactor_that_bounces(void)
{
    in.battery.contactor = CONTACTOR_OPEN;
    for (int n = 0; n < 1000; n++) {
        TEST_ASSERT_TRUE(step().battery_lost);
        in.battery.contactor = open_if(n / 20 % 2 == 0); /* 20 ms each */
    }
}

/* An opening contactor while the motors drive: the bus falls at once, and whatever current flows
 * while it does; the battery's message comes later. */
void test_low_bus_ends_torque_at_once_and_is_no_fault_once_the_contactor_is_open(void)
{
    in.now.bus_voltage_mV = 35999;
    TEST_ASSERT_TRUE(step().battery_lost);
    in.report.bridge = BRIDGE_OFF;
    in.now.trip = REASON_OVERCURRENT;
    in.now.bus_voltage_mV = 61000; /* the windings' energy */
    for (int n = 0; n < 200; n++) {
        const shown_t out = step();
        TEST_ASSERT_EQUAL_INT(REASON_NONE, out.fault);
        TEST_ASSERT_EQUAL_INT(REASON_BATTERY_DISCONNECTED, out.warning);
        TEST_ASSERT_FALSE(out.monitored.release_trip);
    }
    in.battery.contactor = CONTACTOR_OPEN;
    TEST_ASSERT_TRUE(step().monitored.release_trip);
    in.now.trip = REASON_NONE;
    const shown_t out = run(10000);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, out.fault);
    TEST_ASSERT_TRUE(out.battery_lost);
    in.battery.contactor = CONTACTOR_CLOSED;
    in.now.bus_voltage_mV = 53000;
    TEST_ASSERT_TRUE(run(MONITOR_BUS_RETURN_STEPS - 1).battery_lost);
    TEST_ASSERT_FALSE(step().battery_lost);
}

/* The current loop holds a bus between its trips that no battery holds. */
void test_bus_that_moves_as_no_battery_lets_it_ends_torque_and_is_no_fault(void)
{
    (void)run(100);
    for (int n = 0; n < 2; n++) { /* the image's battery: 6.4 V */
        in.now.bus_voltage_mV -= 3000;
        TEST_ASSERT_FALSE(step().battery_lost);
    }
    in.now.bus_voltage_mV += 3000;
    const shown_t lost = step();
    TEST_ASSERT_TRUE(lost.battery_lost);
    TEST_ASSERT_EQUAL_INT(REASON_BATTERY_DISCONNECTED, lost.warning);
    in.report.bridge = BRIDGE_OFF;
    in.now.bus_voltage_mV = 58000; /* the windings' energy */
    for (int n = 0; n < MONITOR_BUS_RETURN_STEPS - 1; n++) {
        const shown_t out = step();
        TEST_ASSERT_EQUAL_INT(REASON_NONE, out.fault);
        TEST_ASSERT_EQUAL_INT(REASON_BATTERY_DISCONNECTED, out.warning);
        TEST_ASSERT_FALSE(out.monitored.release_trip);
    }
    TEST_ASSERT_FALSE(step().battery_lost);
}

/* Without the message it is one: a phase that is shorted empties the bus as well. */
void test_overcurrent_on_a_low_bus_without_a_message_is_a_fault(void)
{
    in.now.bus_voltage_mV = 35999;
    in.now.trip = REASON_OVERCURRENT;
    in.report.bridge = BRIDGE_OFF;
    (void)step();
    in.now.bus_voltage_mV = 53000; /* and the bus comes back */
    TEST_ASSERT_EQUAL_INT(REASON_NONE, run(303).fault);
    TEST_ASSERT_NOT_EQUAL_INT(REASON_NONE, step().fault);
    in.battery.contactor = CONTACTOR_CLOSED;
}

void test_undervoltage_is_a_fault_only_while_the_bridge_switches(void)
{
    in.now.bus_voltage_mV = 35999;
    assert_fault_after(300 + 5, REASON_BUS_UNDERVOLTAGE);
    in.report.bridge = BRIDGE_OFF;
    in.now.bus_voltage_mV = 53000;
    (void)run(MONITOR_BUS_RETURN_STEPS);
    in.now.bus_voltage_mV = 35999;
    assert_never_a_fault();
    in.now.bus_voltage_mV = 36000;
    assert_never_a_fault();
}

/* ---- torque ---- */

static void torque(int32_t command_mNm, int32_t estimate_mNm)
{
    in.last.torque_command_mNm = command_mNm;
    in.last.torque_estimate_mNm = estimate_mNm;
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
    torque(10000, -TOLERANCE_mNm);
    assert_never_a_fault();
    torque(-10000, TOLERANCE_mNm);
    assert_never_a_fault();
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

void test_torque_without_pwm_is_no_fault(void)
{
    torque(0, -20000); /* a short brakes */
    in.report.bridge = BRIDGE_OFF;
    assert_never_a_fault();
}

/* With an empty bus any voltage forces; a wheel at standstill counts as one that turns forwards. */
void test_a_negative_torque_brakes_at_standstill_and_drives_a_wheel_that_rolls_back(void)
{
    torque(0, -TOLERANCE_mNm - 1);
    in.now.bus_voltage_mV = 0;
    in.now.speed_mrad_s = 0;
    TEST_ASSERT_EQUAL_INT(REASON_NONE, run(TORQUE_TIME_ms + 10).fault);
    in.now.speed_mrad_s = -1;
    TEST_ASSERT_EQUAL_INT(REASON_TORQUE_IMPLAUSIBLE, run(TORQUE_TIME_ms + 10).fault);
}

/* ---- watchdog ---- */

void test_monitor_counts_its_steps_for_the_watchdog(void)
{
    const uint16_t before = state.steps;
    run(100);
    TEST_ASSERT_EQUAL_UINT16((uint16_t)(before + 100), state.steps);
}

/* ---- priority of several faults ---- */

void test_cause_has_priority_over_its_consequences(void)
{
    const reason_t order[] = {
        REASON_OVERCURRENT,     REASON_PROGRAM_FLOW, REASON_CURRENT_SENSOR,    REASON_CURRENT_SUM,
        REASON_BUS_OVERVOLTAGE, REASON_ROTOR_LOST,   REASON_TORQUE_IMPLAUSIBLE};
    in.now.trip = REASON_OVERCURRENT;
    in.report.adc_saturated = true;
    in.report.current_sum_pu = 32767;
    in.now.bus_voltage_mV = 61000;
    in.now.angle_valid = false;
    torque(0, 40000);
    fast_steps_per_slow = 0;
    TEST_ASSERT_EQUAL_INT(order[0], run(400).fault);
    in.now.trip = REASON_NONE;
    TEST_ASSERT_EQUAL_INT(order[1], step().fault);
    fast_steps_per_slow = FAST_PER_SLOW;
    TEST_ASSERT_EQUAL_INT(order[2], step().fault);
    in.report.adc_saturated = false;
    TEST_ASSERT_EQUAL_INT(order[3], step().fault);
    in.report.current_sum_pu = 0;
    TEST_ASSERT_EQUAL_INT(order[4], step().fault);
    in.now.bus_voltage_mV = 53000;
    TEST_ASSERT_EQUAL_INT(order[5], step().fault);
    in.now.angle_valid = true;
    TEST_ASSERT_EQUAL_INT(order[6], step().fault);
}

void test_any_input_is_accepted(void)
{
    /* The sanitizer build detects undefined behaviour. */
    random_t random = random_seeded(2);
    for (int n = 0; n < 100000; n++) {
        in.report.current_sum_pu = random_wild(&random);
        in.report.sequence = (uint16_t)random_u64(&random);
        in.now.bus_voltage_mV = random_wild(&random);
        in.now.latest_i_d_mA = random_wild(&random);
        in.now.latest_i_q_mA = random_wild(&random);
        in.report.quadrant_transitions = (uint16_t)random_u64(&random);
        in.report.quadrant_step = (uint16_t)random_u64(&random);
        in.report.bridge = (bridge_mode_t)random_between(&random, 0, 2);
        in.now.speed_mrad_s = random_wild(&random);
        in.shown.winding_cC = random_wild(&random);
        in.shown.switch_cC = random_wild(&random);
        torque(random_wild(&random), random_wild(&random));
        in.report.offset_q4[random_between(&random, 0, 2)] = random_wild(&random);
        const shown_t out = step_at_count();
        TEST_ASSERT_NOT_EQUAL_INT(BRIDGE_PWM, out.monitored.safe.bridge);
    }
}

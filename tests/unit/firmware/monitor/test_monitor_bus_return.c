/* SPDX-License-Identifier: Apache-2.0 */
/* A bus beyond a trip and its return: what is remembered for a tenth of a second, what is forgotten
 * after it, and whose fault it is then. */
#include "monitor_rig.h"

enum { OVER_mV = 60564, UNDER_mV = 36000, BACK_mV = 53000, NOT_BACK_mV = 60000 };

void setUp(void)
{
    rig_up(&TURNING);
    in.battery.charge_current_mA = 1000000;
    config.battery.overvoltage_trip_mV = OVER_mV;
    config.battery.undervoltage_trip_mV = UNDER_mV;
    config.battery.max_voltage_mV = 58400; /* back below 59.482 V */
    config.drive.voltage_full_scale_mV = 64000;
    config.monitor.battery_message_time_ms = 300;
    config.monitor.voltage_fault_time_ms = 5;
}

void tearDown(void) {}

/* Empties the bus below its trip for one step of PWM, and opens the bridge. */
static shown_t empty_the_bus(int32_t bus_mV)
{
    in.report.bridge = BRIDGE_PWM;
    in.now.bus_voltage_mV = bus_mV;
    const shown_t out = step();
    in.report.bridge = BRIDGE_OFF;
    return out;
}

static shown_t bus_is(int32_t bus_mV, int milliseconds)
{
    in.now.bus_voltage_mV = bus_mV;
    return run(milliseconds);
}

void test_a_bus_at_its_lower_trip_is_neither_low_nor_away(void)
{
    in.now.bus_voltage_mV = UNDER_mV;
    TEST_ASSERT_FALSE(step().battery_lost);
    (void)empty_the_bus(UNDER_mV - 1);
    TEST_ASSERT_TRUE(bus_is(UNDER_mV, MONITOR_BUS_RETURN_STEPS - 1).battery_lost);
    TEST_ASSERT_FALSE(step().battery_lost);
}

/* A reading that is low again while the bridge is still off: nothing is back. */
void test_what_took_the_torque_away_is_not_over_while_the_bus_is_low_again(void)
{
    static const int32_t LOW_mV[] = {0, UNDER_mV - 1};
    for (int k = 0; k < 2; k++) {
        setUp();
        (void)empty_the_bus(LOW_mV[k]);
        TEST_ASSERT_FALSE(bus_is(BACK_mV, MONITOR_BUS_RETURN_STEPS).battery_lost);
        (void)empty_the_bus(LOW_mV[k]);
        TEST_ASSERT_TRUE(bus_is(BACK_mV, MONITOR_BUS_RETURN_STEPS).battery_lost);
        TEST_ASSERT_TRUE(bus_is(LOW_mV[k], 1).battery_lost);
        TEST_ASSERT_TRUE(bus_is(BACK_mV, MONITOR_BUS_RETURN_STEPS).battery_lost);
    }
}

/* ---- over-current of a bus that was low ---- */

static reason_t fault_with_trip(reason_t trip)
{
    in.now.trip = trip;
    return step().fault;
}

void test_overcurrent_is_the_bus_s_until_it_has_been_back_for_a_tenth_of_a_second(void)
{
    (void)empty_the_bus(UNDER_mV - 1);
    (void)bus_is(BACK_mV, MONITOR_BUS_RETURN_STEPS - 1);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, fault_with_trip(REASON_OVERCURRENT));
    setUp();
    (void)empty_the_bus(UNDER_mV - 1);
    (void)bus_is(BACK_mV, MONITOR_BUS_RETURN_STEPS);
    TEST_ASSERT_EQUAL_INT(REASON_OVERCURRENT, fault_with_trip(REASON_OVERCURRENT));
}

void test_overcurrent_after_a_bus_that_was_high_is_none_of_the_bus(void)
{
    (void)bus_is(OVER_mV + 1, 1);
    in.now.bus_voltage_mV = BACK_mV;
    TEST_ASSERT_EQUAL_INT(REASON_OVERCURRENT, fault_with_trip(REASON_OVERCURRENT));
}

void test_other_trips_are_a_fault_at_once_on_a_low_bus_as_well(void)
{
    static const reason_t OTHERS[] = {REASON_PROGRAM_FLOW, REASON_CURRENT_SENSOR};
    for (int k = 0; k < 2; k++) {
        setUp();
        (void)empty_the_bus(UNDER_mV - 1);
        TEST_ASSERT_EQUAL_INT(OTHERS[k], fault_with_trip(OTHERS[k]));
    }
}

void test_a_trip_by_a_reading_that_jumped_is_released_when_the_bus_is_back(void)
{
    in.now.trip = REASON_BUS_SENSOR;
    const shown_t out = step();
    TEST_ASSERT_EQUAL_INT(REASON_NONE, out.fault);
    TEST_ASSERT_TRUE(out.battery_lost);
    TEST_ASSERT_TRUE(out.monitored.release_trip);
    TEST_ASSERT_FALSE(bus_is(NOT_BACK_mV, 1).monitored.release_trip);
}

void test_an_open_contactor_releases_no_trip_of_a_bus_that_is_still_high(void)
{
    in.now.trip = REASON_BUS_OVERVOLTAGE;
    in.battery.contactor = CONTACTOR_OPEN;
    TEST_ASSERT_FALSE(bus_is(OVER_mV + 1, 1).monitored.release_trip);
    TEST_ASSERT_TRUE(bus_is(BACK_mV, 1).monitored.release_trip);
}

/* ---- the sensor's fault or the battery's ---- */

/* 1/64 of 64 V. */
void test_a_bus_below_a_64th_of_the_range_is_the_sensor_s(void)
{
    TEST_ASSERT_EQUAL_INT(REASON_NONE, empty_the_bus(1000).warning);
    setUp();
    TEST_ASSERT_EQUAL_INT(REASON_BUS_SENSOR, empty_the_bus(999).warning);
    /* For as long as the bus counts as lost. */
    TEST_ASSERT_EQUAL_INT(REASON_BUS_SENSOR, bus_is(BACK_mV, 1).warning);
    const shown_t last = run(MONITOR_BUS_RETURN_STEPS - 2);
    TEST_ASSERT_EQUAL_INT(REASON_BUS_SENSOR, last.warning);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, step().warning);
}

void test_a_bus_that_an_open_contactor_leaves_empty_is_the_battery_s(void)
{
    (void)empty_the_bus(UNDER_mV - 1);
    in.battery.contactor = CONTACTOR_OPEN;
    (void)bus_is(0, 10);
    in.battery.contactor = CONTACTOR_CLOSED;
    TEST_ASSERT_EQUAL_INT(REASON_BATTERY_DISCONNECTED, bus_is(BACK_mV, 1).warning);
}

void test_a_bus_that_empties_without_a_motor_is_the_battery_s(void)
{
    (void)bus_is(OVER_mV + 1, 1);
    in.report.bridge = BRIDGE_OFF;
    TEST_ASSERT_EQUAL_INT(REASON_BATTERY_DISCONNECTED, bus_is(0, 10).warning);
}

void test_a_low_bus_that_is_back_at_once_is_the_battery_s(void)
{
    TEST_ASSERT_EQUAL_INT(REASON_NONE, empty_the_bus(UNDER_mV - 1).warning);
    in.now.bus_voltage_mV = BACK_mV;
    for (int n = 1; n < MONITOR_BUS_RETURN_STEPS; n++) {
        TEST_ASSERT_EQUAL_INT(REASON_BATTERY_DISCONNECTED, step().warning);
    }
    TEST_ASSERT_EQUAL_INT(REASON_NONE, step().warning);
}

void test_a_low_bus_with_a_trip_of_the_bus_is_named_in_its_first_step(void)
{
    in.now.trip = REASON_BUS_OVERVOLTAGE;
    TEST_ASSERT_EQUAL_INT(REASON_BATTERY_DISCONNECTED, empty_the_bus(UNDER_mV - 1).warning);
}

/* ---- what is remembered ---- */

void test_a_bus_that_falls_with_an_open_contactor_is_not_low(void)
{
    in.battery.contactor = CONTACTOR_OPEN;
    (void)bus_is(20000, 10);
    in.battery.contactor = CONTACTOR_CLOSED;
    in.report.bridge = BRIDGE_OFF;
    assert_never_a_fault();
}

void test_a_bus_that_moves_with_an_open_contactor_has_lost_no_battery(void)
{
    in.battery.contactor = CONTACTOR_OPEN;
    for (int n = 0; n < 20; n++) {
        (void)bus_is(n % 2 == 0 ? 50000 : 57000, 1);
    }
    in.battery.contactor = CONTACTOR_CLOSED;
    in.report.bridge = BRIDGE_OFF;
    TEST_ASSERT_EQUAL_INT(REASON_NONE, bus_is(NOT_BACK_mV, 1000).fault);
    TEST_ASSERT_FALSE(step().battery_lost);
}

/* Of the reasons the one counts that began while the bus was lost; a fault comes 300 ms after the
 * message that is missing, of a low bus 5 ms later. */
static void assert_fault_of_a_high_bus_after(int back_steps, int milliseconds, reason_t fault)
{
    (void)empty_the_bus(UNDER_mV - 1);
    (void)bus_is(BACK_mV, back_steps);
    in.now.bus_voltage_mV = OVER_mV + 1;
    for (int n = 1; n < milliseconds; n++) {
        TEST_ASSERT_EQUAL_INT(REASON_NONE, step().fault);
    }
    TEST_ASSERT_EQUAL_INT(fault, step().fault);
}

void test_a_bus_that_was_low_is_forgotten_when_it_has_been_back(void)
{
    assert_fault_of_a_high_bus_after(MONITOR_BUS_RETURN_STEPS - 1, 305, REASON_BUS_UNDERVOLTAGE);
    setUp();
    assert_fault_of_a_high_bus_after(MONITOR_BUS_RETURN_STEPS, 300, REASON_BUS_OVERVOLTAGE);
}

void test_a_bus_that_is_not_back_in_its_last_step_needs_an_explanation(void)
{
    (void)empty_the_bus(UNDER_mV - 1);
    (void)bus_is(BACK_mV, MONITOR_BUS_RETURN_STEPS - 1);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, bus_is(NOT_BACK_mV, 304).fault);
    TEST_ASSERT_EQUAL_INT(REASON_BUS_UNDERVOLTAGE, step().fault);
}

/* At 80 rad/s the EMF is 65 V: into a battery it drives a current, into a bus that none holds it
 * does not, whatever the last message says. */
void test_the_emf_charges_no_battery_while_the_bus_counts_as_lost(void)
{
    config.motor.max_phase_current_mA = 400000;
    in.now.speed_mrad_s = 80000;
    in.report.bridge = BRIDGE_OFF;
    TEST_ASSERT_TRUE(bus_is(BACK_mV, 1).charging_mA > 0);
    (void)empty_the_bus(UNDER_mV - 1);
    const shown_t lost = bus_is(BACK_mV, MONITOR_BUS_RETURN_STEPS - 1);
    TEST_ASSERT_TRUE(lost.battery_lost);
    TEST_ASSERT_EQUAL_INT32(0, lost.charging_mA);
    TEST_ASSERT_FALSE(lost.monitored.emf_conducts);
    TEST_ASSERT_TRUE(step().charging_mA > 0);
}

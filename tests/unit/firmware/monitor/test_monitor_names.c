/* SPDX-License-Identifier: Apache-2.0 */
/* The names of what is wrong: program flow, bus sensor, open phase. */
#include "monitor_rig.h"

void setUp(void)
{
    rig_up(&TURNING);
    config.battery.overvoltage_trip_mV = 60564;
    config.battery.undervoltage_trip_mV = 36000;
}

void tearDown(void) {}

/* One sensor at its rail beside two without a current: the sum is there as well. */
void test_sensor_at_its_rail_is_named_without_pwm(void)
{
    in.report.bridge = BRIDGE_OFF;
    in.report.current_sum_pu = -32000;
    assert_fault_after(20, REASON_CURRENT_SENSOR);
}

/* ---- program flow ---- */

/* Every other slow step has the right number of fast steps, beginning with a wrong one: the step in
 * which it is a fault, 0 for none of 20. */
static int faulty_step(uint16_t wrong, uint16_t right)
{
    fast_steps_per_slow = right;
    (void)step();
    for (int n = 1; n <= 20; n++) {
        fast_steps_per_slow = n % 2 == 1 ? wrong : right;
        if (step().fault == REASON_PROGRAM_FLOW) {
            return n;
        }
    }
    return 0;
}

/* Of 20 kHz 80 periods are the 4 ms for which the fast loop waits; a longer gap is a fault at once.
 */
void test_a_gap_beyond_what_the_fast_loop_waits_for_is_a_fault_at_once(void)
{
    TEST_ASSERT_EQUAL_INT(5, faulty_step(80, 20));
    setUp();
    TEST_ASSERT_EQUAL_INT(1, faulty_step(81, 20));
}

void test_stopped_or_doubled_fast_loop_is_a_fault_in_the_third_step(void)
{
    step();
    fast_steps_per_slow = 0;
    TEST_ASSERT_EQUAL_INT(REASON_NONE, run(2).fault);
    TEST_ASSERT_EQUAL_INT(REASON_PROGRAM_FLOW, step().fault);
    setUp();
    fast_steps_per_slow = 2 * FAST_PER_SLOW;
    TEST_ASSERT_EQUAL_INT(REASON_NONE, run(2).fault);
    TEST_ASSERT_EQUAL_INT(REASON_PROGRAM_FLOW, step().fault); /* the second one checked */
    fast_steps_per_slow = FAST_PER_SLOW;
}

/* Every other step finds the right number of fast steps, the next none. */
void test_slow_step_that_comes_twice_is_a_fault_in_its_fifth_pair(void)
{
    step();
    for (int pair = 1; pair <= 5; pair++) {
        fast_steps_per_slow = FAST_PER_SLOW;
        TEST_ASSERT_EQUAL_INT(REASON_NONE, step().fault);
        fast_steps_per_slow = 0;
        TEST_ASSERT_EQUAL_INT(pair < 5 ? REASON_NONE : REASON_PROGRAM_FLOW, step().fault);
    }
    fast_steps_per_slow = FAST_PER_SLOW;
}

void test_fast_loop_rate_within_25_percent_is_no_fault(void)
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
    in.report.sequence = (uint16_t)(in.report.sequence + 40);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, run(100).fault);
}

/* While the bridge switches the fast monitor has tripped; with an open one the slow step that comes
 * back names it. 4 ms are 80 fast steps. */
void test_a_slow_step_missing_for_more_than_4_ms_is_a_fault(void)
{
    in.report.bridge = BRIDGE_OFF;
    (void)run(10);
    in.report.sequence = (uint16_t)(in.report.sequence + 60);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, run(100).fault);
    in.report.sequence = (uint16_t)(in.report.sequence + 61);
    TEST_ASSERT_EQUAL_INT(REASON_PROGRAM_FLOW, step().fault);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, step().fault);
}

void test_first_step_does_not_check_the_fast_loop_s_count(void)
{
    in.report.sequence = 12345; /* the first step has no count to compare with */
    TEST_ASSERT_EQUAL_INT(REASON_NONE, run(10).fault);
    setUp();
    fast_steps_per_slow = 0;
    TEST_ASSERT_EQUAL_INT(REASON_NONE, run(3).fault); /* the first step is not checked */
    TEST_ASSERT_EQUAL_INT(REASON_PROGRAM_FLOW, step().fault);
    fast_steps_per_slow = FAST_PER_SLOW;
}

/* A locked or unloaded wheel, or a sensor that has stopped: only shown, for a second. Below 4
 * hand-over speeds it may fall to zero. */
void test_a_sensor_that_stops_faster_than_a_tyre_is_only_shown(void)
{
    const int32_t time_ms = 1000;
    config.rotor.sensor = CONFIG_ROTOR_ENCODER;
    const int32_t slow_mrad_s = 4 * config.brake.blend_out_end_mrad_s;
    in.now.speed_mrad_s = slow_mrad_s;
    (void)run(100);
    in.now.speed_mrad_s = 0;
    TEST_ASSERT_EQUAL_INT(REASON_NONE, run(time_ms).warning);
    setUp();
    config.rotor.sensor = CONFIG_ROTOR_ENCODER;
    in.now.speed_mrad_s = slow_mrad_s + 100;
    (void)run(100);
    in.now.speed_mrad_s = 0;
    TEST_ASSERT_EQUAL_INT(REASON_ROTOR_UNCERTAIN, step().warning);
    TEST_ASSERT_EQUAL_INT(FINDING_COUNT, findings_limiting(&findings));
    TEST_ASSERT_EQUAL_INT(REASON_ROTOR_UNCERTAIN, run(time_ms - 1).warning);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, step().warning);
}

/* A skipped sector leaves less driving torque unless the observer sees the rotor. */
void test_a_reading_out_of_order_is_only_shown_while_the_observer_sees_the_rotor(void)
{
    in.now.rotor_observed = true;
    in.report.rotor_faults = 1;
    TEST_ASSERT_EQUAL_INT(REASON_ROTOR_UNCERTAIN, step().warning);
    TEST_ASSERT_EQUAL_INT(FINDING_COUNT, findings_limiting(&findings));
    in.now.rotor_observed = false;
    TEST_ASSERT_EQUAL_INT(REASON_ROTOR_UNCERTAIN, run(999).warning);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, step().warning);
    in.report.rotor_faults = 2;
    (void)step();
    TEST_ASSERT_EQUAL_INT(FINDING_ROTOR_READING, findings_limiting(&findings));
}

/* 61.8 V at the end of the range. The fast monitor has seen the reading jump; or it shows less than
 * a motor can leave of a bus. */
void test_bus_reading_that_no_bus_has_is_its_sensor_s(void)
{
    in.now.trip = REASON_BUS_SENSOR;
    in.now.bus_voltage_mV = 61800;
    in.report.bridge = BRIDGE_OFF;
    shown_t out = step();
    TEST_ASSERT_EQUAL_INT(REASON_BUS_SENSOR, out.warning);
    TEST_ASSERT_TRUE(out.battery_lost);
    in.now.trip = REASON_NONE;
    in.now.bus_voltage_mV = 53000;
    (void)run(MONITOR_BUS_RETURN_STEPS);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, step().warning);

    setUp();
    in.report.bridge = BRIDGE_PWM;
    in.now.bus_voltage_mV = 30000; /* half of its millisecond */
    out = step();
    TEST_ASSERT_EQUAL_INT(REASON_NONE, out.warning);
    TEST_ASSERT_TRUE(out.battery_lost);
    in.report.bridge = BRIDGE_OFF;
    in.now.bus_voltage_mV = 965; /* 1/64 of the range is 0.966 V */
    TEST_ASSERT_EQUAL_INT(REASON_BUS_SENSOR, step().warning);
    in.battery.contactor = CONTACTOR_OPEN; /* said by the battery */
    TEST_ASSERT_EQUAL_INT(REASON_BATTERY_DISCONNECTED, step().warning);
}

/* A trip by the bus in the step in which it has fallen is evidence enough. */
void test_a_low_bus_is_named_at_once_if_the_fast_loop_has_seen_it_high(void)
{
    in.now.bus_voltage_mV = 30000;
    in.now.trip = REASON_BUS_OVERVOLTAGE;
    TEST_ASSERT_EQUAL_INT(REASON_BATTERY_DISCONNECTED, step().warning);
}

void test_bus_that_a_motor_has_emptied_is_the_battery_s(void)
{
    in.now.bus_voltage_mV = 20000;
    TEST_ASSERT_EQUAL_INT(REASON_NONE, step().warning);
    in.report.bridge = BRIDGE_OFF;
    in.now.bus_voltage_mV = 966;
    TEST_ASSERT_EQUAL_INT(REASON_BATTERY_DISCONNECTED, step().warning);
}

/* ---- open phase ---- */

static void no_current_in_phase_a(void)
{
    in.last.reference_pu.q = 12000;     /* at 90 degrees phase a is -q */
    in.report.i_pu.v = q_pair(6000, 0); /* along beta: the other two phases */
    in.report.sample.theta_turn = 16384;
}

void test_open_phase_is_a_fault_in_the_third_step(void)
{
    no_current_in_phase_a();
    TEST_ASSERT_EQUAL_INT(REASON_NONE, run(2).fault);
    TEST_ASSERT_EQUAL_INT(REASON_PHASE_OPEN, step().fault);
}

void test_overcurrent_after_a_suspected_open_phase_is_named_by_it(void)
{
    no_current_in_phase_a();
    TEST_ASSERT_EQUAL_INT(REASON_NONE, run(2).fault);
    in.now.trip = REASON_OVERCURRENT;
    in.report.bridge = BRIDGE_OFF;
    TEST_ASSERT_EQUAL_INT(REASON_PHASE_OPEN, step().fault);
    setUp();
    no_current_in_phase_a();
    (void)step();
    in.now.trip = REASON_OVERCURRENT;
    in.report.bridge = BRIDGE_OFF;
    TEST_ASSERT_EQUAL_INT(REASON_OVERCURRENT, step().fault);
}

void test_another_trip_keeps_its_name_beside_a_suspected_open_phase(void)
{
    no_current_in_phase_a();
    (void)run(2);
    in.now.trip = REASON_PROGRAM_FLOW;
    in.report.bridge = BRIDGE_OFF;
    TEST_ASSERT_EQUAL_INT(REASON_PROGRAM_FLOW, step().fault);
}

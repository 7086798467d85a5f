/* SPDX-License-Identifier: Apache-2.0 */
/* What explains a contradiction has its name before what it would be taken for. */
#include "controller_rig.h"
#include "unity.h"

static rig_t rig;
static uint16_t rotor_faults;

/* Braking with 20 N m at 300 r/min, in RUN, the battery's current unknown. */
void setUp(void)
{
    rig_start_running(&rig);
    rig.config.battery.driven_wheels = 1;
    rig.config.rotor.observer_takeover = 1;
    rig.follows = true;
    rig_set_speed_rpm(&rig, 300.0);
    rig_run(&rig, 300);
    rig.slow_in.demand.brake_torque_mNm = 20000;
    rig_run(&rig, 300);
    rotor_faults = 0;
    TEST_ASSERT_EQUAL_INT(MODE_RUN, rig.out.mode);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, rig.out.warning_reason);
}

void tearDown(void) {}

/* A slow step after so many fast ones, with more contradictions of the rotor sensor. */
static reason_t step_after(int fast_steps, uint16_t more_faults)
{
    for (int k = 0; k < fast_steps; k++) {
        rig_fast(&rig);
    }
    rotor_faults = (uint16_t)(rotor_faults + more_faults);
    rig.to_slow.rotor_faults = (uint16_t)(rig.to_slow.rotor_faults + rotor_faults);
    rig_slow(&rig);
    return rig.out.warning_reason;
}

void test_steps_out_of_order_are_named_before_the_rotor_sensor_that_they_contradict(void)
{
    TEST_ASSERT_EQUAL_INT(REASON_NONE, step_after(2 * RIG_FAST_PER_SLOW, 1));
    TEST_ASSERT_EQUAL_INT(REASON_NONE, step_after(2 * RIG_FAST_PER_SLOW, 1));
    TEST_ASSERT_EQUAL_INT(REASON_PROGRAM_FLOW, rig.out.fault_reason);
}

void test_a_rotor_sensor_is_named_at_once_or_once_the_steps_are_in_order(void)
{
    TEST_ASSERT_EQUAL_INT(REASON_ROTOR_UNCERTAIN, step_after(RIG_FAST_PER_SLOW, 1));
    setUp();
    TEST_ASSERT_EQUAL_INT(REASON_NONE, step_after(2 * RIG_FAST_PER_SLOW, 1));
    TEST_ASSERT_EQUAL_INT(REASON_NONE, step_after(RIG_FAST_PER_SLOW, 0));
    TEST_ASSERT_EQUAL_INT(REASON_NONE, step_after(RIG_FAST_PER_SLOW, 0));
    TEST_ASSERT_EQUAL_INT(REASON_ROTOR_UNCERTAIN, step_after(RIG_FAST_PER_SLOW, 0));
    TEST_ASSERT_EQUAL_INT(REASON_NONE, rig.out.fault_reason);
}

/* Slow steps with a sensor that is half a turn off the angle of the EMF observer. */
static void run_displaced(int milliseconds)
{
    for (int ms = 0; ms < milliseconds; ms++) {
        for (int k = 0; k < RIG_FAST_PER_SLOW; k++) {
            rig_fast(&rig);
        }
        rig.to_slow.observer.sensor_turn = (uint16_t)(rig.to_slow.observer.sensor_turn + 32768U);
        rig_slow(&rig);
    }
}

void test_the_hydraulic_brake_is_named_by_its_reports_whatever_the_motor_shows(void)
{
    rig_report_brake(&rig, 10000);
    rig_run(&rig, 300);
    TEST_ASSERT_EQUAL_INT(REASON_HYDRAULIC_STUCK, rig.out.warning_reason);
    run_displaced(1);
    TEST_ASSERT_EQUAL_INT(REASON_HYDRAULIC_STUCK, rig.out.warning_reason);
}

void test_a_wrong_rotor_sensor_has_its_name_within_20_ms(void)
{
    run_displaced(20);
    TEST_ASSERT_EQUAL_INT(REASON_ROTOR_SLIPPED, rig.out.warning_reason);
}

/* 400 N m/s: beside a wrong sensor the observer is used, also without a flux that confirms it. */
void test_torque_of_a_wrong_sensor_ramps_out_with_the_observer_s_angle(void)
{
    run_displaced(20);
    TEST_ASSERT_EQUAL_INT32(-20000, rig.out.motor_torque_command_mNm);
    for (int32_t ms = 0; ms < 10; ms++) {
        for (int k = 0; k < RIG_FAST_PER_SLOW; k++) {
            rig_fast(&rig);
        }
        rig.to_slow.observer.flux_q14.v = q_pair(0, 0);
        rig_slow(&rig);
        TEST_ASSERT_EQUAL_INT32(-20000 + 400 * ms, rig.out.motor_torque_command_mNm);
    }
}

/* By the monitor's bound of the speed, which no sensor of the rotor makes smaller. */
void test_a_wrong_rotor_sensor_is_acknowledged_at_rest_only(void)
{
    rig.slow_in.demand.brake_torque_mNm = 0;
    run_displaced(20);
    rig.fast_in.power_stage_fault = true;
    rig_run(&rig, 2);
    rig.fast_in.power_stage_fault = false;
    TEST_ASSERT_NOT_EQUAL_INT(BRIDGE_PWM, rig.pwm.bridge);
    rig.slow_in.demand.fault_reset = true;
    rig_run(&rig, 5);
    TEST_ASSERT_FALSE(rig.out.standstill);
    TEST_ASSERT_EQUAL_INT(REASON_ROTOR_SLIPPED, rig.out.warning_reason);
    rig_set_speed_rpm(&rig, 0.0);
    /* 7.9 m/s without a valid sensor last 80 s at 0.01 g, and less than a second at 1.2 g. */
    rig.config.monitor.coasting_mm_s2 = rig.config.monitor.tyre_grip_mm_s2;
    int rest_ms = 0;
    for (; !rig.out.standstill; rest_ms++) {
        TEST_ASSERT_EQUAL_INT(REASON_ROTOR_SLIPPED, rig.out.warning_reason);
        TEST_ASSERT_LESS_THAN_INT(1000, rest_ms);
        rig_run(&rig, 1);
    }
    rig_run(&rig, 1);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, rig.out.warning_reason);
}

/* Without a trip one bit of its word makes a power of two, which no trip is; in the word of a trip
 * it makes that of another one at most. */
void test_a_trip_that_the_fast_part_never_gives_is_damaged_memory(void)
{
    static const reason_t GIVEN[] = {REASON_HARDWARE_BREAK, REASON_OVERCURRENT,
                                     REASON_CURRENT_SENSOR, REASON_PROGRAM_FLOW};
    for (unsigned bit = 0; bit < 8U; bit++) {
        setUp();
        rig.to_slow.trip = (reason_t)(1U << bit);
        rig_slow(&rig);
        TEST_ASSERT_EQUAL_INT(REASON_MEMORY, rig.out.fault_reason);
        TEST_ASSERT_EQUAL_INT(MODE_FAULT, rig.out.mode);
        TEST_ASSERT_EQUAL_INT32(0, rig.out.motor_torque_command_mNm);
        TEST_ASSERT_EQUAL_INT32(20000, rig.out.hydraulic_torque_mNm);
    }
    for (unsigned k = 0; k < sizeof GIVEN / sizeof GIVEN[0]; k++) {
        setUp();
        rig.to_slow.trip = GIVEN[k];
        rig_slow(&rig);
        TEST_ASSERT_EQUAL_INT(GIVEN[k], rig.out.fault_reason);
    }
    setUp();
    rig.to_slow.trip = REASON_BUS_SENSOR; /* a warning that heals */
    rig_slow(&rig);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, rig.out.fault_reason);
    TEST_ASSERT_EQUAL_INT(REASON_BUS_SENSOR, rig.out.warning_reason);
}

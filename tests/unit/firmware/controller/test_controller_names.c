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

/* A battery that takes nothing while the motor brakes, from the first window of it on. */
static void contradict_the_current(void)
{
    rig.slow_in.bms.current_given = true;
    rig.slow_in.bms.current_mA = 0;
    rig_run(&rig, 300);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, rig.out.fault_reason);
}

static reason_t warning_of_a_strong_brake(void)
{
    rig.controller.slow.torque.blending.watch.reason = REASON_HYDRAULIC_STRONG;
    return step_after(RIG_FAST_PER_SLOW, 0);
}

void test_the_hydraulic_brake_is_named_unless_motor_current_or_angle_is_in_question(void)
{
    TEST_ASSERT_EQUAL_INT(REASON_HYDRAULIC_STRONG, warning_of_a_strong_brake());
    setUp();
    contradict_the_current();
    TEST_ASSERT_EQUAL_INT(REASON_NONE, warning_of_a_strong_brake());
    setUp();
    rig.controller.slow.rotor.sensor_wrong = true;
    TEST_ASSERT_EQUAL_INT(REASON_NONE, warning_of_a_strong_brake());
}

void test_a_wrong_rotor_sensor_has_no_name_while_the_current_is_in_question(void)
{
    for (int asked = 0; asked <= 1; asked++) {
        setUp();
        if (asked) {
            contradict_the_current();
        }
        rig.controller.slow.rotor.sensor_wrong = true;
        bool named = false;
        for (int n = 0; n < 20; n++) {
            const reason_t reason = step_after(RIG_FAST_PER_SLOW, 0);
            named = named || reason != REASON_NONE;
        }
        TEST_ASSERT_EQUAL_INT(!asked, named);
    }
}

/* 400 N m/s; an angle that nothing shows makes no torque that could ramp out. */
void test_torque_of_a_wrong_sensor_ramps_out_with_the_observer_s_angle_only(void)
{
    for (int used = 0; used <= 1; used++) {
        setUp();
        TEST_ASSERT_EQUAL_INT32(-20000, rig.out.motor_torque_command_mNm);
        const monitor_rotor_state_t wrong = {.sensor_wrong = true, .observer_used = used != 0};
        rig.controller.slow.rotor = wrong;
        rig_run(&rig, 1);
        TEST_ASSERT_EQUAL_INT32(used != 0 ? -19600 : 0, rig.out.motor_torque_command_mNm);
    }
}

/* By the monitor's bound of the speed, which no sensor of the rotor makes smaller. */
void test_a_wrong_rotor_sensor_is_acknowledged_at_rest_only(void)
{
    rig.slow_in.demand.brake_torque_mNm = 0;
    rig.fast_in.power_stage_fault = true;
    rig_run(&rig, 2);
    rig.fast_in.power_stage_fault = false;
    TEST_ASSERT_NOT_EQUAL_INT(BRIDGE_PWM, rig.pwm.bridge);
    rig.controller.slow.rotor.sensor_wrong = true;
    rig.slow_in.demand.fault_reset = true;
    rig_run(&rig, 5);
    TEST_ASSERT_FALSE(rig.out.standstill);
    TEST_ASSERT_TRUE(rig.controller.slow.rotor.sensor_wrong);
    rig_set_speed_rpm(&rig, 0.0);
    /* 7.9 m/s without a valid sensor last 80 s at 0.01 g, and less than a second at 1.2 g. */
    rig.config.monitor.coasting_mm_s2 = rig.config.monitor.tyre_grip_mm_s2;
    int rest_ms = 0;
    for (; !rig.out.standstill; rest_ms++) {
        TEST_ASSERT_TRUE(rig.controller.slow.rotor.sensor_wrong);
        TEST_ASSERT_LESS_THAN_INT(1000, rest_ms);
        rig_run(&rig, 1);
    }
    rig_run(&rig, 1);
    TEST_ASSERT_FALSE(rig.controller.slow.rotor.sensor_wrong);
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

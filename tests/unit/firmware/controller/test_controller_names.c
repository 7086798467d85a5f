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

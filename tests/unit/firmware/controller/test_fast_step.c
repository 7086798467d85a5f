/* SPDX-License-Identifier: Apache-2.0 */
/* What the fast step does with the bridge. */
#include "config/bases.h"
#include "controller/controller.h"
#include "unity.h"

extern const config_t CONFIG_LU2013;

static controller_t controller;
static fast_setpoint_t setpoint;
/* No current, half the bus voltage's range, a wheel at rest. */
static fast_input_t in;

void setUp(void)
{
    const fast_input_t rest = {
        .phase_current_code = {2048, 2048, 2048}, .bus_voltage_code = 2048, .hall_state = 5};
    in = rest;
    controller_init(&controller, &CONFIG_LU2013, BASES_MODEL_TIMER_Hz);
    setpoint = controller_initial_setpoint(&CONFIG_LU2013, BASES_MODEL_TIMER_Hz);
    setpoint.safe_bridge = BRIDGE_SHORT;
}

void tearDown(void) {}

static bridge_mode_t step(bool enabled)
{
    setpoint.torque_enabled = enabled;
    setpoint.sequence++;
    return controller_fast_step(&controller.fast, &CONFIG_LU2013, &setpoint, &in)->bridge;
}

void test_the_bridge_switches_while_torque_is_enabled(void)
{
    TEST_ASSERT_EQUAL_INT(BRIDGE_SHORT, step(false));
    TEST_ASSERT_EQUAL_INT(BRIDGE_PWM, step(true));
    TEST_ASSERT_EQUAL_INT(BRIDGE_SHORT, step(false));
}

void test_a_trip_acts_in_its_own_period_and_stays_without_its_cause(void)
{
    TEST_ASSERT_EQUAL_INT(BRIDGE_PWM, step(true));
    in.power_stage_fault = true;
    TEST_ASSERT_EQUAL_INT(BRIDGE_SHORT, step(true));
    in.power_stage_fault = false;
    TEST_ASSERT_EQUAL_INT(BRIDGE_SHORT, step(true));
}

void test_the_view_is_that_of_the_current_loop(void)
{
    fast_view_t view;
    (void)step(true);
    controller.fast.foc.prefilter.reference_pu.q = -123;
    controller_fast_view(&controller.fast, &view);
    TEST_ASSERT_EQUAL_INT32(-123, view.i_q_reference_pu);
    TEST_ASSERT_EQUAL_INT32(dq_of(foc_latest(&controller.fast.foc)->i_pu).q, view.i_q_pu);
}

void test_the_report_names_trip_and_bridge_of_the_latest_period(void)
{
    fast_report_t report;
    (void)step(true);
    controller_fast_report_copy(&controller.fast, &report);
    TEST_ASSERT_EQUAL_INT(BRIDGE_PWM, report.bridge);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, report.trip);
    in.power_stage_fault = true;
    (void)step(true);
    controller_fast_report_copy(&controller.fast, &report);
    TEST_ASSERT_EQUAL_INT(BRIDGE_SHORT, report.bridge);
    TEST_ASSERT_NOT_EQUAL_INT(REASON_NONE, report.trip);
}

/* SPDX-License-Identifier: Apache-2.0 */
/* Temperatures: faults 10 K above the end of derating; a broken sensor is a warning. */
#include "monitor_rig.h"

void setUp(void)
{
    rig_up(&SWITCHING);
    config.motor.max_winding_temperature_cC = 15000;
    config.drive.max_switch_temperature_cC = 10000;
}

void tearDown(void) {}

void test_an_overheated_winding_is_a_fault(void)
{
    in.now.winding_temperature_cC = 16001;
    assert_fault_after(20, REASON_WINDING_OVERTEMPERATURE);
    in.now.winding_temperature_cC = 16000;
    assert_never_a_fault();
}

void test_overheated_switches_are_a_fault(void)
{
    in.now.switch_temperature_cC = 11001;
    assert_fault_after(20, REASON_SWITCH_OVERTEMPERATURE);
    in.now.switch_temperature_cC = 11000;
    assert_never_a_fault();
}

/* The controller replaces a reading outside the sensor's range by an estimate, which derates. */
void test_a_broken_sensor_is_a_warning_and_its_estimate_no_fault(void)
{
    in.now.winding_sensor_broken = true;
    in.now.winding_temperature_cC = 16001;
    TEST_ASSERT_EQUAL_INT(REASON_NONE, run(100).fault);
    TEST_ASSERT_EQUAL_INT(REASON_WINDING_SENSOR, step().warning);
    recover();
    TEST_ASSERT_EQUAL_INT(REASON_NONE, step().warning);
    in.now.switch_sensor_broken = true;
    in.now.switch_temperature_cC = 11001;
    TEST_ASSERT_EQUAL_INT(REASON_NONE, run(100).fault);
    TEST_ASSERT_EQUAL_INT(REASON_SWITCH_SENSOR, step().warning);
    in.now.winding_temperature_cC = 16001; /* the other one is good */
    assert_fault_after(20, REASON_WINDING_OVERTEMPERATURE);
}

void test_a_reading_outside_the_range_is_no_over_temperature(void)
{
    int32_t *const temperatures[] = {&in.now.winding_temperature_cC, &in.now.switch_temperature_cC};
    const reason_t hot[] = {REASON_WINDING_OVERTEMPERATURE, REASON_SWITCH_OVERTEMPERATURE};
    for (int k = 0; k < 2; k++) {
        *temperatures[k] = 29001;
        assert_never_a_fault();
        *temperatures[k] = 29000;
        assert_fault_after(20, hot[k]);
    }
}

void test_missing_sensor_is_no_fault_with_its_limit_switched_off(void)
{
    config.motor.max_winding_temperature_cC = 30000;
    config.drive.max_switch_temperature_cC = 30000;
    in.now.winding_temperature_cC = 29999;
    in.now.switch_temperature_cC = 29999;
    assert_never_a_fault();
}

void test_a_temperature_limit_that_is_off_has_no_fault(void)
{
    config.monitor.highest_temperature_cC = 40000; /* beyond config_validate() */
    in.now.winding_temperature_cC = 35000;
    config.motor.max_winding_temperature_cC = MONITOR_TEMPERATURE_OFF_cC;
    TEST_ASSERT_EQUAL_INT(REASON_NONE, run(100).fault);
    config.motor.max_winding_temperature_cC = MONITOR_TEMPERATURE_OFF_cC - 1;
    TEST_ASSERT_EQUAL_INT(REASON_WINDING_OVERTEMPERATURE, run(100).fault);
}

/* SPDX-License-Identifier: Apache-2.0 */
/* Temperatures that a sensor shows more than 10 K above the end of the derating. */
#include "monitor_rig.h"

static int32_t *const SHOWN[] = {&in.shown.winding_cC, &in.shown.switch_cC};
static const int32_t ENDS_cC[] = {15000, 10000};
static const reason_t HOT[] = {REASON_WINDING_OVERTEMPERATURE, REASON_SWITCH_OVERTEMPERATURE};

void setUp(void)
{
    rig_up(&SWITCHING);
    config.motor.max_winding_temperature_cC = ENDS_cC[0];
    config.drive.max_switch_temperature_cC = ENDS_cC[1];
}

void tearDown(void) {}

/* It takes the torque after 20 ms, latches nothing, and ends a second after it is colder. */
void test_a_sensor_that_shows_too_hot_takes_the_torque_until_it_is_colder(void)
{
    for (int k = 0; k < 2; k++) {
        setUp();
        *SHOWN[k] = ENDS_cC[k] + 1001;
        TEST_ASSERT_EQUAL_INT(REASON_NONE, run(19).warning);
        const shown_t hot = step();
        TEST_ASSERT_EQUAL_INT(HOT[k], hot.warning);
        TEST_ASSERT_EQUAL_INT(REASON_NONE, hot.fault);
        TEST_ASSERT_TRUE(findings_off(&findings));
        *SHOWN[k] = ENDS_cC[k] + 1000;
        TEST_ASSERT_EQUAL_INT(HOT[k], run(999).warning);
        TEST_ASSERT_EQUAL_INT(REASON_NONE, step().warning);
        TEST_ASSERT_FALSE(findings_off(&findings));
    }
}

/* The controller takes the hotter of sensor and estimate; the estimate alone is no fault. */
void test_an_estimate_however_hot_is_no_over_temperature(void)
{
    in.now.winding_temperature_cC = 32700;
    in.now.switch_temperature_cC = 32700;
    TEST_ASSERT_EQUAL_INT(REASON_NONE, run(1000).warning);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, step().fault);
}

void test_a_reading_beyond_the_range_is_no_over_temperature(void)
{
    for (int k = 0; k < 2; k++) {
        setUp();
        *SHOWN[k] = 29001;
        TEST_ASSERT_EQUAL_INT(REASON_NONE, run(1000).warning);
        *SHOWN[k] = 29000;
        TEST_ASSERT_EQUAL_INT(HOT[k], run(20).warning);
    }
}

/* With a range beyond what config_validate() accepts: the limit alone is off. */
void test_a_limit_that_is_off_has_no_over_temperature(void)
{
    config.monitor.highest_temperature_cC = 40000;
    in.shown.winding_cC = 35000;
    config.motor.max_winding_temperature_cC = CONFIG_TEMPERATURE_OFF_cC;
    TEST_ASSERT_EQUAL_INT(REASON_NONE, run(100).warning);
    config.motor.max_winding_temperature_cC = CONFIG_TEMPERATURE_OFF_cC - 1;
    TEST_ASSERT_EQUAL_INT(HOT[0], run(100).warning);
}

/* SPDX-License-Identifier: Apache-2.0 */
/* What the slow watcher holds for safe where the bridge may not switch, and whether the wheel
 * stands. */
#include "watched.h"

static const monitor_slow_input_t HEALTHY = {.offsets_known = true,
                                             .rotor_valid = true,
                                             .bus_voltage_mV = 53000,
                                             .switching = true,
                                             .bridge = BRIDGE_PWM};

void setUp(void)
{
    watch(&HEALTHY);
}

void tearDown(void) {}

void test_the_choice_is_remembered_from_step_to_step(void)
{
    in.speed_mrad_s = mrad_s_of_rpm(640.0);
    TEST_ASSERT_EQUAL_INT(BRIDGE_SHORT, step().safe_bridge);
    in.speed_mrad_s = mrad_s_of_rpm(600.0); /* 0.963 of the limit */
    TEST_ASSERT_EQUAL_INT(BRIDGE_SHORT, step().safe_bridge);
    in.speed_mrad_s = mrad_s_of_rpm(550.0); /* 0.883; 1.2 g take 0.2 s from 640 r/min */
    TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, run(200).safe_bridge);
    in.speed_mrad_s = mrad_s_of_rpm(600.0);
    TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, step().safe_bridge);
}

/* At 70 rad/s the paper's motor makes 56.9 V between its terminals. */
void test_a_rotor_that_is_lost_above_the_limit_leaves_the_short_as_what_is_safe(void)
{
    in.speed_mrad_s = 70000;
    TEST_ASSERT_EQUAL_INT(BRIDGE_SHORT, run(10).safe_bridge);
    in.speed_mrad_s = 0;
    in.rotor_valid = false;
    in.switching = false;
    in.bridge = BRIDGE_OFF;
    TEST_ASSERT_EQUAL_INT(BRIDGE_SHORT, run(1000).safe_bridge);
    TEST_ASSERT_FALSE(step().standstill);
    /* Shorted, it shows no current: it stands, or there is no motor. Two windows of 100 ms, and a
     * step to see the first. */
    in.bridge = BRIDGE_SHORT;
    TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, run(201).safe_bridge);
    TEST_ASSERT_TRUE(step().standstill);
}

void test_a_current_of_the_open_bridge_or_its_over_voltage_is_what_the_short_is_safe_against(void)
{
    in.speed_mrad_s = 0;
    in.rotor_valid = false;
    in.switching = false;
    in.bridge = BRIDGE_OFF;
    TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, run(100).safe_bridge);
    in.i_q_mA = 20000;
    TEST_ASSERT_EQUAL_INT(BRIDGE_SHORT, run(20).safe_bridge);
    setUp();
    in.speed_mrad_s = 0;
    in.rotor_valid = false;
    in.switching = false;
    in.bridge = BRIDGE_OFF;
    in.bus_voltage_mV = 60565;
    TEST_ASSERT_EQUAL_INT(BRIDGE_SHORT, step().safe_bridge);
    TEST_ASSERT_FALSE(step().standstill);
}

void test_a_wheel_stands_below_a_turn_in_twenty_seconds(void)
{
    in.speed_mrad_s = 299;
    TEST_ASSERT_TRUE(step().standstill);
    in.speed_mrad_s = -300;
    TEST_ASSERT_FALSE(step().standstill);
}

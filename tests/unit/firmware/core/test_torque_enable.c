/* SPDX-License-Identifier: Apache-2.0 */
/* The torque enable: its zero value permits no torque, so cleared memory enables none. */
#include "core/torque_enable.h"
#include "unity.h"

void setUp(void) {}

void tearDown(void) {}

void test_torque_enable_of_zeros_permits_no_torque(void)
{
    const torque_enable_t zero = {0};
    TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, zero.bridge);
    TEST_ASSERT_EQUAL_INT16(0, zero.drive_q15);
    TEST_ASSERT_EQUAL_INT16(0, zero.brake_q15);
}

void test_bridge_modes_are_frozen(void)
{
    TEST_ASSERT_EQUAL_INT(0, BRIDGE_OFF);
    TEST_ASSERT_EQUAL_INT(1, BRIDGE_PWM);
    TEST_ASSERT_EQUAL_INT(2, BRIDGE_SHORT);
}

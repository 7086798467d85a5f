/* SPDX-License-Identifier: Apache-2.0 */
/* The bridge's modes: numbers of the black box and of the exchange, and which of them short. */
#include "core/bridge.h"
#include "unity.h"

void setUp(void) {}

void tearDown(void) {}

void test_bridge_modes_are_frozen(void)
{
    TEST_ASSERT_EQUAL_INT(0, BRIDGE_OFF);
    TEST_ASSERT_EQUAL_INT(1, BRIDGE_PWM);
    TEST_ASSERT_EQUAL_INT(2, BRIDGE_SHORT);
    TEST_ASSERT_EQUAL_INT(3, BRIDGE_SHORT_HIGH);
}

void test_either_side_is_a_short_circuit_and_no_other_mode(void)
{
    TEST_ASSERT_FALSE(bridge_is_short(BRIDGE_OFF));
    TEST_ASSERT_FALSE(bridge_is_short(BRIDGE_PWM));
    TEST_ASSERT_TRUE(bridge_is_short(BRIDGE_SHORT));
    TEST_ASSERT_TRUE(bridge_is_short(BRIDGE_SHORT_HIGH));
}

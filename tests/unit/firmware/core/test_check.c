/* SPDX-License-Identifier: Apache-2.0 */
/* Assertions: no call while the condition is true, one call with module and number otherwise. */
#include "core/check.h"
#include "unity.h"

static int calls;
static check_module_t last_module;
static uint16_t last_number;

/* The handler of a test may return; the firmware's must not. */
void check_failed(check_module_t module, uint16_t number)
{
    calls++;
    last_module = module;
    last_number = number;
}

void setUp(void)
{
    calls = 0;
}

void tearDown(void) {}

void test_true_condition_does_not_call_the_handler(void)
{
    CHECK(CHECK_MODULE_FOC, 12, 1 + 1 == 2);
    TEST_ASSERT_EQUAL_INT(0, calls);
}

void test_false_condition_calls_the_handler_once_with_module_and_number(void)
{
    CHECK(CHECK_MODULE_TORQUE, 345, 1 + 1 == 3);
    TEST_ASSERT_EQUAL_INT(1, calls);
    TEST_ASSERT_EQUAL_INT(CHECK_MODULE_TORQUE, last_module);
    TEST_ASSERT_EQUAL_UINT16(345, last_number);
}

void test_the_condition_is_evaluated_exactly_once(void)
{
    int evaluated = 0;
    CHECK(CHECK_MODULE_CORE, 1, ++evaluated > 0);
    TEST_ASSERT_EQUAL_INT(1, evaluated);
}

void test_module_numbers_are_stable(void)
{
    TEST_ASSERT_EQUAL_INT(1, CHECK_MODULE_CORE);
    TEST_ASSERT_EQUAL_INT(2, CHECK_MODULE_CONFIG);
    TEST_ASSERT_EQUAL_INT(3, CHECK_MODULE_FOC);
    TEST_ASSERT_EQUAL_INT(4, CHECK_MODULE_TORQUE);
    TEST_ASSERT_EQUAL_INT(5, CHECK_MODULE_MONITOR);
    TEST_ASSERT_EQUAL_INT(6, CHECK_MODULE_MODES);
    TEST_ASSERT_EQUAL_INT(7, CHECK_MODULE_CONTROLLER);
    TEST_ASSERT_EQUAL_INT(8, CHECK_MODULE_APP);
}

/* SPDX-License-Identifier: Apache-2.0 */
#include <setjmp.h>

#include "core/check.h"
#include "mock_crash.h"
#include "mock_inverter.h"
#include "unity.h"

static jmp_buf out;
static bool is_off;

static void trip(int calls)
{
    (void)calls;
    is_off = true;
}

/* The handler waits for the watchdog without an end. */
static void leave(uint32_t module, uint32_t number, int calls)
{
    (void)calls;
    TEST_ASSERT_TRUE(is_off);
    TEST_ASSERT_EQUAL_UINT32(CHECK_MODULE_MONITOR, module);
    TEST_ASSERT_EQUAL_UINT32(12, number);
    longjmp(out, 1);
}

void setUp(void) {}

void tearDown(void) {}

void test_a_failed_check_switches_the_bridge_off_and_is_recorded(void)
{
    is_off = false;
    inverter_trip_Stub(trip);
    crash_of_check_Stub(leave);
    if (setjmp(out) == 0) {
        CHECK(CHECK_MODULE_MONITOR, 12, 1 + 1 == 3);
        TEST_FAIL_MESSAGE("the handler returned");
    }
    TEST_ASSERT_TRUE(is_off);
}

/* SPDX-License-Identifier: Apache-2.0 */
/* How long a finding must be present and absent, as the shell says it. */
#include "core/findings.h"
#include "unity.h"

void setUp(void) {}

void tearDown(void) {}

void test_times_are_written_with_their_field_or_number(void)
{
    TEST_ASSERT_EQUAL_STRING("at once", finding_text(FINDING_STATE_DAMAGED).qualify);
    TEST_ASSERT_EQUAL_STRING("never", finding_text(FINDING_STATE_DAMAGED).heal);
    TEST_ASSERT_EQUAL_STRING("torque ramp + monitor.rotor_fault_time_ms",
                             finding_text(FINDING_ANGLE_MISSING).qualify);
    TEST_ASSERT_EQUAL_STRING("monitor.rotor_warning_time_ms",
                             finding_text(FINDING_ROTOR_READING).heal);
    TEST_ASSERT_EQUAL_STRING("1000 ms", finding_text(FINDING_FORCED_TORQUE).heal);
    TEST_ASSERT_EQUAL_STRING("9 ms", finding_text(FINDING_STEPS).qualify);
}

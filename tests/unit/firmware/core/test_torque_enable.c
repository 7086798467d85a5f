/* SPDX-License-Identifier: Apache-2.0 */
/* The torque enable: its zero value permits no torque, so cleared memory enables none. */
#include "core/torque_enable.h"
#include "unity.h"

void setUp(void) {}

void tearDown(void) {}

void test_torque_enable_of_zeros_permits_no_torque(void)
{
    const torque_enable_t zero = {0};
    TEST_ASSERT_FALSE(torque_enable_any(zero));
}

void test_either_share_alone_permits_torque(void)
{
    const torque_enable_t drive = {.drive_q15 = 1};
    const torque_enable_t brake = {.brake_q15 = 1};
    TEST_ASSERT_TRUE(torque_enable_any(drive));
    TEST_ASSERT_TRUE(torque_enable_any(brake));
}

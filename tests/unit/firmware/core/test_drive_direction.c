/* SPDX-License-Identifier: Apache-2.0 */
/* Directions are part of the protocol: the numbers are frozen here. */
#include "core/drive_direction.h"
#include "unity.h"

void setUp(void) {}

void tearDown(void) {}

void test_no_published_number_has_moved(void)
{
    TEST_ASSERT_EQUAL_INT(0, DRIVE_DIRECTION_NEUTRAL);
    TEST_ASSERT_EQUAL_INT(1, DRIVE_DIRECTION_FORWARD);
    TEST_ASSERT_EQUAL_INT(2, DRIVE_DIRECTION_REVERSE);
}

void test_only_forward_and_reverse_have_a_sign(void)
{
    TEST_ASSERT_EQUAL_INT32(1, drive_direction_sign(DRIVE_DIRECTION_FORWARD));
    TEST_ASSERT_EQUAL_INT32(-1, drive_direction_sign(DRIVE_DIRECTION_REVERSE));
    TEST_ASSERT_EQUAL_INT32(0, drive_direction_sign(DRIVE_DIRECTION_NEUTRAL));
    TEST_ASSERT_EQUAL_INT32(0, drive_direction_sign((drive_direction_t)3));
}

/* SPDX-License-Identifier: Apache-2.0 */
/* The crash record of a failed check (hal/cortex_m/crash.c); faults need a core: tests/target. */
#include <string.h>

#include "hal/crash.h"
#include "hal/inverter.h"
#include "unity.h"

crash_record_t link_crash_begin;
uint32_t link_stack_begin[1], link_stack_end[1];

void inverter_trip(void) {}

void setUp(void)
{
    memset(&link_crash_begin, 0xA5, sizeof link_crash_begin); /* after power-up: anything */
}

void tearDown(void) {}

void test_there_is_no_record_after_power_up(void)
{
    TEST_ASSERT_NULL(crash_record());
    memset(&link_crash_begin, 0, sizeof link_crash_begin);
    TEST_ASSERT_NULL(crash_record());
    memset(&link_crash_begin, 0xFF, sizeof link_crash_begin);
    TEST_ASSERT_NULL(crash_record());
}

void test_the_latest_failed_check_is_kept_and_counted(void)
{
    crash_of_check(3, 17);
    crash_of_check(7, 2);
    const crash_record_t *record = crash_record();
    TEST_ASSERT_NOT_NULL(record);
    TEST_ASSERT_EQUAL_UINT32(2, record->value[CRASH_COUNT]);
    TEST_ASSERT_EQUAL_UINT32(CRASH_CAUSE_CHECK, record->value[CRASH_CAUSE]);
    TEST_ASSERT_EQUAL_HEX32(0x00070002, record->value[CRASH_PC]);
    TEST_ASSERT_EQUAL_HEX32(UINT32_MAX, record->value[CRASH_ADDRESS]);
}

void test_a_record_with_one_wrong_bit_is_none(void)
{
    crash_of_check(3, 17);
    for (uint32_t i = 0; i < CRASH_VALUES; i++) {
        link_crash_begin.value[i] ^= 1U << (i % 32U);
        TEST_ASSERT_NULL(crash_record());
        link_crash_begin.value[i] ^= 1U << (i % 32U);
    }
    TEST_ASSERT_NOT_NULL(crash_record());
}

/* SPDX-License-Identifier: Apache-2.0 */
/* Modes are part of the protocol: the numbers are frozen here. */
#include <string.h>

#include "core/operating_mode.h"
#include "unity.h"

void setUp(void) {}

void tearDown(void) {}

void test_published_numbers_are_unchanged(void)
{
    static const operating_mode_t FROZEN[] = {MODE_BOOT, MODE_SELFTEST, MODE_OFFSET_CAL, MODE_READY,
                                              MODE_RUN,  MODE_LIMP,     MODE_FAULT};
    for (int number = 0; number < (int)(sizeof FROZEN / sizeof FROZEN[0]); number++) {
        TEST_ASSERT_EQUAL_INT(number, FROZEN[number]);
    }
}

void test_every_mode_has_a_name(void)
{
    for (operating_mode_t mode = MODE_BOOT; mode <= MODE_FAULT; mode++) {
        TEST_ASSERT_TRUE(strcmp("unknown mode", operating_mode_text(mode)) != 0);
        for (operating_mode_t other = MODE_BOOT; other < mode; other++) {
            TEST_ASSERT_TRUE(strcmp(operating_mode_text(other), operating_mode_text(mode)) != 0);
        }
    }
    TEST_ASSERT_EQUAL_STRING("unknown mode", operating_mode_text((operating_mode_t)99));
}

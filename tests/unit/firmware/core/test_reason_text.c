/* SPDX-License-Identifier: Apache-2.0 */
/* Texts of reasons: each its own, that of its row. */
#include <string.h>

#include "core/reason.h"
#include "unity.h"

/* The lists again, as the enumeration is made of them. */
#define LIMIT_ROW(number, identifier, text) text,
#define FAULT_ROW(number, identifier, text, clearing, driver) text,
static const char *const TEXTS[] = {LIMIT_LIST(LIMIT_ROW) FAULT_LIST(FAULT_ROW)};
enum { ROWS = sizeof(TEXTS) / sizeof(TEXTS[0]) };

void setUp(void) {}
void tearDown(void) {}

void test_every_reason_has_the_text_of_its_row(void)
{
    for (uint32_t place = 0; place < ROWS; place++) {
        reason_t reason = REASON_NONE;
        TEST_ASSERT_TRUE(reason_listed(place, &reason));
        TEST_ASSERT_EQUAL_STRING(TEXTS[place], reason_text(reason));
    }
}

void test_every_text_says_something_of_its_own(void)
{
    for (int i = 0; i < ROWS; i++) {
        TEST_ASSERT_TRUE(strlen(TEXTS[i]) >= 5);
        TEST_ASSERT_TRUE(strcmp(TEXTS[i], "unknown reason") != 0);
        for (int k = 0; k < i; k++) {
            TEST_ASSERT_TRUE(strcmp(TEXTS[i], TEXTS[k]) != 0);
        }
    }
}

void test_text_of_a_number_outside_the_list_is_unknown(void)
{
    static const int UNKNOWN[] = {40, 63, 200, 255};
    for (unsigned i = 0; i < sizeof(UNKNOWN) / sizeof(UNKNOWN[0]); i++) {
        TEST_ASSERT_EQUAL_STRING("unknown reason", reason_text((reason_t)UNKNOWN[i]));
    }
}

/* SPDX-License-Identifier: Apache-2.0 */
/* What is waited for is part of the CAN protocol: published numbers must not change. */
#include <string.h>

#include "core/waits_for.h"
#include "unity.h"

void setUp(void) {}

void tearDown(void) {}

/* An independent copy of the list, in its order. */
static const waits_for_t FROZEN[] = {
    WAITS_FOR_NONE,        WAITS_FOR_CONFIGURATION,   WAITS_FOR_SELFTEST,
    WAITS_FOR_LOWER_SPEED, WAITS_FOR_OFFSETS,         WAITS_FOR_ENABLE,
    WAITS_FOR_DEMAND_LINK, WAITS_FOR_PEDAL_RELEASE,   WAITS_FOR_ROTOR_ANGLE,
    WAITS_FOR_BATTERY,     WAITS_FOR_DIRECTION,       WAITS_FOR_FAULT_CAUSE,
    WAITS_FOR_REST,        WAITS_FOR_ACKNOWLEDGEMENT, WAITS_FOR_RESTART,
    WAITS_FOR_COOLING};
enum { FROZEN_COUNT = sizeof(FROZEN) / sizeof(FROZEN[0]) };

void test_published_numbers_are_unchanged_and_have_texts_of_their_own(void)
{
    for (int i = 0; i < FROZEN_COUNT; i++) {
        TEST_ASSERT_EQUAL_INT(i, FROZEN[i]);
        const char *text = waits_for_text(FROZEN[i]);
        TEST_ASSERT_TRUE(strcmp(text, "unknown") != 0);
        for (int k = 0; k < i; k++) {
            TEST_ASSERT_TRUE(strcmp(text, waits_for_text(FROZEN[k])) != 0);
        }
    }
}

void test_every_number_has_the_text_of_its_line(void)
{
#define TEXT_OF_LINE(number, identifier, text)                                                     \
    TEST_ASSERT_EQUAL_STRING(text, waits_for_text(WAITS_FOR_##identifier));
    WAITS_FOR_LIST(TEXT_OF_LINE)
#undef TEXT_OF_LINE
}

void test_text_of_a_number_outside_the_list_is_unknown(void)
{
    TEST_ASSERT_EQUAL_STRING("unknown", waits_for_text((waits_for_t)FROZEN_COUNT));
    TEST_ASSERT_EQUAL_STRING("unknown", waits_for_text((waits_for_t)255));
}

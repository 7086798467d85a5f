/* SPDX-License-Identifier: Apache-2.0 */
/* The table of faults: complete, free of contradictions, and the same for its two ways to read it.
 */
#include <string.h>

#include "core/fault.h"
#include "fault_rows.h"
#include "unity.h"

void setUp(void) {}

void tearDown(void) {}

static const fault_t *row_of(reason_t reason)
{
    const fault_t *row = fault_row(0);
    for (unsigned i = 0; row != NULL && row->reason != reason; row = fault_row(++i)) {
    }
    return row;
}

void test_every_code_of_a_fault_has_exactly_one_row(void)
{
    for (int number = 0; number < 256; number++) {
        const reason_t reason = (reason_t)number;
        const bool listed = strcmp(reason_text(reason), "unknown reason") != 0;
        int rows = 0;
        for (unsigned i = 0; fault_row(i) != NULL; i++) {
            rows += fault_row(i)->reason == reason ? 1 : 0;
        }
        TEST_ASSERT_LESS_THAN_INT(2, rows);
        if (number >= (int)REASON_FIRST_FAULT) {
            TEST_ASSERT_EQUAL_INT(listed ? 1 : 0, rows);
        }
    }
}

void test_reaction_and_clearing_of_a_code_are_those_of_its_row(void)
{
    for (int number = 0; number < 256; number++) {
        const fault_t *row = row_of((reason_t)number);
        if (row != NULL) {
            TEST_ASSERT_EQUAL_INT(row->reaction, fault_reaction((reason_t)number));
            TEST_ASSERT_EQUAL_INT(row->clearing, fault_clearing((reason_t)number));
        }
    }
    TEST_ASSERT_EQUAL_INT(FAULT_REACTION_NONE, fault_reaction(REASON_MAX_TORQUE));
    TEST_ASSERT_EQUAL_INT(FAULT_CLEARING_HEALS, fault_clearing(REASON_MAX_TORQUE));
}

/* A damaged byte must not read as a fault that heals. */
void test_a_number_outside_the_list_has_the_strictest_answer(void)
{
    TEST_ASSERT_EQUAL_INT(FAULT_REACTION_SAFE_STATE, fault_reaction((reason_t)200));
    TEST_ASSERT_EQUAL_INT(FAULT_CLEARING_RESTART, fault_clearing((reason_t)200));
    for (int number = 0; number < 256; number++) { /* gaps between the codes as well */
        const reason_t reason = (reason_t)number;
        if (strcmp(reason_text(reason), "unknown reason") == 0) {
            TEST_ASSERT_EQUAL_INT(FAULT_REACTION_SAFE_STATE, fault_reaction(reason));
            TEST_ASSERT_EQUAL_INT(FAULT_CLEARING_RESTART, fault_clearing(reason));
        }
    }
}

void test_what_is_latched_never_heals_and_takes_the_torque_and_a_warning_has_a_heal_time(void)
{
    for (unsigned i = 0; fault_row(i) != NULL; i++) {
        const fault_t *row = fault_row(i);
        const bool never = strcmp(row->heal, "never") == 0;
        TEST_ASSERT_EQUAL_MESSAGE(is_latched(row), never, reason_name(row->reason));
        if (never) {
            TEST_ASSERT_TRUE_MESSAGE(row->reaction == FAULT_REACTION_SAFE_STATE ||
                                         row->reaction == FAULT_REACTION_TRIP ||
                                         row->reaction == FAULT_REACTION_RAMP,
                                     reason_name(row->reason));
            TEST_ASSERT_TRUE_MESSAGE((int)row->reason >= (int)REASON_FIRST_FAULT,
                                     reason_name(row->reason));
        }
        TEST_ASSERT_TRUE_MESSAGE(strlen(row->qualify) > 0, reason_name(row->reason));
    }
}

void test_every_word_of_the_columns_has_a_text_and_other_numbers_are_unknown(void)
{
    for (unsigned i = 0; fault_row(i) != NULL; i++) {
        const fault_t *row = fault_row(i);
        TEST_ASSERT_TRUE(strlen(fault_reaction_text(row->reaction)) > 5);
        TEST_ASSERT_TRUE(strlen(fault_clearing_text(row->clearing)) > 5);
        TEST_ASSERT_TRUE(strlen(fault_driver_text(row->driver)) > 5);
    }
    TEST_ASSERT_EQUAL_STRING("unknown", fault_reaction_text((fault_reaction_t)99));
    TEST_ASSERT_EQUAL_STRING("unknown", fault_clearing_text((fault_clearing_t)99));
    TEST_ASSERT_EQUAL_STRING("unknown", fault_driver_text((fault_driver_t)99));
}

/* SPDX-License-Identifier: Apache-2.0 */
/* The table of faults: complete, free of contradictions, and the same for its two ways to read it.
 */
#include "core/fault.h"

#include <string.h>

#include "unity.h"

void setUp(void) {}

void tearDown(void) {}

/* The list again, as the enumeration is made of it. */
#define FAULT_ROW(number, identifier, text, clearing, driver)                                      \
    {REASON_##identifier, FAULT_CLEARING_##clearing, FAULT_DRIVER_##driver},
static const struct {
    reason_t reason;
    fault_clearing_t clearing;
    fault_driver_t driver;
} ROWS[] = {FAULT_LIST(FAULT_ROW)};
enum { ROW_COUNT = sizeof ROWS / sizeof ROWS[0] };

static bool is_code(int number)
{
    return strcmp(reason_text((reason_t)number), "unknown reason") != 0;
}

void test_rows_are_listed_in_their_order_and_end(void)
{
    reason_t reason = REASON_NONE;
    for (uint32_t place = 0; place < ROW_COUNT; place++) {
        TEST_ASSERT_TRUE(fault_listed(place, &reason));
        TEST_ASSERT_EQUAL_INT(ROWS[place].reason, reason);
    }
    reason = REASON_ABS;
    TEST_ASSERT_FALSE(fault_listed(ROW_COUNT, &reason));
    TEST_ASSERT_FALSE(fault_listed(UINT32_MAX, &reason));
    TEST_ASSERT_EQUAL_INT(REASON_ABS, reason);
}

void test_every_code_of_a_fault_has_exactly_one_row(void)
{
    for (int number = 0; number < 256; number++) {
        int rows = 0;
        reason_t reason = REASON_NONE;
        for (uint32_t place = 0; fault_listed(place, &reason); place++) {
            rows += (int)reason == number ? 1 : 0;
        }
        TEST_ASSERT_LESS_THAN_INT(2, rows);
        if (number >= (int)REASON_FIRST_FAULT) {
            TEST_ASSERT_EQUAL_INT(is_code(number) ? 1 : 0, rows);
        }
    }
}

void test_clearing_and_driver_of_a_code_are_those_of_its_row(void)
{
    for (unsigned place = 0; place < ROW_COUNT; place++) {
        TEST_ASSERT_EQUAL_INT(ROWS[place].clearing, fault_clearing(ROWS[place].reason));
        TEST_ASSERT_EQUAL_INT(ROWS[place].driver, fault_driver(ROWS[place].reason));
    }
    TEST_ASSERT_EQUAL_INT(FAULT_CLEARING_RESTART, fault_clearing(REASON_MEMORY));
    TEST_ASSERT_EQUAL_INT(FAULT_CLEARING_ACKNOWLEDGED, fault_clearing(REASON_OVERCURRENT));
    TEST_ASSERT_EQUAL_INT(FAULT_CLEARING_SHOWN, fault_clearing(REASON_DEMAND_TIMEOUT));
    TEST_ASSERT_EQUAL_INT(FAULT_CLEARING_HEALS, fault_clearing(REASON_FLUX_WEAK));
    TEST_ASSERT_EQUAL_INT(FAULT_DRIVER_NO_MOTOR, fault_driver(REASON_OVERCURRENT));
}

void test_a_limit_heals_and_means_reduced_power(void)
{
    static const reason_t LIMITS[] = {REASON_NONE, REASON_MAX_TORQUE, REASON_ACCELERATOR_LOCKED};
    for (int k = 0; k < 3; k++) {
        TEST_ASSERT_EQUAL_INT(FAULT_CLEARING_HEALS, fault_clearing(LIMITS[k]));
        TEST_ASSERT_EQUAL_INT(FAULT_DRIVER_REDUCED, fault_driver(LIMITS[k]));
    }
}

/* A damaged byte must not read as a fault that heals. */
void test_a_number_outside_the_list_has_the_strictest_answer(void)
{
    TEST_ASSERT_FALSE(is_code(200));
    for (int number = 0; number < 256; number++) { /* gaps between the codes as well */
        if (!is_code(number)) {
            TEST_ASSERT_EQUAL_INT(FAULT_CLEARING_RESTART, fault_clearing((reason_t)number));
            TEST_ASSERT_EQUAL_INT(FAULT_DRIVER_SERVICE, fault_driver((reason_t)number));
        }
    }
}

void test_what_is_latched_has_the_number_of_a_fault(void)
{
    for (unsigned place = 0; place < ROW_COUNT; place++) {
        const bool latched = ROWS[place].clearing == FAULT_CLEARING_ACKNOWLEDGED ||
                             ROWS[place].clearing == FAULT_CLEARING_RESTART;
        TEST_ASSERT_TRUE_MESSAGE(!latched || (int)ROWS[place].reason >= (int)REASON_FIRST_FAULT,
                                 reason_name(ROWS[place].reason));
    }
}

#define IDENTIFIER_AND_TEXT(identifier, text) {#identifier, text},

void test_every_word_of_the_columns_has_a_text_of_its_own_and_other_numbers_are_unknown(void)
{
    static const char *const CLEARINGS[][2] = {FAULT_CLEARING_LIST(IDENTIFIER_AND_TEXT)};
    static const char *const DRIVERS[][2] = {FAULT_DRIVER_LIST(IDENTIFIER_AND_TEXT)};
    for (unsigned k = 0; k < sizeof CLEARINGS / sizeof CLEARINGS[0]; k++) {
        TEST_ASSERT_EQUAL_STRING(CLEARINGS[k][1], fault_clearing_text((fault_clearing_t)k));
    }
    for (unsigned k = 0; k < sizeof DRIVERS / sizeof DRIVERS[0]; k++) {
        TEST_ASSERT_EQUAL_STRING(DRIVERS[k][1], fault_driver_text((fault_driver_t)k));
    }
    TEST_ASSERT_EQUAL_STRING("reduced power", fault_driver_text(FAULT_DRIVER_REDUCED));
    TEST_ASSERT_EQUAL_STRING("unknown", fault_clearing_text((fault_clearing_t)99));
    TEST_ASSERT_EQUAL_STRING("unknown", fault_driver_text((fault_driver_t)99));
}

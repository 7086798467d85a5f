/* SPDX-License-Identifier: Apache-2.0 */
#include <string.h>

#include "comms/text.h"
#include "unity.h"

static text_t text;

void setUp(void)
{
    memset(&text, 0xA5, sizeof text); /* uninitialised fields are visible */
    text_clear(&text);
}

void tearDown(void) {}

void test_integers_are_written_in_decimal_up_to_both_ends_of_the_range(void)
{
    text_add_integer(&text, 0);
    text_add(&text, " ");
    text_add_integer(&text, -7);
    text_add(&text, " ");
    text_add_integer(&text, INT32_MAX);
    text_add(&text, " ");
    text_add_integer(&text, INT32_MIN);
    TEST_ASSERT_EQUAL_STRING("0 -7 2147483647 -2147483648", text.chars);
}

void test_milli_units_are_written_with_a_point_and_trailing_zeros(void)
{
    text_add_decimal(&text, 53012, 3);
    text_add(&text, " ");
    text_add_decimal(&text, -5, 3);
    text_add(&text, " ");
    text_add_decimal(&text, 0, 2);
    text_add(&text, " ");
    text_add_decimal(&text, -1000, 3);
    text_add(&text, " ");
    text_add_decimal(&text, INT32_MIN, 9);
    TEST_ASSERT_EQUAL_STRING("53.012 -0.005 0.00 -1.000 -2.147483648", text.chars);
}

void test_hexadecimal_has_always_eight_digits(void)
{
    text_add_hex(&text, 0xBEEF);
    TEST_ASSERT_EQUAL_STRING("0x0000BEEF", text.chars);
}

void test_text_is_truncated_at_its_buffer_and_stays_terminated(void)
{
    for (int i = 0; i < 100; i++) {
        text_add(&text, "0123456789");
    }
    TEST_ASSERT_EQUAL_UINT32(TEXT_CAPACITY - 1, text.length);
    TEST_ASSERT_EQUAL_size_t(TEXT_CAPACITY - 1, strlen(text.chars));
}

void test_a_cleared_line_is_an_empty_string(void)
{
    TEST_ASSERT_EQUAL_STRING("", text.chars);
    TEST_ASSERT_EQUAL_UINT32(0, text.length);
}

void test_columns_are_aligned_and_separated_by_a_blank(void)
{
    text_add(&text, "a");
    text_add_until(&text, 4);
    text_add(&text, "b");
    text_add_until(&text, 2);
    text_add(&text, "c");
    TEST_ASSERT_EQUAL_STRING("a   b c", text.chars);
}

void test_column_beyond_the_end_fills_the_line(void)
{
    text_add_until(&text, 10000);
    TEST_ASSERT_EQUAL_UINT32(TEXT_CAPACITY - 1, text.length);
    TEST_ASSERT_EQUAL_size_t(TEXT_CAPACITY - 1, strlen(text.chars));
}

void test_a_text_begins_with_each_of_its_prefixes_and_no_other(void)
{
    TEST_ASSERT_TRUE(text_begins_with("rotor.hall", ""));
    TEST_ASSERT_TRUE(text_begins_with("rotor.hall", "rotor."));
    TEST_ASSERT_TRUE(text_begins_with("rotor.hall", "rotor.hall"));
    TEST_ASSERT_FALSE(text_begins_with("rotor.hall", "rotor.halls"));
    TEST_ASSERT_FALSE(text_begins_with("rotor.hall", "motor"));
    TEST_ASSERT_FALSE(text_begins_with("", "m"));
}

/* SPDX-License-Identifier: Apache-2.0 */
/* A list of words as one string. */
#include "core/words.h"

#include "unity.h"

void setUp(void) {}

void tearDown(void) {}

/* Behind the zero that ends the literal, which ends the list. */
static const char LIST[] = "one\0a second word\0c\0";

void test_each_word_has_its_number(void)
{
    TEST_ASSERT_EQUAL_STRING("one", words_at(LIST, 0));
    TEST_ASSERT_EQUAL_STRING("a second word", words_at(LIST, 1));
    TEST_ASSERT_EQUAL_STRING("c", words_at(LIST, 2));
}

void test_a_number_beyond_the_list_is_unknown(void)
{
    static const char FOLLOWED[] = "one\0\0other\0";
    TEST_ASSERT_EQUAL_STRING("unknown", words_at(LIST, 3));
    TEST_ASSERT_EQUAL_STRING("unknown", words_at(LIST, UINT32_MAX));
    for (uint32_t number = 1; number < 5; number++) { /* what comes after the list is not read */
        TEST_ASSERT_EQUAL_STRING("unknown", words_at(FOLLOWED, number));
    }
}

void test_an_empty_list_has_no_word(void)
{
    TEST_ASSERT_EQUAL_STRING("unknown", words_at("", 0));
    TEST_ASSERT_EQUAL_STRING("unknown", words_at("", 1));
}

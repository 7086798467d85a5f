/* SPDX-License-Identifier: Apache-2.0 */
#include <string.h>

#include "comms/line_edit.h"
#include "unity.h"

static line_edit_t edit;
static text_t echo;

void setUp(void)
{
    memset(&edit, 0xA5, sizeof edit); /* uninitialised fields are visible */
    line_edit_init(&edit);
    text_clear(&echo);
}

void tearDown(void) {}

static line_edit_event_t type(const char *keys)
{
    line_edit_event_t event = LINE_EDIT_GOES_ON;
    for (uint32_t i = 0; keys[i] != '\0'; i++) {
        event = line_edit_receive(&edit, (uint8_t)keys[i], &echo);
    }
    return event;
}

static void assert_line(const char *expected, const char *keys)
{
    TEST_ASSERT_EQUAL_INT(LINE_EDIT_ENDED, type(keys));
    TEST_ASSERT_EQUAL_STRING(expected, edit.line);
}

void test_typed_characters_are_echoed_and_form_the_line(void)
{
    assert_line("config motor", "config motor\r");
    TEST_ASSERT_EQUAL_STRING("config motor\r\n", echo.chars);
}

void test_every_printable_character_can_be_typed(void)
{
    for (int c = '!'; c <= '~'; c++) {
        const char keys[] = {(char)c, '\0'};
        text_clear(&echo);
        (void)type(keys);
        TEST_ASSERT_EQUAL_STRING(keys, echo.chars);
        assert_line(keys, "\r");
    }
}

void test_line_feed_as_first_key_is_an_empty_line(void)
{
    assert_line("", "\n");
}

void test_leading_and_trailing_blanks_are_removed(void)
{
    assert_line("a  b", "   a  b  \r");
    assert_line("", "     \r");
}

void test_return_line_feed_and_both_end_one_line_each(void)
{
    assert_line("a", "a\r");
    assert_line("b", "b\n");
    assert_line("c", "c\r");
    TEST_ASSERT_EQUAL_INT(LINE_EDIT_GOES_ON, type("\n")); /* the second half of CR LF */
    TEST_ASSERT_EQUAL_INT(LINE_EDIT_ENDED, type("\n"));
    TEST_ASSERT_EQUAL_STRING("", edit.line);
    TEST_ASSERT_EQUAL_INT(LINE_EDIT_ENDED, type("\r"));
    TEST_ASSERT_EQUAL_INT(LINE_EDIT_ENDED, type("\r"));
}

void test_backspace_and_delete_remove_one_character(void)
{
    assert_line("status", "\b\x7Fstax\btus\r");
    TEST_ASSERT_EQUAL_STRING("stax\b \btus\r\n", echo.chars);
    assert_line("ab", "abc\x7F\r");
}

void test_control_u_clears_the_line(void)
{
    assert_line("new", "old words\x15new\r");
    TEST_ASSERT_NOT_NULL(strstr(echo.chars, "\r\x1B[K" LINE_EDIT_PROMPT "new"));
}

void test_control_c_cancels_the_line(void)
{
    TEST_ASSERT_EQUAL_INT(LINE_EDIT_CANCELLED, type("half\x03"));
    assert_line("", "\r");
}

void test_arrow_up_restores_the_last_line(void)
{
    assert_line("status", "status\r");
    assert_line("status", "\x1B[A\r");
    assert_line("statuses", "xyz\x1B[A"
                            "es\r");
    assert_line("statuses", "\x1B[A\r");
}

void test_empty_line_is_not_stored_as_last_line(void)
{
    assert_line("status", "status\r");
    assert_line("", "\r");
    assert_line("", "   \r");
    assert_line("status", "\x1B[A\r");
}

void test_other_keys_have_no_effect(void)
{
    assert_line("", "\x1B[A\r"); /* no last line yet */
    text_clear(&echo);
    assert_line("ab", "a\x1B[@\x1B[~\x1B[B\x1B[C\x1B[D\x1B[1;5C\x1B[3~\t\x01\x07"
                      "b\r");
    TEST_ASSERT_EQUAL_STRING("ab\r\n", echo.chars);
    text_clear(&echo);
    for (unsigned byte = 0x80; byte < 0x100; byte++) {
        TEST_ASSERT_EQUAL_INT(LINE_EDIT_GOES_ON, line_edit_receive(&edit, (uint8_t)byte, &echo));
    }
    TEST_ASSERT_EQUAL_UINT32(0, echo.length);
}

void test_single_escape_does_not_consume_the_next_key(void)
{
    assert_line("ab", "a\x1B"
                      "b\r");
}

/* ECMA-48: bytes of a sequence are 0x20 .. 0x7E. */
void test_sequence_that_is_cut_off_does_not_consume_a_control_key(void)
{
    TEST_ASSERT_EQUAL_INT(LINE_EDIT_CANCELLED, type("a\x1B[1;\x03"));
    assert_line("b", "b\r");
    assert_line("c", "c\x1B[\r");
    assert_line("de", "dx\x1B[1\x7F"
                      "e\r");
    assert_line("de", "f\x1B[1\x1B[A\r");
}

void test_full_line_sends_a_bell_and_keeps_its_content(void)
{
    char keys[LINE_EDIT_CHARS + 1];
    memset(keys, 'k', LINE_EDIT_CHARS);
    keys[LINE_EDIT_CHARS] = '\0';
    (void)type(keys);
    TEST_ASSERT_EQUAL_STRING(keys, echo.chars);
    text_clear(&echo);
    (void)type("more");
    TEST_ASSERT_EQUAL_STRING("\a\a\a\a", echo.chars);
    assert_line(keys, "\r");
    text_clear(&echo);
    assert_line(keys, "\x1B[A\r");
}

/* One key's echo must fit a text, whatever has been typed. */
void test_longest_echo_of_one_key_is_complete(void)
{
    char keys[LINE_EDIT_CHARS + 1];
    memset(keys, 'k', LINE_EDIT_CHARS);
    keys[LINE_EDIT_CHARS] = '\0';
    (void)type(keys);
    (void)type("\r");
    (void)type(keys);
    (void)type("\x1B[");
    text_clear(&echo);
    (void)type("A");
    TEST_ASSERT_TRUE(echo.length + 1 < TEXT_CAPACITY);
    TEST_ASSERT_EQUAL_STRING(keys, &echo.chars[echo.length - LINE_EDIT_CHARS]);
}

void test_line_stays_within_its_bounds_for_any_bytes(void)
{
    uint32_t random = 7;
    for (int i = 0; i < 200000; i++) {
        random = random * 1664525U + 1013904223U; /* Numerical Recipes' generator */
        text_clear(&echo);
        (void)line_edit_receive(&edit, (uint8_t)(random >> 24), &echo);
        TEST_ASSERT_TRUE(edit.length <= LINE_EDIT_CHARS);
    }
}

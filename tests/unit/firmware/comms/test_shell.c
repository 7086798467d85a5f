/* SPDX-License-Identifier: Apache-2.0 */
#include <string.h>

#include "comms/shell.h"
#include "core/reason.h"
#include "unity.h"

enum { ECHO, COUNT, COMMANDS_COUNT };
static const shell_command_t COMMANDS[COMMANDS_COUNT] = {
    [ECHO] = {"echo", "WORDS", "says them again"},
    [COUNT] = {"count", "", "a thousand lines"},
};

static shell_t shell;
static char screen[65536];
static uint32_t screen_bytes;

void setUp(void)
{
    memset(&shell, 0xA5, sizeof shell); /* uninitialised fields are visible */
    shell_init(&shell, COMMANDS, COMMANDS_COUNT);
    screen_bytes = 0;
    screen[0] = '\0';
}

void tearDown(void) {}

static void type(const char *keys)
{
    for (uint32_t i = 0; keys[i] != '\0'; i++) {
        shell_receive(&shell, (uint8_t)keys[i]);
    }
}

/* The application: answers a command with one line. */
static bool answer_one(void)
{
    shell_request_t asked;
    if (!shell_next_request(&shell, &asked)) {
        return false;
    }
    text_t line;
    text_clear(&line);
    if (asked.command == ECHO && asked.number == 0) {
        text_add(&line, "<");
        text_add(&line, asked.argument);
        text_add(&line, ">");
        shell_answer(&shell, &line);
    } else if (asked.command == COUNT && asked.number < 1000) {
        text_add_integer(&line, (int32_t)asked.number);
        shell_answer(&shell, &line);
    } else {
        shell_answered(&shell);
    }
    return true;
}

/* A serial line that takes a bounded number of bytes at a time. */
static void carry(uint32_t at_most)
{
    const char *bytes;
    const uint32_t waiting = shell_pending(&shell, &bytes);
    const uint32_t count = waiting < at_most ? waiting : at_most;
    memcpy(&screen[screen_bytes], bytes, count);
    screen_bytes += count;
    screen[screen_bytes] = '\0';
    shell_sent(&shell, count);
}

static void run_with(uint32_t bytes_at_a_time)
{
    for (int i = 0; i < 100000 && !shell_idle(&shell); i++) {
        while (answer_one()) {
        }
        carry(bytes_at_a_time);
    }
    TEST_ASSERT_TRUE(shell_idle(&shell));
}

static void run(void)
{
    run_with(UINT32_MAX);
}

static void assert_screen(const char *expected)
{
    TEST_ASSERT_EQUAL_STRING(expected, screen);
}

void test_a_command_is_echoed_answered_and_followed_by_the_prompt(void)
{
    type("echo two words\r");
    run();
    assert_screen("echo two words\r\n<two words>\r\n> ");
}

void test_a_command_without_arguments_gets_none(void)
{
    type("echo\r");
    run();
    assert_screen("echo\r\n<>\r\n> ");
}

void test_empty_line_gets_only_a_prompt(void)
{
    type("\r");
    run();
    assert_screen("\r\n> ");
}

void test_answer_to_an_unknown_command_contains_it(void)
{
    type("bogus words\r");
    run();
    assert_screen("bogus words\r\nbogus: unknown; help lists the commands\r\n> ");
}

void test_prefix_or_extension_of_a_command_is_unknown(void)
{
    type("ech\rechoes\r");
    run();
    TEST_ASSERT_NOT_NULL(strstr(screen, "ech: unknown"));
    TEST_ASSERT_NOT_NULL(strstr(screen, "echoes: unknown"));
}

void test_help_lists_the_shells_own_commands_and_the_owners(void)
{
    type("help\r");
    run();
    assert_screen("help\r\n"
                  "help                this list\r\n"
                  "reasons             number, name and meaning of every limit and fault\r\n"
                  "echo WORDS          says them again\r\n"
                  "count               a thousand lines\r\n> ");
}

void test_reasons_lists_each_reason_once_with_number_name_and_text(void)
{
    static const char *const LINES[] = {
#define LINE_OF(number, identifier, text) "\n" #number " ", " " #identifier " ", " " text "\r\n",
#define FAULT_LINE_OF(number, identifier, text, clearing, driver) LINE_OF(number, identifier, text)
        LIMIT_LIST(LINE_OF) FAULT_LIST(FAULT_LINE_OF)
#undef LINE_OF
#undef FAULT_LINE_OF
    };
    enum { PARTS = sizeof LINES / sizeof LINES[0] };
    type("reasons\r");
    run();
    for (uint32_t i = 0; i < PARTS; i++) {
        TEST_ASSERT_NOT_NULL_MESSAGE(strstr(screen, LINES[i]), LINES[i]);
    }
    uint32_t lines = 0;
    for (const char *c = screen; *c != '\0'; c++) {
        lines += *c == '\n' ? 1U : 0U;
    }
    TEST_ASSERT_EQUAL_UINT32(1 + PARTS / 3, lines); /* the echo, and one for each */
}

/* 0 .. 999 with their ends of line are 4 890 bytes, through a buffer of 1 024. */
static void assert_counted_to_a_thousand(void)
{
    const char *at = strchr(screen, '\n') + 1;
    for (int i = 0; i < 1000; i++) {
        text_t line;
        text_clear(&line);
        text_add_integer(&line, i);
        text_add(&line, "\r\n");
        TEST_ASSERT_EQUAL_STRING_LEN(line.chars, at, line.length);
        at += line.length;
    }
    TEST_ASSERT_EQUAL_STRING("> ", at);
}

void test_answer_longer_than_the_buffer_is_complete(void)
{
    type("count\r");
    run();
    assert_counted_to_a_thousand();
}

void test_long_answer_is_complete_over_a_line_that_takes_one_byte_at_a_time(void)
{
    type("count\r");
    run_with(1);
    assert_counted_to_a_thousand();
}

void test_input_during_an_answer_is_processed_after_it(void)
{
    type("echo first\recho second\recho third\r");
    run();
    assert_screen("echo first\r\n<first>\r\n> "
                  "echo second\r\n<second>\r\n> "
                  "echo third\r\n<third>\r\n> ");
}

void test_the_shells_own_answers_follow_each_other_too(void)
{
    type("bogus\rechoes\r");
    run();
    assert_screen("bogus\r\nbogus: unknown; help lists the commands\r\n> "
                  "echoes\r\nechoes: unknown; help lists the commands\r\n> ");
}

void test_control_c_ends_an_answer_and_discards_pending_input(void)
{
    type("count\r");
    TEST_ASSERT_TRUE(answer_one());
    type("echo never\r\x03");
    run();
    assert_screen("count\r\n0\r\n^C\r\n> ");
    type("echo now\r");
    run();
    TEST_ASSERT_NOT_NULL(strstr(screen, "<now>"));
    TEST_ASSERT_NULL(strstr(screen, "never"));
}

void test_pending_input_beyond_its_buffer_is_discarded(void)
{
    type("count\r");
    for (int i = 0; i < 10000; i++) {
        shell_receive(&shell, 'x');
    }
    TEST_ASSERT_EQUAL_UINT32(SHELL_AHEAD_BYTES, shell.ahead_bytes);
    run();
    TEST_ASSERT_EQUAL_UINT32(LINE_EDIT_CHARS, shell.edit.length);
}

void test_unsolicited_lines_are_complete(void)
{
    text_t line;
    text_clear(&line);
    text_add(&line, "hello");
    shell_print(&shell, &line);
    run();
    assert_screen("hello\r\n");
}

void test_unsolicited_lines_that_do_not_fit_are_discarded(void)
{
    text_t line;
    text_clear(&line);
    text_add(&line, "0123456789"); /* with its end 12 bytes: 85 of them fit 1 024 */
    for (int i = 0; i < 100; i++) {
        shell_print(&shell, &line);
    }
    run();
    TEST_ASSERT_EQUAL_UINT32(85 * 12, screen_bytes);
}

/* Eight lines of 126 characters and two for their end: 1 024 bytes, not one too many. */
void test_the_buffer_can_be_filled_to_its_last_byte(void)
{
    text_t line;
    text_clear(&line);
    while (line.length < SHELL_PENDING_BYTES / 8 - 2) {
        text_add(&line, "x");
    }
    for (int i = 0; i < 9; i++) {
        shell_print(&shell, &line);
    }
    TEST_ASSERT_EQUAL_UINT32(SHELL_PENDING_BYTES, shell.pending_bytes);
    TEST_ASSERT_EQUAL_UINT32(0, shell.sent_bytes);
    run();
    TEST_ASSERT_EQUAL_UINT32(SHELL_PENDING_BYTES, screen_bytes);
}

void test_a_line_of_the_full_length_keeps_its_end(void)
{
    text_t line;
    text_clear(&line);
    while (line.length < TEXT_CAPACITY - 1) {
        text_add(&line, "x");
    }
    shell_print(&shell, &line);
    run();
    TEST_ASSERT_EQUAL_UINT32(TEXT_CAPACITY - 1 + 2, screen_bytes);
    TEST_ASSERT_EQUAL_STRING("x\r\n", &screen[screen_bytes - 3]);
}

void test_no_command_is_processed_without_space_for_an_answer(void)
{
    text_t line;
    text_clear(&line);
    text_add(&line, "0123456789");
    for (int i = 0; i < 70; i++) { /* 840 bytes: less space than a line needs is left */
        shell_print(&shell, &line);
    }
    type("echo x\r");
    shell_request_t asked;
    TEST_ASSERT_FALSE(shell_next_request(&shell, &asked));
    run();
    TEST_ASSERT_NOT_NULL(strstr(screen, "<x>"));
}

void test_taking_more_bytes_than_pending_is_bounded(void)
{
    type("a");
    shell_sent(&shell, 100000);
    const char *bytes;
    TEST_ASSERT_EQUAL_UINT32(0, shell_pending(&shell, &bytes));
    type("b");
    TEST_ASSERT_EQUAL_UINT32(1, shell_pending(&shell, &bytes));
}

void test_shell_accepts_any_bytes(void)
{
    uint32_t random = 3;
    for (int i = 0; i < 200000; i++) {
        random = random * 1664525U + 1013904223U; /* Numerical Recipes' generator */
        shell_receive(&shell, (uint8_t)(random >> 24));
        if ((random & 0x700U) == 0) {
            (void)answer_one();
        }
        const char *bytes;
        const uint32_t waiting = shell_pending(&shell, &bytes);
        TEST_ASSERT_TRUE(waiting <= SHELL_PENDING_BYTES);
        shell_sent(&shell, random & 7U);
    }
}

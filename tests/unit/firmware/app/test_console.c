/* SPDX-License-Identifier: Apache-2.0 */
/* Transfer between shell and serial line. Tests of the texts: test_report.c; of the input:
 * comms/shell. */
#include <string.h>

#include "app/console.h"
#include "boot_fixture.h"
#include "mock_analog.h"
#include "mock_crash.h"
#include "mock_flash.h"
#include "mock_inverter.h"
#include "mock_power.h"
#include "mock_serial.h"
#include "unity.h"

static console_t console;
static boot_report_t boot;
static slow_output_t output;
static node_t node;
static torque_limits_t limits;
static report_status_t status;
static fault_journal_t journal;
static char screen[65536];
static uint32_t screen_bytes, line_takes;
static const char *keys;

static uint32_t take(const char *bytes, uint32_t size, int calls)
{
    (void)calls;
    const uint32_t accepted = size < line_takes ? size : line_takes;
    memcpy(&screen[screen_bytes], bytes, accepted);
    screen_bytes += accepted;
    screen[screen_bytes] = '\0';
    return accepted;
}

static bool type(uint8_t *byte, int calls)
{
    (void)calls;
    if (*keys == '\0') {
        return false;
    }
    *byte = (uint8_t)*keys++;
    return true;
}

static const crash_record_t *crash;

static const crash_record_t *give_crash(int calls)
{
    (void)calls;
    return crash;
}

void setUp(void)
{
    static const analog_scale_t ANY = {.switch_25C_code = 0};
    analog_scale_IgnoreAndReturn(ANY);
    inverter_dead_time_least_ns_IgnoreAndReturn(0);
    boot = successful_boot();
    output = output_in_ready();
    torque_limits_state_t state;
    torque_limits_init(&state, &limits);
    const report_status_t running = {
        .output = &output, .limits = &limits, .node = &node, .journal = &journal, .control = true};
    status = running;
    console_init(&console, &boot);
    screen_bytes = 0;
    screen[0] = '\0';
    line_takes = 1000;
    keys = "";
    crash = NULL;
    crash_record_Stub(give_crash);
    serial_write_StubWithCallback(take);
    serial_read_StubWithCallback(type);
}

void tearDown(void) {}

static void pump(uint32_t now_ms)
{
    console_pump(&console, now_ms, &status);
}

static void type_and_wait(const char *typed)
{
    keys = typed;
    for (int i = 0; i < 10000 && (*keys != '\0' || !console_drained(&console)); i++) {
        pump(0);
    }
    TEST_ASSERT_TRUE(console_drained(&console));
}

static void assert_shows(const char *words)
{
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(screen, words), screen);
}

static int times_shown(const char *words)
{
    int times = 0;
    for (const char *at = strstr(screen, words); at != NULL; at = strstr(at + 1, words)) {
        times++;
    }
    return times;
}

void test_greeting_is_the_banner_and_the_result_of_the_self_tests(void)
{
    console_greet(&console);
    pump(0);
    TEST_ASSERT_EQUAL_PTR(screen, strstr(screen, "hubfoc "));
    assert_shows("self-test RAM: good\r\n");
    assert_shows("configuration accepted\r\n");
}

void test_every_command_that_help_lists_has_an_answer(void)
{
    type_and_wait("help\r");
    static const char *const NAMES[] = {
        "help", "reasons", "status", "watch",   "limits",  "faults", "blackbox",   "crash",
        "can",  "boot",    "config", "version", "install", "off",    "bootloader", "xcp"};
    for (size_t i = 0; i < sizeof NAMES / sizeof NAMES[0]; i++) {
        text_t line_begin;
        text_clear(&line_begin);
        text_add(&line_begin, "\n");
        text_add(&line_begin, NAMES[i]);
        text_add(&line_begin, " ");
        assert_shows(line_begin.chars);
    }
    type_and_wait("status\r");
    assert_shows("READY, torque not enabled in this mode; ");
    assert_shows("\r\nenergy since the start: drawn 0 Wh, returned 0 Wh\r\nenergy for life: ");
    type_and_wait("can\r");
    assert_shows("demand NO_DATA; ");
    type_and_wait("faults ROTOR_LOST\r");
    assert_shows("\r\n73 ROTOR_LOST: rotor position lost; ");
    type_and_wait("boot\r");
    assert_shows("self-test RAM: good\r\n");
    type_and_wait("version\r");
    assert_shows("version\r\nhubfoc ");
    type_and_wait("config motor.pole\r");
    assert_shows("\r\nmotor.pole_pairs ");
    TEST_ASSERT_EQUAL_INT(0, times_shown("unknown"));
}

void test_limits_are_printed_with_the_tightest_first(void)
{
    limits.driving[TORQUE_LINE_ROTOR] = limit_init(0, REASON_ROTOR_UNCERTAIN);
    limits.braking[TORQUE_LINE_ABS] = limit_init(0, REASON_ABS);
    type_and_wait("limits\r");
    assert_shows("\ndriving 0.000 N m, ROTOR: ");
    assert_shows("\nbraking 0.000 N m, ABS: ");
    TEST_ASSERT_EQUAL_INT(2, times_shown(" * "));
}

/* The line takes a few bytes a pass, and every pass brings the table of another slow step. */
void test_an_answer_to_limits_shows_the_table_of_one_slow_step(void)
{
    line_takes = 7;
    keys = "limits\r";
    for (int32_t pass = 0; pass < 1000; pass++) {
        for (torque_line_t at = 0; at < TORQUE_LINE_COUNT; at++) {
            limits.driving[at] = limit_init(1000 * pass, REASON_MAX_TORQUE);
            limits.braking[at] = limits.driving[at];
        }
        pump(0);
    }
    TEST_ASSERT_TRUE(console_drained(&console));
    text_t value;
    text_clear(&value);
    const char *first = strstr(screen, "driving ");
    TEST_ASSERT_NOT_NULL(first);
    first += strlen("driving ");
    for (size_t i = 0; first[i] != ' '; i++) {
        const char digit[2] = {first[i], '\0'};
        text_add(&value, digit);
    }
    text_add(&value, " ");
    /* The two winners, and both columns of the sixteen lines. */
    TEST_ASSERT_EQUAL_INT(2 + 2 * (int)TORQUE_LINE_COUNT, times_shown(value.chars));
}

/* An answer of more than a thousand bytes through a buffer of a thousand. */
void test_whole_configuration_is_printed_on_a_slow_line(void)
{
    line_takes = 7;
    type_and_wait("config\r");
    TEST_ASSERT_TRUE(screen_bytes > SHELL_PENDING_BYTES);
    TEST_ASSERT_EQUAL_INT(1, times_shown("\nmotor.type "));
    TEST_ASSERT_EQUAL_INT(1, times_shown("\nregen_map.temperature_origin_cC "));
}

void test_two_commands_in_one_input_are_answered_in_order(void)
{
    type_and_wait("version\rstatus\r");
    const char *version = strstr(screen, "\nhubfoc ");
    TEST_ASSERT_NOT_NULL_MESSAGE(version, screen);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(version, "\nREADY, "), screen);
}

void test_watch_prints_a_line_per_second_until_a_key_is_pressed(void)
{
    keys = "watch\r";
    for (uint32_t ms = 0; ms <= 3500; ms++) {
        pump(ms);
    }
    TEST_ASSERT_EQUAL_INT(3, times_shown("READY, "));
    keys = "x";
    for (uint32_t ms = 3501; ms <= 9000; ms++) {
        pump(ms);
    }
    TEST_ASSERT_EQUAL_INT(3, times_shown("READY, "));
}

void test_status_is_that_at_the_time_of_printing(void)
{
    keys = "watch\r";
    pump(0);
    output.mode = MODE_RUN;
    pump(1000);
    assert_shows("RUN, ");
    TEST_ASSERT_EQUAL_INT(0, times_shown("READY, "));
}

void test_no_byte_is_lost_on_a_line_that_takes_one_byte_at_a_time(void)
{
    line_takes = 1;
    console_greet(&console);
    type_and_wait("");
    assert_shows("configuration accepted\r\n");
}

void test_lines_are_discarded_whole_on_a_blocked_line(void)
{
    line_takes = 0;
    for (int i = 0; i < 50; i++) {
        console_status(&console, &status);
        pump(0);
    }
    line_takes = 1000;
    type_and_wait("");
    const int lines = times_shown("\r\n");
    TEST_ASSERT_TRUE(lines > 0 && lines < 50);
    TEST_ASSERT_EQUAL_INT(lines, times_shown("READY, "));
    TEST_ASSERT_EQUAL_CHAR('\n', screen[screen_bytes - 1]);
}

/* power_off() is called only where it is permitted: without an expectation a call fails. */
void test_the_supply_is_let_go_only_when_asked_and_permitted(void)
{
    type_and_wait("status\r");
    TEST_ASSERT_FALSE(console_wants_off(&console));
    type_and_wait("off\r");
    TEST_ASSERT_TRUE(console_wants_off(&console));
    TEST_ASSERT_FALSE(console_wants_off(&console));
    console_switch_off(&console, false);
    type_and_wait("");
    assert_shows("refused: only with the wheel known to be at rest");
    power_off_ExpectAndReturn(false);
    console_switch_off(&console, true);
    type_and_wait("");
    assert_shows("this board keeps its supply");
    power_off_ExpectAndReturn(true);
    console_switch_off(&console, true);
    type_and_wait("");
    assert_shows("the supply is let go");
}

/* power_request_bootloader() is called only where it is permitted, like power_off(). */
void test_the_bootloader_is_requested_only_when_asked_and_permitted(void)
{
    type_and_wait("status\r");
    TEST_ASSERT_FALSE(console_wants_bootloader(&console));
    type_and_wait("bootloader\r");
    TEST_ASSERT_TRUE(console_wants_bootloader(&console));
    TEST_ASSERT_FALSE(console_wants_bootloader(&console));
    TEST_ASSERT_FALSE(console_request_bootloader(&console, false));
    type_and_wait("");
    assert_shows("refused: only with the wheel known to be at rest");
    power_request_bootloader_ExpectAndReturn(false);
    TEST_ASSERT_FALSE(console_request_bootloader(&console, true));
    type_and_wait("");
    assert_shows("this chip has no bootloader");
    power_request_bootloader_ExpectAndReturn(true);
    TEST_ASSERT_TRUE(console_request_bootloader(&console, true));
    type_and_wait("");
    assert_shows("restarting in the chip's bootloader");
}

/* ---- XCP ---- */

/* CONNECT and DISCONNECT as frames; their zeros are bytes as any other. */
static const uint8_t TO_CONNECT[] = {2, 0, 0xFF, 0, 0x01}, TO_DISCONNECT[] = {1, 1, 0xFE, 0x00};
static const uint8_t *binary;
static uint32_t binary_bytes;

static bool type_binary(uint8_t *byte, int calls)
{
    (void)calls;
    if (binary_bytes == 0) {
        return false;
    }
    *byte = *binary++;
    binary_bytes--;
    return true;
}

static void begin_xcp(void)
{
    type_and_wait("xcp\r");
    pump(0);
    screen_bytes = 0;
    serial_read_StubWithCallback(type_binary);
}

static const uint8_t *packet_of(const uint8_t *frame, uint32_t count, uint32_t now_ms)
{
    uint32_t length;
    binary = frame;
    binary_bytes = count;
    pump(now_ms);
    return console_xcp_packet(&console.xcp, &length);
}

void test_a_wheel_without_control_keeps_its_shell(void)
{
    status.control = false;
    type_and_wait("xcp\r");
    assert_shows("not here");
    type_and_wait("version\r");
    assert_shows("hubfoc");
}

void test_an_answer_leaves_whole_on_a_slow_line_and_no_text_in_between(void)
{
    static const uint8_t ANSWER[] = {0xFF, 1, 2, 3};
    static const uint8_t EXPECTED[] = {4, 0, 0xFF, 1, 2, 3, 0x09};
    begin_xcp();
    const uint8_t *packet = packet_of(TO_CONNECT, sizeof TO_CONNECT, 1);
    TEST_ASSERT_NOT_NULL(packet);
    TEST_ASSERT_EQUAL_HEX8(0xFF, packet[0]);
    line_takes = 2;
    console_xcp_answer(&console.xcp, ANSWER, sizeof ANSWER);
    console_status(&console, &status); /* a line that is not an answer */
    for (uint32_t ms = 2; ms < 20; ms++) {
        pump(ms);
    }
    TEST_ASSERT_EQUAL_UINT32(sizeof EXPECTED, screen_bytes);
    TEST_ASSERT_EQUAL_HEX8_ARRAY(EXPECTED, screen, sizeof EXPECTED);
    TEST_ASSERT_NOT_NULL(packet_of(TO_DISCONNECT, sizeof TO_DISCONNECT, 20));
    console_xcp_answer(&console.xcp, ANSWER, 1);
    line_takes = 1000;
    pump(21);
    TEST_ASSERT_EQUAL_UINT32(sizeof EXPECTED + 4U, screen_bytes);
    pump(22);
    pump(23);
    TEST_ASSERT_NOT_NULL(strstr(&screen[sizeof EXPECTED + 4U], "READY"));
    TEST_ASSERT_FALSE(console_xcp_has_ended(&console.xcp));
}

/* A second command waits in the line until the first one's answer has left. */
void test_one_command_is_on_its_way_at_a_time(void)
{
    uint8_t both[2 * sizeof TO_CONNECT];
    uint32_t length;
    memcpy(both, TO_CONNECT, sizeof TO_CONNECT);
    memcpy(&both[sizeof TO_CONNECT], TO_CONNECT, sizeof TO_CONNECT);
    begin_xcp();
    TEST_ASSERT_NOT_NULL(packet_of(both, sizeof both, 1));
    TEST_ASSERT_EQUAL_UINT32(sizeof TO_CONNECT, binary_bytes);
    console_xcp_answer(&console.xcp, &TO_CONNECT[2], 2);
    line_takes = 0;
    pump(2);
    TEST_ASSERT_NULL(console_xcp_packet(&console.xcp, &length));
    line_takes = 1000;
    pump(3);
    TEST_ASSERT_NOT_NULL(console_xcp_packet(&console.xcp, &length));
}

void test_silence_gives_the_line_back_without_anybody_s_help(void)
{
    begin_xcp();
    pump(1999);
    TEST_ASSERT_FALSE(console_xcp_has_ended(&console.xcp));
    pump(2000);
    TEST_ASSERT_TRUE(console_xcp_has_ended(&console.xcp));
    TEST_ASSERT_FALSE(console_xcp_has_ended(&console.xcp));
    serial_read_StubWithCallback(type);
    type_and_wait("version\r");
    assert_shows("hubfoc");
}

static void assert_crash_shows(uint32_t cause, const char *words)
{
    crash_record_t record = {.value = {[CRASH_PC] = 0x08021234, [CRASH_COUNT] = 3}};
    record.value[CRASH_CAUSE] = cause;
    record.value[CRASH_ADDRESS] = 0x60000010;
    crash = &record;
    console_greet(&console);
    type_and_wait("");
    assert_shows(words);
    screen_bytes = 0;
    type_and_wait("crash\r");
    assert_shows(words);
    assert_shows("r0 .. r3 r12 lr pc psr sp cfsr hfsr address: 0x00000000 ");
    assert_shows(" 0x08021234 0x00000000 0x00000000 0x00000000 0x00000000 0x60000010\r\n");
}

void test_a_crash_is_shown_at_the_start_and_by_the_shell(void)
{
    assert_crash_shows(2, "crash 3 since the supply came: NMI at 0x08021234\r\n");
    assert_crash_shows(3, ": hard fault at 0x08021234\r\n");
    assert_crash_shows(4, ": memory fault at ");
    assert_crash_shows(5, ": bus fault at ");
    assert_crash_shows(6, ": usage fault at ");
    assert_crash_shows(17, ": exception 17 at ");
    assert_crash_shows(CRASH_CAUSE_STACK, ": stack overflow at ");
    assert_crash_shows(CRASH_CAUSE_CHECK, ": failed check at ");
}

void test_without_a_crash_the_start_shows_none(void)
{
    console_greet(&console);
    type_and_wait("");
    TEST_ASSERT_NULL(strstr(screen, "crash"));
    type_and_wait("crash\r");
    assert_shows("no crash since the supply came\r\n");
}

/* SPDX-License-Identifier: Apache-2.0 */
/* DAQ and scope by commands and packets as the standard's part 2 lays them out, byte for byte. */
#include "comms/xcp.h"

#include <stddef.h>
#include <string.h>

#include "unity.h"

#define COMMAND(...) command((const uint8_t[]){__VA_ARGS__}, sizeof((const uint8_t[]){__VA_ARGS__}))
#define ASSERT_ANSWER(...)                                                                         \
    assert_bytes((const uint8_t[]){__VA_ARGS__}, sizeof((const uint8_t[]){__VA_ARGS__}), answer,   \
                 answer_bytes, __LINE__)
#define ASSERT_PACKET(...)                                                                         \
    assert_packet((const uint8_t[]){__VA_ARGS__}, sizeof((const uint8_t[]){__VA_ARGS__}), __LINE__)
#define BYTES(address)                                                                             \
    (uint8_t)(address), (uint8_t)((address) >> 8), (uint8_t)((address) >> 16),                     \
        (uint8_t)((address) >> 24)
#define SIGNAL(place) BYTES(XCP_SIGNALS_ADDRESS + 4U * (place))
#define SCOPE(member) BYTES(XCP_SCOPE_ADDRESS + (uint32_t)offsetof(scope_page_t, member))

enum { SPEED = 0, FLAG = 1, CODE = 2, CURRENT = 3, SIGNALS = 4, MEMORY = 256 };

typedef struct {
    int32_t speed;
    uint8_t flag;
    uint16_t code;
} slow_t;

static const xcp_signal_t TABLE[SIGNALS] = {{offsetof(slow_t, speed), 4, XCP_RECORD_OUTPUT},
                                            {offsetof(slow_t, flag), 1, XCP_RECORD_OUTPUT},
                                            {offsetof(slow_t, code), 2, XCP_RECORD_INPUT},
                                            {0, 2, XCP_RECORD_FAST_INPUT}};
static const daq_line_t CAN = {.packet_bytes = 8, .packets_a_ms = 1};
static const daq_line_t PACKETS = {
    .packet_bytes = DAQ_PACKET_BYTES, .packets_a_ms = 16, .carries_fast_list = true};

static slow_t slow;
static uint16_t current;
static uint8_t memory[MEMORY];
static config_t config;
static findings_t findings;
static xcp_access_t access;
static xcp_t slave;
static daq_t daq;
static scope_t scope;
static uint8_t answer[XCP_PACKET_BYTES];
static uint32_t answer_bytes;

static void command(const uint8_t *bytes, size_t length)
{
    memset(answer, 0xEE, sizeof answer);
    answer_bytes = xcp_command(&slave, &access, 0, bytes, (uint32_t)length, answer);
}

static void assert_bytes(const uint8_t *expected, size_t length, const uint8_t *found,
                         uint32_t bytes, int line)
{
    UNITY_TEST_ASSERT_EQUAL_UINT32(length, bytes, line, "length");
    UNITY_TEST_ASSERT_EQUAL_HEX8_ARRAY(expected, found, length, line, "bytes");
}

static void assert_packet(const uint8_t *expected, size_t length, int line)
{
    uint8_t packet[DAQ_PACKET_BYTES];
    const uint32_t bytes = daq_next(&daq, &scope, packet);
    assert_bytes(expected, length, packet, bytes, line);
    daq_taken(&daq, &scope);
}

static void assert_no_packet(void)
{
    uint8_t packet[DAQ_PACKET_BYTES];
    TEST_ASSERT_EQUAL_UINT32(0, daq_next(&daq, &scope, packet));
}

static void slow_step(void)
{
    access.slow_steps++;
    if (daq_runs_slow(&daq)) {
        daq_slow_step(&daq, &access.table, access.slow_steps);
    }
    if (scope_runs(&scope)) {
        scope_slow_step(&scope, &access.table, &findings);
    }
}

static void fast_step(void)
{
    current++;
    if (scope_runs(&scope)) {
        scope_fast_step(&scope);
    }
}

static void positive(void)
{
    TEST_ASSERT_EQUAL_HEX8(0xFF, answer[0]);
}

static void begin(const daq_line_t *line)
{
    const xcp_access_t all = {.table = {.signals = TABLE,
                                        .signals_count = SIGNALS,
                                        .record = {&slow, &slow, NULL, &current}},
                              .line = line,
                              .daq = &daq,
                              .scope = &scope,
                              .in_force = &config,
                              .identification = "x"};
    access = all;
    const slow_t values = {.speed = 0x01020304, .flag = 0x55, .code = 0xABCD};
    slow = values;
    current = 0;
    memset(&config, 0, sizeof config);
    config.drive.pwm_frequency_Hz = 20000;
    xcp_init(&slave);
    daq_init(&daq);
    scope_init(&scope, memory, MEMORY, 20000);
    COMMAND(0xFF, 0);
    positive();
}

void setUp(void)
{
    begin(&CAN);
}

void tearDown(void) {}

/* Entry 0 of an ODT and the next ones, of the sizes of the signals. */
static void point(uint8_t list, uint8_t odt)
{
    COMMAND(0xE2, 0, list, 0, odt, 0);
    ASSERT_ANSWER(0xFF);
}

static void entry(uint32_t place, uint8_t bytes)
{
    COMMAND(0xE1, 0xFF, bytes, 0, SIGNAL(place));
    ASSERT_ANSWER(0xFF);
}

static void prescale(uint8_t list, uint8_t prescaler)
{
    COMMAND(0xE0, 0x10, list, 0, list, 0, prescaler, 0);
    ASSERT_ANSWER(0xFF);
}

static void start(uint8_t list, uint8_t first_odt)
{
    COMMAND(0xDE, 1, list, 0);
    ASSERT_ANSWER(0xFF, first_odt);
}

void test_two_static_lists_and_their_events_are_described(void)
{
    static const char NAMES[2][12] = {"slow step", "PWM period"};
    COMMAND(0xDA); /* prescaler, time, overload in the number; two lists, two events */
    ASSERT_ANSWER(0xFF, 0x52, 2, 0, 2, 0, 0, 0);
    COMMAND(0xD9); /* bytes; entries of 4 at most; time always, in two bytes, of 10 us */
    ASSERT_ANSWER(0xFF, 1, 4, 1, 0, 0x4A, 1, 0);
    COMMAND(0xD8, 0, 0, 0);
    ASSERT_ANSWER(0xFF, 0x06, 8, 8, 0, 0);
    COMMAND(0xD8, 0, 1, 0);
    ASSERT_ANSWER(0xFF, 0x06, 1, 8, 1, 0);
    COMMAND(0xD8, 0, 2, 0);
    ASSERT_ANSWER(0xFE, 0x22);
    COMMAND(0xD7, 0, 1, 0); /* 50 us */
    ASSERT_ANSWER(0xFF, 0x04, 1, 10, 50, 3, 0);
    COMMAND(0xF5, 7);
    TEST_ASSERT_EQUAL_MEMORY(NAMES[1], &answer[1], 7);
    COMMAND(0xD7, 0, 0, 0); /* 1 ms */
    ASSERT_ANSWER(0xFF, 0x04, 1, 9, 1, 6, 0);
    COMMAND(0xF5, 7);
    TEST_ASSERT_EQUAL_MEMORY(NAMES[0], &answer[1], 7);
    COMMAND(0xD7, 0, 0, 1);
    ASSERT_ANSWER(0xFE, 0x22);
}

void test_a_slow_list_sends_number_time_and_signals_of_each_step(void)
{
    point(0, 0);
    entry(SPEED, 4);
    entry(FLAG, 1);
    COMMAND(0xE1, 0xFF, 1, 0, SIGNAL(FLAG)); /* 3 + 5 bytes are a frame */
    ASSERT_ANSWER(0xFE, 0x2A);
    prescale(0, 1);
    start(0, 0);
    COMMAND(0xFD);
    ASSERT_ANSWER(0xFF, 0x40, 0, 0, 0, 0);
    COMMAND(0xDF, 0, 0, 0);
    ASSERT_ANSWER(0xFF, 0x50, 0, 0, 0, 0, 1, 0);
    access.slow_steps = 655; /* 655 + 1 steps of 100 ticks are 64 more than two bytes hold */
    for (uint32_t step = 0; step < 100; step++) {
        assert_no_packet();
        slow_step();
        const uint32_t ticks = (64U + 100U * step) % 65536U;
        ASSERT_PACKET(0, (uint8_t)ticks, (uint8_t)(ticks >> 8), 4, 3, 2, 1, 0x55);
    }
    COMMAND(0xDC);
    ASSERT_ANSWER(0xFF, 0, 0, 0, BYTES(64U + 9900U));
    COMMAND(0xDE, 0, 0, 0);
    slow_step();
    assert_no_packet();
}

/* Three ODTs, all of one step, one released a millisecond. */
void test_on_can_a_millisecond_has_one_packet(void)
{
    point(0, 0);
    entry(SPEED, 4);
    point(0, 1);
    entry(CODE, 2);
    point(0, 7);
    entry(CURRENT, 4);
    prescale(0, 2);
    COMMAND(0xDE, 1, 0, 0);
    ASSERT_ANSWER(0xFE, 0x2A); /* 1.5 packets a millisecond */
    prescale(0, 3);
    start(0, 0);
    for (uint32_t sample = 0; sample < 20; sample++) {
        const uint32_t ticks = 100U + 300U * sample;
        slow.speed = (int32_t)(0x100U + sample);
        slow.code = 0x1234;
        slow_step();
        slow.code = 0;
        ASSERT_PACKET(0, (uint8_t)ticks, (uint8_t)(ticks >> 8), (uint8_t)sample, 1, 0, 0);
        assert_no_packet();
        slow_step();
        ASSERT_PACKET(1, 0x34, 0x12);
        assert_no_packet();
        slow_step();
        ASSERT_PACKET(7, 0, 0, 0, 0);
        assert_no_packet();
    }
}

/* Fifteen packets wait, the rest of 20 is lost, and the next one that is sent says so. */
void test_a_packet_after_lost_ones_says_so(void)
{
    point(0, 0);
    entry(FLAG, 1);
    start(0, 0);
    for (int i = 0; i < 20; i++) {
        slow_step();
    }
    for (uint32_t i = 1; i <= 15; i++) {
        ASSERT_PACKET(0, (uint8_t)(100U * i), (uint8_t)(100U * i >> 8), 0x55);
    }
    assert_no_packet();
    slow_step();
    ASSERT_PACKET(0x80, (uint8_t)2100, 2100 >> 8, 0x55);
    slow_step();
    ASSERT_PACKET(0, (uint8_t)2200, 2200 >> 8, 0x55);
}

void test_the_pwm_period_is_for_packets_alone(void)
{
    point(1, 0);
    entry(CURRENT, 2);
    entry(FLAG, 1);
    prescale(1, 255);
    COMMAND(0xDE, 1, 1, 0);
    ASSERT_ANSWER(0xFE, 0x2A);
    begin(&PACKETS);
    TEST_ASSERT_EQUAL_UINT8(DAQ_PACKET_BYTES, answer[4]); /* MAX_DTO */
    point(1, 0);
    entry(CURRENT, 2);
    entry(FLAG, 1);
    prescale(1, 2);
    access.slow_steps = 3;
    start(1, 8);
    COMMAND(0xE2, 0, 1, 0, 0, 0);
    ASSERT_ANSWER(0xFE, 0x11);
    COMMAND(0xE0, 0x10, 1, 0, 1, 0, 1, 0);
    ASSERT_ANSWER(0xFE, 0x11);
    for (uint32_t k = 0; k < 50; k++) {
        fast_step();
        const uint32_t ticks = 305U + 10U * k;
        ASSERT_PACKET(8, (uint8_t)ticks, (uint8_t)(ticks >> 8), (uint8_t)(1U + 2U * k), 0, 0x55);
        fast_step();
        assert_no_packet();
    }
    slow.flag = 7;
    slow_step();
    fast_step();
    ASSERT_PACKET(8, (uint8_t)805, 805 >> 8, 101, 0, 7);
    COMMAND(0xF6, 0, 0, 0, SCOPE(run));
    COMMAND(0xF0, 4, 1, 0, 0, 0);
    ASSERT_ANSWER(0xFE, 0x33); /* its memory is taken */
    COMMAND(0xE3, 0, 1, 0);
    ASSERT_ANSWER(0xFF);
    fast_step();
    assert_no_packet();
    TEST_ASSERT_FALSE(scope_runs(&scope));
}

void test_signals_of_the_table_alone_are_entries(void)
{
    COMMAND(0xE1, 0xFF, 4, 0, SIGNAL(SPEED)); /* without a pointer */
    ASSERT_ANSWER(0xFE, 0x29);
    point(0, 0);
    COMMAND(0xE1, 0xFF, 4, 0, SIGNAL(SIGNALS));
    ASSERT_ANSWER(0xFE, 0x24);
    COMMAND(0xE1, 0xFF, 1, 0, BYTES(XCP_SIGNALS_ADDRESS + 1U));
    ASSERT_ANSWER(0xFE, 0x24);
    COMMAND(0xE1, 0xFF, 4, 0, BYTES(XCP_SIGNALS_ADDRESS - 4U));
    ASSERT_ANSWER(0xFE, 0x24);
    COMMAND(0xE1, 0xFF, 4, 0, BYTES(XCP_PAGE_ADDRESS));
    ASSERT_ANSWER(0xFE, 0x24);
    COMMAND(0xE1, 0xFF, 4, 0, BYTES(0x20000000));
    ASSERT_ANSWER(0xFE, 0x24);
    COMMAND(0xE1, 0xFF, 3, 0, SIGNAL(SPEED));
    ASSERT_ANSWER(0xFE, 0x22);
    COMMAND(0xE1, 0xFF, 0, 0, SIGNAL(SPEED));
    ASSERT_ANSWER(0xFE, 0x22);
    COMMAND(0xE1, 0, 4, 0, SIGNAL(SPEED)); /* a bit */
    ASSERT_ANSWER(0xFE, 0x22);
    COMMAND(0xE1, 0xFF, 4, 1, SIGNAL(SPEED)); /* address extension */
    ASSERT_ANSWER(0xFE, 0x22);
    COMMAND(0xDE, 1, 0, 0); /* an empty list */
    ASSERT_ANSWER(0xFE, 0x2A);
}

void test_what_is_not_there_is_refused(void)
{
    COMMAND(0xE2, 0, 2, 0, 0, 0);
    ASSERT_ANSWER(0xFE, 0x22);
    COMMAND(0xE2, 0, 0, 1, 0, 0);
    ASSERT_ANSWER(0xFE, 0x22);
    COMMAND(0xE2, 0, 0, 0, 8, 0);
    ASSERT_ANSWER(0xFE, 0x22);
    COMMAND(0xE2, 0, 1, 0, 1, 0);
    ASSERT_ANSWER(0xFE, 0x22);
    COMMAND(0xE2, 0, 0, 0, 0, 8);
    ASSERT_ANSWER(0xFE, 0x22);
    COMMAND(0xE3, 0, 2, 0);
    ASSERT_ANSWER(0xFE, 0x22);
    COMMAND(0xE0, 0x10, 0, 0, 1, 0, 1, 0); /* another list's event */
    ASSERT_ANSWER(0xFE, 0x22);
    COMMAND(0xE0, 0x10, 0, 0, 0, 0, 0, 0); /* no prescaler */
    ASSERT_ANSWER(0xFE, 0x22);
    COMMAND(0xE0, 0x12, 0, 0, 0, 0, 1, 0); /* stimulation */
    ASSERT_ANSWER(0xFE, 0x27);
    COMMAND(0xE0, 0x00, 0, 0, 0, 0, 1, 0); /* without time */
    ASSERT_ANSWER(0xFE, 0x21);
    COMMAND(0xDE, 3, 0, 0);
    ASSERT_ANSWER(0xFE, 0x27);
    COMMAND(0xDE, 1, 2, 0);
    ASSERT_ANSWER(0xFE, 0x22);
    COMMAND(0xDF, 0, 2, 0);
    ASSERT_ANSWER(0xFE, 0x22);
    COMMAND(0xDD, 3);
    ASSERT_ANSWER(0xFE, 0x27);
}

void test_selected_lists_start_and_stop_together(void)
{
    begin(&PACKETS);
    point(0, 0);
    entry(FLAG, 1);
    point(1, 0);
    entry(CURRENT, 2);
    for (uint8_t list = 0; list < 2; list++) {
        COMMAND(0xDE, 2, list, 0);
        ASSERT_ANSWER(0xFF, list == 0 ? 0 : 8);
        COMMAND(0xDF, 0, list, 0);
        ASSERT_ANSWER(0xFF, 0x11, 0, 0, list, 0, 1, 0);
    }
    COMMAND(0xDD, 1);
    ASSERT_ANSWER(0xFF);
    TEST_ASSERT_TRUE(daq.running[0] && daq.running[1]);
    COMMAND(0xDD, 2); /* none is selected any more */
    TEST_ASSERT_TRUE(daq.running[0] && daq.running[1]);
    COMMAND(0xDE, 2, 1, 0);
    COMMAND(0xDD, 2);
    TEST_ASSERT_TRUE(daq.running[0] && !daq.running[1]);
    COMMAND(0xDD, 0);
    TEST_ASSERT_FALSE(daq.running[0]);
}

void test_the_end_of_a_session_stops_and_empties_the_lists(void)
{
    point(0, 0);
    entry(FLAG, 1);
    start(0, 0);
    COMMAND(0xFE);
    TEST_ASSERT_FALSE(daq.running[0]);
    COMMAND(0xFF, 0);
    COMMAND(0xDE, 1, 0, 0);
    ASSERT_ANSWER(0xFE, 0x2A);
    COMMAND(0xE1, 0xFF, 1, 0, SIGNAL(FLAG));
    ASSERT_ANSWER(0xFE, 0x29);
}

/* A word of the settings at a time; the record in parts of seven bytes. */
void test_a_scope_is_set_run_and_uploaded_by_addresses(void)
{
    COMMAND(0xF4, 4, 0, 0, SCOPE(memory_bytes));
    ASSERT_ANSWER(0xFF, BYTES(MEMORY));
    COMMAND(0xF6, 0, 0, 0, SCOPE(signal[0]));
    COMMAND(0xF0, 4, CURRENT, 0, 0, 0);
    ASSERT_ANSWER(0xFF);
    COMMAND(0xF0, 4, 4, 0, 0, 0); /* signal[1]: there is none of that place */
    ASSERT_ANSWER(0xFE, 0x22);
    COMMAND(0xF0, 2, 4, 0);
    ASSERT_ANSWER(0xFE, 0x22);
    COMMAND(0xF6, 0, 0, 0, BYTES(XCP_SCOPE_ADDRESS + 2U));
    COMMAND(0xF0, 4, 1, 0, 0, 0);
    ASSERT_ANSWER(0xFE, 0x22);
    COMMAND(0xF6, 0, 0, 0, SCOPE(rows));
    COMMAND(0xF0, 4, 5, 0, 0, 0);
    COMMAND(0xF4, 1, 0, 0, BYTES(XCP_RECORD_ADDRESS));
    ASSERT_ANSWER(0xFE, 0x24);
    COMMAND(0xF6, 0, 0, 0, SCOPE(run));
    COMMAND(0xF0, 4, 1, 0, 0, 0);
    ASSERT_ANSWER(0xFF);
    for (int i = 0; i < 5; i++) {
        COMMAND(0xF4, 4, 0, 0, SCOPE(phase));
        ASSERT_ANSWER(0xFF, 1 + (i > 0), 0, 0, 0);
        fast_step();
    }
    COMMAND(0xF4, 4, 0, 0, SCOPE(phase));
    ASSERT_ANSWER(0xFF, 3, 0, 0, 0);
    COMMAND(0xF6, 0, 0, 0, BYTES(XCP_RECORD_ADDRESS));
    COMMAND(0xF5, 7);
    ASSERT_ANSWER(0xFF, 1, 0, 2, 0, 3, 0, 4);
    COMMAND(0xF5, 4);
    ASSERT_ANSWER(0xFE, 0x24); /* ten bytes in all */
    COMMAND(0xF5, 3);
    ASSERT_ANSWER(0xFF, 0, 5, 0);
    COMMAND(0xF4, 1, 0, 0, BYTES(XCP_SCOPE_ADDRESS + (uint32_t)sizeof(scope_page_t)));
    ASSERT_ANSWER(0xFE, 0x24);
}

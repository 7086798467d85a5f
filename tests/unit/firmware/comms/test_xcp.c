/* SPDX-License-Identifier: Apache-2.0 */
/* Commands and answers as the standard's part 2 lays them out, byte for byte; pyxcp reads the same
 * slave in tests/unit/host_sim/python/hubfoc/test_xcp.py. */
#include <stddef.h>
#include <string.h>

#include "comms/mac.h"
#include "comms/xcp.h"
#include "config/validate.h"
#include "unity.h"

#define COMMAND(...) command((const uint8_t[]){__VA_ARGS__}, sizeof((const uint8_t[]){__VA_ARGS__}))
#define ASSERT_ANSWER(...)                                                                         \
    assert_answer((const uint8_t[]){__VA_ARGS__}, sizeof((const uint8_t[]){__VA_ARGS__}), __LINE__)
/* An address as four bytes of a command. */
#define BYTES(address)                                                                             \
    (uint8_t)(address), (uint8_t)((address) >> 8), (uint8_t)((address) >> 16),                     \
        (uint8_t)((address) >> 24)
#define PAGE(member) BYTES(XCP_PAGE_ADDRESS + (uint32_t)offsetof(config_t, member))

typedef struct {
    uint8_t hidden[4];
    int32_t speed;
    uint8_t flag;
    uint8_t more_hidden;
    uint16_t code;
} record_t;

static const xcp_signal_t SIGNALS[] = {{offsetof(record_t, speed), 4, 0},
                                       {offsetof(record_t, flag), 1, 1},
                                       {offsetof(record_t, code), 2, 0}};
static const uint64_t SEED = UINT64_C(0x665544332211);

static record_t record;
static config_t in_force, staging;
static const daq_line_t CAN = {.packet_bytes = 8, .packets_a_ms = 1};
static xcp_access_t access;
static daq_t daq;
static scope_t scope;
static xcp_t slave;
static uint32_t now_ms;
static uint8_t answer[XCP_PACKET_BYTES];
static uint32_t answer_bytes;

static void command(const uint8_t *bytes, size_t length)
{
    memset(answer, 0xEE, sizeof answer);
    answer_bytes = xcp_command(&slave, &access, now_ms, bytes, (uint32_t)length, answer);
}

static void assert_answer(const uint8_t *expected, size_t length, int line)
{
    UNITY_TEST_ASSERT_EQUAL_UINT32(length, answer_bytes, line, "length");
    UNITY_TEST_ASSERT_EQUAL_HEX8_ARRAY(expected, answer, length, line, "answer");
}

static void pass(void)
{
    xcp_tick(&slave, &access, now_ms);
    if (xcp_wants_seed(&slave)) {
        xcp_give_seed(&slave, SEED | UINT64_C(0xABCD) << 48);
    }
}

static void connect(void)
{
    COMMAND(0xFF, 0);
    TEST_ASSERT_EQUAL_HEX8(0xFF, answer[0]);
    pass();
}

static void send_key(uint64_t key)
{
    COMMAND(0xF8, 0, 1);
    ASSERT_ANSWER(0xFF, 6, 0x11, 0x22, 0x33, 0x44, 0x55, 0x66);
    COMMAND(0xF7, 6, BYTES(key), (uint8_t)(key >> 32), (uint8_t)(key >> 40));
}

static void unlock(void)
{
    send_key(mac_of(in_force.service_key, SEED));
    ASSERT_ANSWER(0xFF, 0);
}

void setUp(void)
{
    const record_t values = {.hidden = {1, 2, 3, 4}, .speed = -2, .flag = 1, .code = 0xABCD};
    record = values;
    memset(&in_force, 0x5A, sizeof in_force);
    in_force.motor.pole_pairs = 0x01020304;
    for (uint32_t i = 0; i < MAC_KEY_WORDS; i++) {
        in_force.service_key[i] = 0xA5A50000U + i;
    }
    memset(&staging, 0, sizeof staging);
    const xcp_access_t all = {.table = {.signals = SIGNALS,
                                        .signals_count = sizeof SIGNALS / sizeof SIGNALS[0],
                                        .record = {&record, &record}},
                              .line = &CAN,
                              .daq = &daq,
                              .scope = &scope,
                              .in_force = &in_force,
                              .staging = &staging,
                              .identification = "hubfoc-1.2.3"};
    access = all;
    now_ms = UINT32_MAX - 500U;
    xcp_init(&slave);
    daq_init(&daq);
    scope_init(&scope, NULL, 0, 20000);
}

void tearDown(void) {}

/* Resources: DAQ, and calibration with a key; little endian, bytes, no blocks; packets of 8 bytes.
 */
void test_connect_names_what_the_slave_can(void)
{
    COMMAND(0xFF, 0);
    ASSERT_ANSWER(0xFF, 0x05, 0x80, 8, 8, 0, 1, 1);
    memset(in_force.service_key, 0, sizeof in_force.service_key);
    COMMAND(0xFF, 0);
    ASSERT_ANSWER(0xFF, 0x04, 0x80, 8, 8, 0, 1, 1);
}

void test_without_a_session_only_connect_is_answered(void)
{
    COMMAND(0xFD);
    TEST_ASSERT_EQUAL_UINT32(0, answer_bytes);
    connect();
    COMMAND(0xFD);
    ASSERT_ANSWER(0xFF, 0, 1, 0, 0, 0);
    COMMAND(0xFE);
    ASSERT_ANSWER(0xFF);
    COMMAND(0xFD);
    TEST_ASSERT_EQUAL_UINT32(0, answer_bytes);
}

void test_empty_and_overlong_packets_are_not_answered(void)
{
    static const uint8_t LONG[9] = {0xFF};
    command(LONG, 0);
    TEST_ASSERT_EQUAL_UINT32(0, answer_bytes);
    command(LONG, sizeof LONG);
    TEST_ASSERT_EQUAL_UINT32(0, answer_bytes);
}

void test_synch_is_answered_by_its_error(void)
{
    connect();
    COMMAND(0xFC);
    ASSERT_ANSWER(0xFE, 0x00);
}

/* Not there: SHORT_DOWNLOAD (0xED), for whose data a packet has no space; READ_DAQ and dynamic
 * lists; programming. */
void test_unknown_and_short_commands_are_refused(void)
{
    static const uint8_t KNOWN[] = {0xFF, 0xFE, 0xFD, 0xFC, 0xFB, 0xFA, 0xF9, 0xF8, 0xF7, 0xF6,
                                    0xF5, 0xF4, 0xF3, 0xF0, 0xEB, 0xEA, 0xE9, 0xE4, 0xE3, 0xE2,
                                    0xE1, 0xE0, 0xDF, 0xDE, 0xDD, 0xDC, 0xDA, 0xD9, 0xD8, 0xD7};
    for (uint32_t code = 0; code < 0x100U; code++) {
        connect();
        COMMAND((uint8_t)code);
        if (memchr(KNOWN, (int)code, sizeof KNOWN) == NULL) {
            ASSERT_ANSWER(0xFE, 0x20);
        } else {
            TEST_ASSERT_FALSE(answer[0] == 0xFE && answer[1] == 0x20);
        }
    }
    connect();
    COMMAND(0xF4, 4, 0, 0, 0, 0, 0);
    ASSERT_ANSWER(0xFE, 0x21);
    COMMAND(0xF0, 4, 1, 2, 3);
    ASSERT_ANSWER(0xFE, 0x21);
}

void test_mode_information_and_pages_are_described(void)
{
    connect();
    COMMAND(0xFB);
    ASSERT_ANSWER(0xFF, 0, 0, 0, 0, 0, 0, 0x10);
    COMMAND(0xE9);
    ASSERT_ANSWER(0xFF, 1, 0);
}

void test_a_signal_is_a_word_whatever_its_size_is(void)
{
    connect();
    COMMAND(0xF4, 4, 0, 0, BYTES(XCP_SIGNALS_ADDRESS));
    ASSERT_ANSWER(0xFF, 0xFE, 0xFF, 0xFF, 0xFF);
    COMMAND(0xF4, 4, 0, 0, BYTES(XCP_SIGNALS_ADDRESS + 4U));
    ASSERT_ANSWER(0xFF, 1, 0, 0, 0);
    COMMAND(0xF4, 4, 0, 0, BYTES(XCP_SIGNALS_ADDRESS + 8U));
    ASSERT_ANSWER(0xFF, 0xCD, 0xAB, 0, 0);
    COMMAND(0xF5, 1);
    ASSERT_ANSWER(0xFE, 0x24); /* behind the table */
}

/* The last byte of each region can be read, the next one cannot, nor what is around them. */
void test_nothing_beside_signals_and_page_can_be_read(void)
{
    const uint32_t signals_end = XCP_SIGNALS_ADDRESS + 12U;
    const uint32_t page_end = XCP_PAGE_ADDRESS + (uint32_t)offsetof(config_t, crc32);
    const uint32_t last[] = {signals_end - 1U, page_end - 1U};
    const uint32_t beside[] = {0,           XCP_SIGNALS_ADDRESS - 1U,
                               signals_end, XCP_PAGE_ADDRESS - 1U,
                               page_end,    page_end + 4U,
                               0x20000000,  UINT32_MAX};
    connect();
    for (uint32_t i = 0; i < sizeof last / sizeof last[0]; i++) {
        COMMAND(0xF4, 1, 0, 0, BYTES(last[i]));
        TEST_ASSERT_EQUAL_UINT32(2, answer_bytes);
        COMMAND(0xF4, 2, 0, 0, BYTES(last[i]));
        ASSERT_ANSWER(0xFE, 0x24);
    }
    for (uint32_t i = 0; i < sizeof beside / sizeof beside[0]; i++) {
        COMMAND(0xF4, 1, 0, 0, BYTES(beside[i]));
        ASSERT_ANSWER(0xFE, 0x24);
        COMMAND(0xF6, 0, 0, 0, BYTES(beside[i]));
        COMMAND(0xF5, 7);
        ASSERT_ANSWER(0xFE, 0x24);
    }
    COMMAND(0xF4, 0, 0, 0, BYTES(XCP_PAGE_ADDRESS));
    ASSERT_ANSWER(0xFE, 0x22);
    COMMAND(0xF4, 8, 0, 0, BYTES(XCP_PAGE_ADDRESS));
    ASSERT_ANSWER(0xFE, 0x22);
    COMMAND(0xF4, 1, 0, 1, BYTES(XCP_PAGE_ADDRESS)); /* address extension */
    ASSERT_ANSWER(0xFE, 0x22);
    COMMAND(0xF6, 0, 0, 1, BYTES(XCP_PAGE_ADDRESS));
    ASSERT_ANSWER(0xFE, 0x22);
}

void test_upload_goes_on_where_the_last_one_ended(void)
{
    connect();
    COMMAND(0xF6, 0, 0, 0, PAGE(motor.pole_pairs));
    ASSERT_ANSWER(0xFF);
    COMMAND(0xF5, 3);
    ASSERT_ANSWER(0xFF, 4, 3, 2);
    COMMAND(0xF5, 2);
    ASSERT_ANSWER(0xFF, 1, 0x5A);
    COMMAND(0xF4, 1, 0, 0, PAGE(motor.pole_pairs));
    COMMAND(0xF5, 1);
    ASSERT_ANSWER(0xFF, 3);
}

/* Twelve bytes of text; what is not known has no length. */
void test_identification_is_uploaded_as_text(void)
{
    connect();
    for (uint8_t kind = 0; kind < 2; kind++) {
        COMMAND(0xFA, kind);
        ASSERT_ANSWER(0xFF, 0, 0, 0, 12, 0, 0, 0);
        COMMAND(0xF5, 7);
        ASSERT_ANSWER(0xFF, 'h', 'u', 'b', 'f', 'o', 'c', '-');
        COMMAND(0xF5, 6);
        ASSERT_ANSWER(0xFE, 0x24);
        COMMAND(0xF5, 5);
        ASSERT_ANSWER(0xFF, '1', '.', '2', '.', '3');
    }
    COMMAND(0xFA, 4);
    ASSERT_ANSWER(0xFF, 0, 0, 0, 0, 0, 0, 0);
    COMMAND(0xFA, 0);
    COMMAND(0xF3, 0, 0, 0, 4, 0, 0, 0);
    ASSERT_ANSWER(0xFE, 0x24);
    COMMAND(0xF0, 1, 1);
    ASSERT_ANSWER(0xFE, 0x24);
}

/* CRC-32 of IEEE 802.3 of four bytes 5A: 0x2F359688 by zlib. */
void test_checksum_is_the_crc_of_config_t(void)
{
    connect();
    COMMAND(0xF6, 0, 0, 0, PAGE(motor.phase_resistance_uOhm));
    COMMAND(0xF3, 0, 0, 0, 4, 0, 0, 0);
    ASSERT_ANSWER(0xFF, 9, 0, 0, 0x88, 0x96, 0x35, 0x2F);
    TEST_ASSERT_EQUAL_HEX32(XCP_PAGE_ADDRESS + offsetof(config_t, motor.phase_resistance_uOhm) + 4U,
                            slave.mta);
    const uint32_t whole = (uint32_t)offsetof(config_t, crc32);
    const uint32_t crc = config_crc32(&in_force, whole);
    COMMAND(0xF6, 0, 0, 0, BYTES(XCP_PAGE_ADDRESS));
    COMMAND(0xF3, 0, 0, 0, BYTES(whole));
    ASSERT_ANSWER(0xFF, 9, 0, 0, BYTES(crc));
    COMMAND(0xF6, 0, 0, 0, BYTES(XCP_PAGE_ADDRESS));
    COMMAND(0xF3, 0, 0, 0, BYTES(whole + 1U));
    ASSERT_ANSWER(0xFE, 0x24);
    COMMAND(0xF6, 0, 0, 0, BYTES(XCP_SIGNALS_ADDRESS));
    COMMAND(0xF3, 0, 0, 0, 4, 0, 0, 0);
    ASSERT_ANSWER(0xFE, 0x24);
}

void test_locked_nothing_can_be_changed(void)
{
    connect();
    COMMAND(0xF6, 0, 0, 0, PAGE(motor.pole_pairs));
    COMMAND(0xF0, 1, 9);
    ASSERT_ANSWER(0xFE, 0x25);
    COMMAND(0xEB, 2, 0, 1);
    ASSERT_ANSWER(0xFE, 0x25);
    COMMAND(0xE4, 0, 0, 0, 1);
    ASSERT_ANSWER(0xFE, 0x25);
    COMMAND(0xF9, 1, 0, 0);
    ASSERT_ANSWER(0xFE, 0x25);
    TEST_ASSERT_FALSE(slave.store_wanted);
    TEST_ASSERT_EQUAL_HEX32(0x01020304, in_force.motor.pole_pairs);
}

void test_without_a_key_nothing_can_be_unlocked(void)
{
    memset(in_force.service_key, 0, sizeof in_force.service_key);
    connect();
    COMMAND(0xF8, 0, 1);
    ASSERT_ANSWER(0xFE, 0x22);
    COMMAND(0xFD);
    ASSERT_ANSWER(0xFF, 0, 0, 0, 0, 0);
    COMMAND(0xF6, 0, 0, 0, PAGE(motor.pole_pairs));
    COMMAND(0xF0, 1, 9);
    ASSERT_ANSWER(0xFE, 0x23);
    COMMAND(0xEB, 2, 0, 1);
    ASSERT_ANSWER(0xFE, 0x25);
}

void test_the_right_key_unlocks_and_fills_the_staging_page(void)
{
    connect();
    unlock();
    TEST_ASSERT_EQUAL_MEMORY(&in_force, &staging, sizeof staging);
    COMMAND(0xFD);
    ASSERT_ANSWER(0xFF, 0, 0, 0, 0, 0);
    COMMAND(0xF8, 0, 1); /* not locked any more */
    ASSERT_ANSWER(0xFF, 0);
    TEST_ASSERT_EQUAL_UINT32(1, slave.unlocks);
    connect(); /* a session of its own */
    COMMAND(0xFD);
    ASSERT_ANSWER(0xFF, 0, 1, 0, 0, 0);
}

void test_a_seed_serves_for_one_key_only(void)
{
    connect();
    send_key(mac_of(in_force.service_key, SEED) ^ UINT64_C(1) << 47);
    ASSERT_ANSWER(0xFE, 0x25);
    COMMAND(0xFF, 0);
    COMMAND(0xF8, 0, 1); /* no new one has been drawn */
    ASSERT_ANSWER(0xFE, 0x33);
    COMMAND(0xF7, 6, 1, 2, 3, 4, 5, 6);
    ASSERT_ANSWER(0xFE, 0x29);
}

void test_keys_and_seeds_of_another_length_are_refused(void)
{
    connect();
    COMMAND(0xF7, 6, 1, 2, 3, 4, 5, 6); /* before a seed */
    ASSERT_ANSWER(0xFE, 0x29);
    COMMAND(0xF8, 0, 1);
    COMMAND(0xF7, 8, 1, 2, 3, 4, 5, 6);
    ASSERT_ANSWER(0xFE, 0x29);
    COMMAND(0xF7, 6, 1, 2, 3, 4, 5);
    ASSERT_ANSWER(0xFE, 0x21);
    COMMAND(0xF8, 1, 1); /* the rest of a seed */
    ASSERT_ANSWER(0xFE, 0x29);
    COMMAND(0xF8, 0, 4); /* DAQ */
    ASSERT_ANSWER(0xFE, 0x22);
}

void test_three_wrong_keys_cost_ten_seconds(void)
{
    for (int i = 0; i < XCP_WRONG_KEYS; i++) {
        connect();
        send_key(0);
        ASSERT_ANSWER(0xFE, 0x25);
        COMMAND(0xFD); /* the session has ended */
        TEST_ASSERT_EQUAL_UINT32(0, answer_bytes);
    }
    now_ms += 9999U;
    connect();
    COMMAND(0xF8, 0, 1);
    ASSERT_ANSWER(0xFE, 0x33);
    now_ms++;
    unlock();
}

void test_a_right_key_forgets_the_wrong_ones(void)
{
    for (int i = 0; i < 5; i++) {
        for (int k = 0; k < XCP_WRONG_KEYS - 1; k++) {
            connect();
            send_key(0);
        }
        connect();
        unlock();
    }
}

void test_downloads_change_the_staging_page_alone(void)
{
    connect();
    unlock();
    COMMAND(0xF6, 0, 0, 0, PAGE(motor.pole_pairs));
    COMMAND(0xF0, 4, 1, 0, 0, 0);
    ASSERT_ANSWER(0xFE, 0x23); /* the tool looks at the page in force */
    COMMAND(0xEB, 2, 0, 1);
    ASSERT_ANSWER(0xFF);
    COMMAND(0xEA, 2, 0);
    ASSERT_ANSWER(0xFF, 0, 0, 1);
    COMMAND(0xEA, 1, 0);
    ASSERT_ANSWER(0xFF, 0, 0, 0);
    COMMAND(0xF0, 3, 7, 8, 9);
    ASSERT_ANSWER(0xFF);
    COMMAND(0xF0, 1, 6);
    ASSERT_ANSWER(0xFF);
    TEST_ASSERT_EQUAL_HEX32(0x06090807, staging.motor.pole_pairs);
    TEST_ASSERT_EQUAL_HEX32(0x01020304, in_force.motor.pole_pairs);
    COMMAND(0xF4, 4, 0, 0, PAGE(motor.pole_pairs));
    ASSERT_ANSWER(0xFF, 7, 8, 9, 6);
    COMMAND(0xE4, 0, 0, 0, 1); /* as it was */
    ASSERT_ANSWER(0xFF);
    TEST_ASSERT_EQUAL_MEMORY(&in_force, &staging, sizeof staging);
    COMMAND(0xEB, 0x82, 9, 0);
    ASSERT_ANSWER(0xFF);
    COMMAND(0xF4, 4, 0, 0, PAGE(motor.pole_pairs));
    ASSERT_ANSWER(0xFF, 4, 3, 2, 1);
}

/* The checksum is computed when the page is stored, the key is nobody's. */
void test_checksum_and_key_cannot_be_written(void)
{
    connect();
    unlock();
    COMMAND(0xEB, 2, 0, 1);
    COMMAND(0xF6, 0, 0, 0, PAGE(crc32));
    COMMAND(0xF0, 1, 1);
    ASSERT_ANSWER(0xFE, 0x24);
    COMMAND(0xF6, 0, 0, 0, PAGE(service_key));
    COMMAND(0xF0, 4, 1, 2, 3, 4);
    ASSERT_ANSWER(0xFE, 0x24);
    COMMAND(0xF6, 0, 0, 0, BYTES(XCP_SIGNALS_ADDRESS));
    COMMAND(0xF0, 4, 1, 2, 3, 4);
    ASSERT_ANSWER(0xFE, 0x24);
    COMMAND(0xF6, 0, 0, 0, BYTES(XCP_PAGE_ADDRESS));
    COMMAND(0xF0, 0, 1);
    ASSERT_ANSWER(0xFE, 0x22);
    COMMAND(0xF0, 7, 1, 2, 3, 4, 5, 6);
    ASSERT_ANSWER(0xFE, 0x22);
    TEST_ASSERT_EQUAL_MEMORY(&in_force, &staging, sizeof staging);
}

void test_pages_segments_and_modes_that_do_not_exist_are_refused(void)
{
    connect();
    unlock();
    COMMAND(0xEB, 2, 1, 0);
    ASSERT_ANSWER(0xFE, 0x28);
    COMMAND(0xEB, 2, 0, 2);
    ASSERT_ANSWER(0xFE, 0x26);
    COMMAND(0xEB, 0, 0, 0);
    ASSERT_ANSWER(0xFE, 0x27);
    COMMAND(0xEB, 1, 0, 1); /* the controller changes its page at rest, by SET_REQUEST */
    ASSERT_ANSWER(0xFE, 0x27);
    COMMAND(0xEB, 3, 0, 0);
    ASSERT_ANSWER(0xFF);
    COMMAND(0xEA, 3, 0);
    ASSERT_ANSWER(0xFE, 0x27);
    COMMAND(0xEA, 2, 1);
    ASSERT_ANSWER(0xFE, 0x28);
    COMMAND(0xE4, 1, 0, 0, 1);
    ASSERT_ANSWER(0xFE, 0x28);
    COMMAND(0xE4, 0, 0, 0, 2);
    ASSERT_ANSWER(0xFE, 0x26);
    COMMAND(0xE4, 0, 1, 0, 0);
    ASSERT_ANSWER(0xFE, 0x23);
    COMMAND(0xE4, 0, 1, 0, 1);
    ASSERT_ANSWER(0xFF);
}

void test_storing_is_the_callers_decision(void)
{
    connect();
    unlock();
    COMMAND(0xF9, 8, 0, 0); /* CLEAR_DAQ */
    ASSERT_ANSWER(0xFE, 0x22);
    COMMAND(0xF9, 1, 0, 0);
    TEST_ASSERT_TRUE(slave.store_wanted);
    TEST_ASSERT_EQUAL_UINT32(0, answer_bytes);
    answer_bytes = xcp_store(&slave, XCP_ERROR_OUT_OF_RANGE, answer);
    ASSERT_ANSWER(0xFE, 0x22);
    TEST_ASSERT_FALSE(slave.store_wanted);
    COMMAND(0xF9, 1, 0, 0);
    answer_bytes = xcp_store(&slave, XCP_ERROR_NONE, answer);
    ASSERT_ANSWER(0xFF);
    COMMAND(0xE4, 0, 0, 0, 1); /* what was checked stays as it is */
    ASSERT_ANSWER(0xFE, 0x25);
}

void test_an_idle_session_ends(void)
{
    connect();
    unlock();
    now_ms += XCP_IDLE_ms - 1U;
    pass();
    COMMAND(0xFD);
    ASSERT_ANSWER(0xFF, 0, 0, 0, 0, 0);
    now_ms += XCP_IDLE_ms;
    pass();
    COMMAND(0xFD);
    TEST_ASSERT_EQUAL_UINT32(0, answer_bytes);
}

/* The installer takes its memory. */
void test_a_staging_page_that_is_gone_is_locked(void)
{
    connect();
    unlock();
    COMMAND(0xEB, 2, 0, 1);
    access.staging = NULL;
    COMMAND(0xF4, 4, 0, 0, PAGE(motor.pole_pairs));
    ASSERT_ANSWER(0xFF, 4, 3, 2, 1);
    COMMAND(0xF0, 1, 1);
    ASSERT_ANSWER(0xFE, 0x25);
    COMMAND(0xF8, 0, 1);
    ASSERT_ANSWER(0xFE, 0x33);
    access.staging = &staging;
    pass();
    COMMAND(0xF8, 0, 1);
    access.staging = NULL;
    COMMAND(0xF7, 6, 1, 2, 3, 4, 5, 6);
    ASSERT_ANSWER(0xFE, 0x33);
}

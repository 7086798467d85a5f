/* SPDX-License-Identifier: Apache-2.0 */
/* XCP over CAN, with the whole application on the simulated board. Packets by themselves:
 * firmware/comms/test_xcp.c. */
#include <stddef.h>
#include <string.h>

#include "app/config_store.h"
#include "board_rig.h"
#include "comms/mac.h"
#include "comms/xcp.h"
#include "config/validate.h"
#include "core/operating_mode.h"
#include "core/signals.h"
#include "unity.h"

enum { COMMANDS = 0x7F0 + 2, ANSWERS = COMMANDS + 4, PERIODS_A_ms = 20, ANSWER_MOST_ms = 3 };

/* Places in the table by its names. */
#define OUTPUT_PLACE(name, ...) PLACE_##name,
#define INPUT_PLACE(name, ...) PLACE_INPUT_##name,
#define FAST_OUTPUT_PLACE(name, ...) PLACE_FAST_OUTPUT_##name,
#define FAST_INPUT_PLACE(name, ...) PLACE_FAST_INPUT_##name,
#define FAST_VIEW_PLACE(name, ...) PLACE_FAST_VIEW_##name,
enum {
    SIGNALS_SLOW_OUTPUTS(OUTPUT_PLACE) SIGNALS_SLOW_INPUTS(INPUT_PLACE)
        SIGNALS_FAST_OUTPUTS(FAST_OUTPUT_PLACE) SIGNALS_FAST_INPUTS(FAST_INPUT_PLACE)
            SIGNALS_FAST_VIEW(FAST_VIEW_PLACE) PLACES
};

static config_t config;
static can_frame_t answer;

/* A rear left wheel with a key. */
void setUp(void)
{
    config = CONFIG_IMAGE;
    config.vehicle.wheel_position = 2;
    config.service_key[1] = 0x12345678;
    config.crc32 = config_crc32(&config, (uint32_t)offsetof(config_t, crc32));
}

void tearDown(void) {}

static bool ask(const uint8_t *bytes, size_t length)
{
    can_frame_t frame = {.identifier = COMMANDS, .length = (uint8_t)length};
    memcpy(frame.data, bytes, length);
    host_can_send(&frame);
    for (int ms = 0; ms < ANSWER_MOST_ms; ms++) {
        run_for(PERIODS_A_ms);
        while (host_can_receive(&answer)) {
            if (answer.identifier == ANSWERS) {
                return true;
            }
        }
    }
    return false;
}

#define ASK(...)                                                                                   \
    TEST_ASSERT_TRUE(ask((const uint8_t[]){__VA_ARGS__}, sizeof((const uint8_t[]){__VA_ARGS__})))
#define BYTES(address)                                                                             \
    (uint8_t)(address), (uint8_t)((address) >> 8), (uint8_t)((address) >> 16),                     \
        (uint8_t)((address) >> 24)

static void assert_positive(void)
{
    TEST_ASSERT_EQUAL_HEX8(0xFF, answer.data[0]);
}

static void assert_error(uint8_t code)
{
    TEST_ASSERT_EQUAL_UINT8(2, answer.length);
    TEST_ASSERT_EQUAL_HEX8(0xFE, answer.data[0]);
    TEST_ASSERT_EQUAL_HEX8(code, answer.data[1]);
}

static int32_t signal(uint32_t place)
{
    ASK(0xF4, 4, 0, 0, BYTES(XCP_SIGNALS_ADDRESS + 4U * place));
    assert_positive();
    uint32_t value = 0;
    for (uint32_t i = 0; i < 4U; i++) {
        value |= (uint32_t)answer.data[1U + i] << 8U * i;
    }
    return (int32_t)value;
}

static void start(int32_t speed_q32)
{
    connect(&config);
    sensors.speed_q32 = speed_q32;
    app_boot();
    run_for(20000);
    ASK(0xFF, 0);
    assert_positive();
}

static void unlock(void)
{
    uint64_t seed = 0;
    ASK(0xF8, 0, 1);
    for (uint32_t i = 0; i < 6U; i++) {
        seed |= (uint64_t)answer.data[2U + i] << 8U * i;
    }
    const uint64_t key = mac_of(config.service_key, seed);
    ASK(0xF7, 6, BYTES(key), (uint8_t)(key >> 32), (uint8_t)(key >> 40));
    assert_positive();
    ASK(0xEB, 2, 0, 1);
    assert_positive();
}

static void write(uint32_t offset, int32_t value)
{
    const uint32_t bits = (uint32_t)value;
    ASK(0xF6, 0, 0, 0, BYTES(XCP_PAGE_ADDRESS + offset));
    ASK(0xF0, 4, BYTES(bits));
    assert_positive();
}

#define WRITE(field, value) write((uint32_t)offsetof(config_t, field), value)

static const config_t *stored(void)
{
    return (const config_t *)config_store_in_force().image.begin;
}

void test_signals_are_those_of_the_slow_step(void)
{
    start(0);
    TEST_ASSERT_EQUAL_INT32(MODE_READY, signal(PLACE_mode));
    TEST_ASSERT_EQUAL_INT32(1, signal(PLACE_standstill));
    TEST_ASSERT_EQUAL_INT32(1, signal(PLACE_INPUT_selftest_passed));
    TEST_ASSERT_EQUAL_INT32(0, signal(PLACE_INPUT_drive_torque_nm));
    const int32_t bus_mV = signal(PLACE_bus_voltage_v);
    TEST_ASSERT_GREATER_THAN_INT32(config.battery.min_voltage_mV, bus_mV);
    TEST_ASSERT_LESS_THAN_INT32(config.battery.max_voltage_mV, bus_mV);
    ASK(0xF4, 1, 0, 0, BYTES(XCP_SIGNALS_ADDRESS + 4U * PLACES));
    assert_error(0x24);
}

void test_a_stored_parameter_is_used_after_the_restart(void)
{
    start(0);
    unlock();
    const int32_t time_ms = config.driver.lost_hold_ms + 7;
    WRITE(driver.lost_hold_ms, time_ms);
    TEST_ASSERT_EQUAL_INT32(config.driver.lost_hold_ms, stored()->driver.lost_hold_ms);
    ASK(0xF9, 1, 0, 0);
    assert_positive();
    run_for(2000);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(host_serial_output(), "written, restarting"),
                                 host_serial_output());
    TEST_ASSERT_TRUE(host_watchdog_bit());
    TEST_ASSERT_EQUAL_INT32(time_ms, stored()->driver.lost_hold_ms);
    TEST_ASSERT_EQUAL_HEX32_ARRAY(config.service_key, stored()->service_key, 4);
    TEST_ASSERT_EQUAL_INT(CONFIG_RESULT_OK, config_validate(stored(), sizeof(config_t)).code);
}

static void assert_unchanged(void)
{
    run_for(4000);
    TEST_ASSERT_EQUAL_MEMORY(&config, stored(), sizeof config);
    TEST_ASSERT_FALSE(host_watchdog_bit());
    TEST_ASSERT_TRUE(app_finish());
}

/* A value outside its range, and two that contradict each other. */
void test_a_page_that_the_validator_refuses_is_not_stored(void)
{
    start(0);
    unlock();
    WRITE(driver.lost_hold_ms, 10001);
    ASK(0xF9, 1, 0, 0);
    assert_error(0x22);
    TEST_ASSERT_NOT_NULL(strstr(host_serial_output(), "XCP: configuration refused: driver.lost_"));
    ASK(0xE4, 0, 0, 0, 1);
    assert_positive();
    WRITE(motor.rated_torque_mNm, config.motor.max_torque_mNm + 1);
    ASK(0xF9, 1, 0, 0);
    assert_error(0x22);
    assert_unchanged();
}

void test_a_turning_wheel_stores_nothing(void)
{
    start(8000000);
    unlock();
    WRITE(driver.lost_hold_ms, 299);
    ASK(0xF9, 1, 0, 0);
    assert_error(0x33);
    assert_unchanged();
}

/* The installer and the tool have one memory. */
void test_an_image_that_comes_by_the_serial_line_takes_the_staging_page(void)
{
    start(0);
    unlock();
    WRITE(driver.lost_hold_ms, 299);
    host_serial_type("install\r");
    run_for(100);
    ASK(0xF9, 1, 0, 0);
    assert_error(0x25);
    assert_unchanged();
}

void test_another_wheels_commands_and_a_base_of_zero_are_not_answered(void)
{
    const uint8_t connecting[] = {0xFF, 0};
    can_frame_t frame = {.identifier = COMMANDS + 1, .length = 2, .data = {0xFF, 0}};
    connect(&config);
    sensors.speed_q32 = 0;
    app_boot();
    run_for(20000);
    host_can_send(&frame);
    for (int ms = 0; ms < ANSWER_MOST_ms; ms++) {
        run_for(PERIODS_A_ms);
        while (host_can_receive(&frame)) {
            TEST_ASSERT_LESS_THAN_UINT16(COMMANDS, frame.identifier);
        }
    }
    config.service.can_base = 0;
    config.crc32 = config_crc32(&config, (uint32_t)offsetof(config_t, crc32));
    connect(&config);
    app_boot();
    run_for(20000);
    TEST_ASSERT_FALSE(ask(connecting, sizeof connecting));
}

/* ---- DAQ and scope ---- */

static void write_entry(uint32_t place, uint8_t bytes)
{
    ASK(0xE1, 0xFF, bytes, 0, BYTES(XCP_SIGNALS_ADDRESS + 4U * place));
    assert_positive();
}

/* Mode and warning of each slow step, in one frame a millisecond. */
static void start_list(void)
{
    ASK(0xE2, 0, 0, 0, 0, 0);
    assert_positive();
    write_entry(PLACE_bus_voltage_v, 4);
    write_entry(PLACE_mode, 1);
    ASK(0xE0, 0x10, 0, 0, 0, 0, 1, 0);
    assert_positive();
    ASK(0xDE, 1, 0, 0);
    assert_positive();
}

/* Between the frames another node reads the page and gets its answers. */
void test_a_minute_of_daq_on_can_has_no_gap(void)
{
    enum { MINUTE_ms = 60000, ASKS_EVERY_ms = 7 };
    const can_frame_t status = {.identifier = COMMANDS, .length = 1, .data = {0xFD}};
    uint32_t packets = 0, answers = 0, before = 0;
    start(0);
    start_list();
    for (int half_ms = 0; half_ms < 2 * MINUTE_ms; half_ms++) {
        if (half_ms % (2 * ASKS_EVERY_ms) == 0) {
            host_can_send(&status);
        }
        run_for(PERIODS_A_ms / 2);
        can_frame_t frame;
        while (host_can_receive(&frame)) {
            if (frame.identifier != ANSWERS || frame.data[0] == 0xFF) {
                answers += frame.identifier == ANSWERS ? 1U : 0U;
                continue;
            }
            const uint32_t ticks = frame.data[1] | (uint32_t)frame.data[2] << 8;
            TEST_ASSERT_EQUAL_UINT8(0, frame.data[0]);
            TEST_ASSERT_EQUAL_UINT8(8, frame.length);
            if (packets > 0) {
                TEST_ASSERT_EQUAL_UINT32(100, (ticks - before) & 0xFFFFU);
            }
            TEST_ASSERT_EQUAL_UINT8(MODE_READY, frame.data[7]);
            before = ticks;
            packets++;
        }
    }
    TEST_ASSERT_UINT32_WITHIN(2, MINUTE_ms, packets);
    TEST_ASSERT_EQUAL_UINT32((MINUTE_ms + ASKS_EVERY_ms - 1) / ASKS_EVERY_ms, answers);
}

static void write_scope(size_t offset, uint32_t value)
{
    ASK(0xF6, 0, 0, 0, BYTES(XCP_SCOPE_ADDRESS + (uint32_t)offset));
    ASK(0xF0, 4, BYTES(value));
    assert_positive();
}

static uint32_t read_scope(size_t offset)
{
    ASK(0xF4, 4, 0, 0, BYTES(XCP_SCOPE_ADDRESS + (uint32_t)offset));
    assert_positive();
    return answer.data[1] | (uint32_t)answer.data[2] << 8 | (uint32_t)answer.data[3] << 16 |
           (uint32_t)answer.data[4] << 24;
}

enum { ROWS = 300, ROW_BYTES = 4 };

static uint8_t record[ROWS * ROW_BYTES];

static void upload_record(void)
{
    for (uint32_t at = 0; at < sizeof record; at += ROW_BYTES) {
        ASK(0xF4, ROW_BYTES, 0, 0, BYTES(XCP_RECORD_ADDRESS + at));
        assert_positive();
        memcpy(&record[at], &answer.data[1], ROW_BYTES);
    }
}

/* Rows equal to what the sensors give from here on. */
static uint32_t rows_as_of(sensors_t sensors_then)
{
    uint32_t equal = 0;
    bool same = true;
    while (same && equal < ROWS) {
        const host_sample_t expected = next_sample(&sensors_then);
        const uint8_t *row = &record[ROW_BYTES * equal];
        same = expected.phase_current_code[0] == (row[0] | row[1] << 8) &&
               expected.phase_current_code[1] == (row[2] | row[3] << 8);
        equal += same ? 1U : 0U;
    }
    return equal;
}

/* The sensors' numbers in each period, from the one in which it begins. */
void test_the_scope_has_what_the_sensors_gave_in_each_period(void)
{
    start(8000000);
    write_scope(offsetof(scope_page_t, signal[0]), PLACE_FAST_INPUT_phase_a_a);
    write_scope(offsetof(scope_page_t, signal[5]), PLACE_FAST_INPUT_phase_b_a);
    write_scope(offsetof(scope_page_t, rows), ROWS);
    sensors_t twin = sensors;
    write_scope(offsetof(scope_page_t, run), 1);
    run_for(2 * ROWS);
    TEST_ASSERT_EQUAL_UINT32(SCOPE_COMPLETE, read_scope(offsetof(scope_page_t, phase)));
    TEST_ASSERT_EQUAL_UINT32(ROW_BYTES, read_scope(offsetof(scope_page_t, row_bytes)));
    TEST_ASSERT_EQUAL_UINT32(0, read_scope(offsetof(scope_page_t, first_row)));
    upload_record();
    uint32_t most = 0;
    for (int periods = 0; periods < 3 * ANSWER_MOST_ms * PERIODS_A_ms && most < ROWS; periods++) {
        const uint32_t equal = rows_as_of(twin);
        most = equal > most ? equal : most;
        (void)next_sample(&twin);
    }
    TEST_ASSERT_EQUAL_UINT32(ROWS, most);
}

/* The angle of the sensors turns by as much in each period; its first differences are the speed. */
void test_the_scope_has_the_current_loop_of_each_period(void)
{
    const uint32_t turn_a_period = 8000000 >> 16;
    start(8000000);
    write_scope(offsetof(scope_page_t, signal[0]), PLACE_FAST_VIEW_angle_turn);
    write_scope(offsetof(scope_page_t, signal[1]), PLACE_FAST_OUTPUT_duty_a);
    write_scope(offsetof(scope_page_t, rows), ROWS);
    write_scope(offsetof(scope_page_t, run), 1);
    run_for(2 * ROWS);
    TEST_ASSERT_EQUAL_UINT32(SCOPE_COMPLETE, read_scope(offsetof(scope_page_t, phase)));
    TEST_ASSERT_EQUAL_UINT32(ROW_BYTES, read_scope(offsetof(scope_page_t, row_bytes)));
    upload_record();
    for (uint32_t row = 1; row < ROWS; row++) {
        const uint8_t *now = &record[ROW_BYTES * row];
        const uint8_t *before = now - ROW_BYTES;
        const uint32_t turned = (uint32_t)(now[0] - before[0] + 256 * (now[1] - before[1]));
        TEST_ASSERT_UINT32_WITHIN(turn_a_period / 4, turn_a_period, turned & 0xFFFFU);
    }
}

/* ---- on the serial line ---- */

static uint8_t of_line[256];
static uint32_t of_line_bytes;

/* Everything since the call before. */
static void take_line(uint32_t milliseconds)
{
    run_for(milliseconds * PERIODS_A_ms);
    of_line_bytes = host_serial_take((char *)of_line, sizeof of_line);
}

static void ask_line(const uint8_t *packet, uint8_t length)
{
    uint8_t frame[11] = {length, 0x33};
    uint8_t sum = (uint8_t)(length + 0x33);
    for (uint32_t i = 0; i < length; i++) {
        frame[2 + i] = packet[i];
        sum = (uint8_t)(sum + packet[i]);
    }
    frame[2 + length] = sum;
    host_serial_put((const char *)frame, length + 3U);
    take_line(ANSWER_MOST_ms);
}

#define ASK_LINE(...)                                                                              \
    ask_line((const uint8_t[]){__VA_ARGS__}, (uint8_t)sizeof((const uint8_t[]){__VA_ARGS__}))

/* One frame and nothing else, with this number and a right sum. */
static void assert_line_answers(uint8_t first, uint8_t length, uint8_t counter)
{
    TEST_ASSERT_EQUAL_UINT32(length + 3U, of_line_bytes);
    TEST_ASSERT_EQUAL_UINT8(length, of_line[0]);
    TEST_ASSERT_EQUAL_UINT8(counter, of_line[1]);
    TEST_ASSERT_EQUAL_HEX8(first, of_line[2]);
    uint8_t sum = 0;
    for (uint32_t i = 0; i < length + 2U; i++) {
        sum = (uint8_t)(sum + of_line[i]);
    }
    TEST_ASSERT_EQUAL_HEX8(sum, of_line[length + 2U]);
}

static void turn_line_over(void)
{
    host_serial_type("xcp\r");
    take_line(20);
    TEST_ASSERT_NOT_NULL(strstr((const char *)of_line, "XCP\r\n"));
}

static void start_on_line(void)
{
    connect(&config);
    sensors.speed_q32 = 0;
    app_boot();
    run_for(20000);
    while (host_serial_take((char *)of_line, sizeof of_line) > 0) {
    }
    memset(of_line, 0, sizeof of_line);
    turn_line_over();
}

void test_the_serial_line_is_the_tool_s_until_it_disconnects(void)
{
    start_on_line();
    ASK_LINE(0xFF, 0);
    assert_line_answers(0xFF, 8, 0);
    ASK_LINE(0xF4, 4, 0, 0, BYTES(XCP_SIGNALS_ADDRESS + 4U * PLACE_mode));
    assert_line_answers(0xFF, 5, 1);
    TEST_ASSERT_EQUAL_UINT8(MODE_READY, of_line[3]);
    ASK_LINE(0xE1); /* START_STOP_SYNCH of no length */
    assert_line_answers(0xFE, 2, 2);
    host_serial_type("status\r"); /* no frame: the tool has the line */
    take_line(200);
    TEST_ASSERT_EQUAL_UINT32(0, of_line_bytes);
    ASK_LINE(0xFE);
    assert_line_answers(0xFF, 1, 3);
    host_serial_type("version\r");
    take_line(20);
    TEST_ASSERT_NOT_NULL(strstr((const char *)of_line, "hubfoc"));
}

void test_a_silent_tool_loses_line_and_session_after_two_seconds(void)
{
    start_on_line();
    ASK_LINE(0xFF, 0);
    assert_line_answers(0xFF, 8, 0);
    take_line(1900);
    ASK_LINE(0xFD);
    assert_line_answers(0xFF, 6, 1);
    take_line(2010);
    memset(of_line, 0, sizeof of_line);
    host_serial_type("version\r");
    take_line(20);
    TEST_ASSERT_NOT_NULL(strstr((const char *)of_line, "hubfoc"));
    turn_line_over();
    ASK_LINE(0xFD); /* the session has ended */
    TEST_ASSERT_EQUAL_UINT32(0, of_line_bytes);
}

/* What CAN had is gone with the serial line's CONNECT, and comes back with its own. */
void test_the_latest_connect_has_the_session_whatever_line_it_came_by(void)
{
    start_on_line();
    ASK(0xFF, 0);
    assert_positive();
    ASK_LINE(0xFD);
    TEST_ASSERT_EQUAL_UINT32(0, of_line_bytes);
    ASK_LINE(0xFF, 0);
    assert_line_answers(0xFF, 8, 0);
    TEST_ASSERT_FALSE(ask((const uint8_t[]){0xFD}, 1));
    ASK(0xFF, 0);
    assert_positive();
    take_line(2010); /* the silent line ends no session but its own */
    ASK(0xFD);
    assert_positive();
}

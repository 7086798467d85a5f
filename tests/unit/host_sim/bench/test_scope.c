/* SPDX-License-Identifier: Apache-2.0 */
/* The wheel's scope on a simulated vehicle: a record of a current step, uploaded by XCP, against
 * what the host gave to the application and got from it in each PWM period, bit for bit. */
#include "comms/scope.h"

#include <stddef.h>
#include <string.h>

#include "bench/board.h"
#include "comms/xcp.h"
#include "core/signals.h"
#include "unity.h"
#include "vehicle_fixture.h"

/* Places in the table by its names. */
#define OUTPUT_PLACE(name, ...) OUTPUT_##name,
#define INPUT_PLACE(name, ...) INPUT_##name,
#define FAST_OUTPUT_PLACE(name, ...) FAST_OUTPUT_##name,
#define FAST_INPUT_PLACE(name, ...) FAST_INPUT_##name,
enum {
    SIGNALS_SLOW_OUTPUTS(OUTPUT_PLACE) SIGNALS_SLOW_INPUTS(INPUT_PLACE)
        SIGNALS_FAST_OUTPUTS(FAST_OUTPUT_PLACE) SIGNALS_FAST_INPUTS(FAST_INPUT_PLACE) PLACES
};
#define BYTES(address)                                                                             \
    (uint8_t)(address), (uint8_t)((address) >> 8), (uint8_t)((address) >> 16),                     \
        (uint8_t)((address) >> 24)

enum { TRACE = 20000, BEFORE = 200, WORD_BYTES = 4 };

/* The host's trace: what a period was given, and what the next one got. */
typedef struct {
    fast_input_t in;
    fast_output_t out;
} period_t;

static const int32_t CHANNELS[SCOPE_CHANNELS] = {
    FAST_INPUT_phase_a_a, FAST_INPUT_phase_b_a, FAST_INPUT_bus_voltage_v, FAST_INPUT_hall_state,
    FAST_OUTPUT_duty_a,   FAST_OUTPUT_duty_b,   FAST_OUTPUT_duty_c,       FAST_INPUT_phase_c_a};
enum { ROW_BYTES = 2 + 2 + 2 + 1 + 2 + 2 + 2 + 2 };

static bench_t bench;
static board_t board;
static wheel_coupling_t through;
static period_t trace[TRACE];
static uint32_t periods;
static bool traces;
static packet_t packet;
static uint8_t record[16384];

static fast_output_t period(void *context, const fast_input_t *in)
{
    const fast_output_t out = through.period(context, in);
    if (!traces) {
        return out;
    }
    if (periods > 0) {
        trace[(periods - 1U) % TRACE].out = out; /* becomes active at the next top */
    }
    trace[periods % TRACE].in = *in;
    periods++;
    return out;
}

static void ask(const uint8_t *bytes, size_t length)
{
    packet.length = (uint8_t)length;
    memcpy(packet.bytes, bytes, length);
    TEST_ASSERT_TRUE(host_packet_send(&packet));
    fixture_run(&bench, 0.001);
    TEST_ASSERT_TRUE(host_packet_receive(&packet));
    TEST_ASSERT_EQUAL_HEX8(0xFF, packet.bytes[0]);
}

#define ASK(...) ask((const uint8_t[]){__VA_ARGS__}, sizeof((const uint8_t[]){__VA_ARGS__}))

static void put(size_t offset, int32_t value)
{
    const uint32_t bits = (uint32_t)value;
    ASK(0xF6, 0, 0, 0, BYTES(XCP_SCOPE_ADDRESS + (uint32_t)offset));
    ASK(0xF0, 4, BYTES(bits));
}

static uint32_t get(size_t offset)
{
    ASK(0xF4, 4, 0, 0, BYTES(XCP_SCOPE_ADDRESS + (uint32_t)offset));
    return packet.bytes[1] | (uint32_t)packet.bytes[2] << 8 | (uint32_t)packet.bytes[3] << 16 |
           (uint32_t)packet.bytes[4] << 24;
}

static void upload(uint32_t bytes)
{
    for (uint32_t at = 0; at < bytes; at += WORD_BYTES) {
        const uint32_t count = bytes - at < WORD_BYTES ? bytes - at : WORD_BYTES;
        ASK(0xF4, (uint8_t)count, 0, 0, BYTES(XCP_RECORD_ADDRESS + at));
        memcpy(&record[at], &packet.bytes[1], count);
    }
}

static uint16_t half(const uint8_t *at)
{
    return (uint16_t)(at[0] | at[1] << 8);
}

static bool equal(const uint8_t *row, const period_t *expected)
{
    const fast_input_t *in = &expected->in;
    const uint16_t *on = expected->out.compare_counts;
    return half(row) == in->phase_current_code[0] && half(row + 2) == in->phase_current_code[1] &&
           half(row + 4) == in->bus_voltage_code && row[6] == in->hall_state &&
           half(row + 7) == on[0] && half(row + 9) == on[1] && half(row + 11) == on[2] &&
           half(row + 13) == in->phase_current_code[2];
}

static void begin(void)
{
    const config_t config =
        fixture_config_with_sensor(CONFIG_STRATEGY_SERIES_OPTIMAL, CONFIG_ROTOR_HALL);
    bench_params_t params = fixture_quarter_vehicle();
    const driver_trace_t none = {.points = 0};
    params.run.initial_speed_m_per_s = 5.0;
    periods = 0;
    traces = true;
    board_start(&board, &config);
    through = board_coupling(&board);
    wheel_coupling_t traced = through;
    traced.period = period;
    static wheel_coupling_t coupling;
    coupling = traced;
    bench_init(&bench, &params, &config, &none);
    bench.wheel[0].coupling = &coupling;
    TEST_ASSERT_EQUAL_INT(BENCH_READY, bench_start(&bench));
    fixture_run(&bench, 0.2);
    ASK(0xFF, 0);
}

void setUp(void) {}

void tearDown(void) {}

/* The current follows the demand of 60 N m. The memory's 1 092 rows of 15 bytes are 55 ms, of which
 * 10 ms lie before the trigger. */
void test_a_record_of_a_current_step_is_the_hosts_trace_bit_for_bit(void)
{
    begin();
    for (size_t k = 0; k < SCOPE_CHANNELS; k++) {
        put(offsetof(scope_page_t, signal) + 4U * k, CHANNELS[k]);
    }
    put(offsetof(scope_page_t, trigger), SCOPE_RISES);
    put(offsetof(scope_page_t, trigger_signal), INPUT_brake_torque_nm);
    put(offsetof(scope_page_t, level), 30000);
    put(offsetof(scope_page_t, before_rows), BEFORE);
    put(offsetof(scope_page_t, run), 1);
    fixture_run(&bench, 0.05);
    TEST_ASSERT_EQUAL_UINT32(SCOPE_ARMED, get(offsetof(scope_page_t, phase)));
    bench.params.driver.brake_demand_nm = 60.0;
    fixture_run(&bench, 0.1);
    TEST_ASSERT_EQUAL_UINT32(SCOPE_COMPLETE, get(offsetof(scope_page_t, phase)));
    const uint32_t rows = get(offsetof(scope_page_t, record_rows));
    const uint32_t first = get(offsetof(scope_page_t, first_row));
    const uint32_t last_period = periods - 1U;
    traces = false; /* the upload takes seconds */
    TEST_ASSERT_EQUAL_UINT32(ROW_BYTES, get(offsetof(scope_page_t, row_bytes)));
    TEST_ASSERT_EQUAL_UINT32(16384 / ROW_BYTES, rows);
    upload(rows * ROW_BYTES);
    uint32_t most = 0, begins = 0;
    for (uint32_t from = last_period - 4000U; from + rows < last_period; from++) {
        uint32_t same = 0;
        while (same < rows &&
               equal(&record[(first + same) % rows * ROW_BYTES], &trace[(from + same) % TRACE])) {
            same++;
        }
        begins = same > most ? from : begins;
        most = same > most ? same : most;
    }
    TEST_ASSERT_EQUAL_UINT32(rows, most);
    int32_t before = 0, after = 0;
    for (uint32_t row = 0; row < rows; row++) {
        const int32_t beside =
            (int32_t)trace[(begins + row) % TRACE].in.phase_current_code[0] - 2048;
        const int32_t size = beside < 0 ? -beside : beside;
        before = row < BEFORE && size > before ? size : before;
        after = row >= BEFORE && size > after ? size : after;
    }
    TEST_ASSERT_GREATER_THAN_INT32(10 * before, after); /* it is a step */
}

typedef struct {
    uint16_t current, on;
} trace_row_t;

/* Of the packets that have come: without a gap in their time. */
static uint32_t take(trace_row_t *rows, uint32_t count, uint32_t *ticks)
{
    while (host_packet_receive(&packet)) {
        const uint32_t now = half(&packet.bytes[1]);
        TEST_ASSERT_EQUAL_UINT8(7, packet.length);
        TEST_ASSERT_EQUAL_UINT8(8, packet.bytes[0]);
        if (count > 0) {
            TEST_ASSERT_EQUAL_UINT32(5, (now - *ticks) & 0xFFFFU);
        }
        *ticks = now;
        rows[count].current = half(&packet.bytes[3]);
        rows[count].on = half(&packet.bytes[5]);
        count++;
    }
    return count;
}

void test_a_stream_of_every_pwm_period_is_the_hosts_trace_without_a_gap(void)
{
    enum { MILLISECONDS = 800, MOST = 20 * MILLISECONDS + 100 };
    static trace_row_t rows[MOST];
    begin();
    ASK(0xE2, 0, 1, 0, 0, 0);
    ASK(0xE1, 0xFF, 2, 0, BYTES(XCP_SIGNALS_ADDRESS + 4U * FAST_INPUT_phase_a_a));
    ASK(0xE1, 0xFF, 2, 0, BYTES(XCP_SIGNALS_ADDRESS + 4U * FAST_OUTPUT_duty_c));
    const uint32_t begins = periods;
    ASK(0xDE, 1, 1, 0);
    uint32_t count = 0, ticks = 0, most = 0;
    bench.params.driver.brake_demand_nm = 60.0;
    for (int ms = 0; ms < MILLISECONDS; ms++) {
        fixture_run(&bench, 0.001);
        count = take(rows, count, &ticks);
    }
    TEST_ASSERT_UINT32_WITHIN(40, 20U * MILLISECONDS, count);
    for (uint32_t from = begins - 20U; from < begins + 60U; from++) {
        uint32_t same = 0;
        while (same < count && from + same + 1U < periods) {
            const period_t *expected = &trace[(from + same) % TRACE];
            if (expected->in.phase_current_code[0] != rows[same].current ||
                expected->out.compare_counts[2] != rows[same].on) {
                break;
            }
            same++;
        }
        most = same > most ? same : most;
    }
    TEST_ASSERT_UINT32_WITHIN(1, count, most); /* what the last one did is not in the trace yet */
}

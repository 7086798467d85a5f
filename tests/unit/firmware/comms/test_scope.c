/* SPDX-License-Identifier: Apache-2.0 */
#include "comms/scope.h"

#include <stddef.h>
#include <string.h>

#include "core/reason.h"
#include "unity.h"

enum { MEMORY = 64, GUARD = 8, PWM_Hz = 20000, FAST = 0, FAST_BYTE = 1, SLOW = 2, SIGNALS = 3 };
#define WORD(member) ((uint32_t)offsetof(scope_page_t, member) / 4U)

typedef struct {
    uint16_t ramp;
    uint8_t flag;
} fast_t;

static const xcp_signal_t SIGNAL[SIGNALS] = {{offsetof(fast_t, ramp), 2, XCP_RECORD_FAST_INPUT},
                                             {offsetof(fast_t, flag), 1, XCP_RECORD_FAST_INPUT},
                                             {0, 4, XCP_RECORD_OUTPUT}};

static fast_t fast;
static int32_t slow;
static uint8_t memory[MEMORY + GUARD];
static findings_t findings;
static scope_t scope;
static const xcp_table_t TABLE = {
    SIGNAL, SIGNALS, {[XCP_RECORD_OUTPUT] = &slow, [XCP_RECORD_FAST_INPUT] = &fast}};

void setUp(void)
{
    static const finding_times_t TIMES[FINDING_COUNT];
    memset(memory, 0xA5, sizeof memory);
    memset(&fast, 0, sizeof fast);
    slow = 0;
    findings_init(&findings, TIMES, false);
    scope_init(&scope, memory, MEMORY, PWM_Hz);
}

void tearDown(void)
{
    for (int i = 0; i < GUARD; i++) {
        TEST_ASSERT_EQUAL_HEX8(0xA5, memory[MEMORY + i]);
    }
}

static xcp_error_t put(uint32_t word, int32_t value)
{
    return scope_write(&scope, &TABLE, word, value);
}

static void set(uint32_t word, int32_t value)
{
    TEST_ASSERT_EQUAL_INT(XCP_ERROR_NONE, put(word, value));
}

/* A ramp by one a period. */
static void periods(int count)
{
    for (int i = 0; i < count; i++) {
        fast.ramp++;
        scope_fast_step(&scope);
    }
}

static uint32_t value_of(uint32_t row)
{
    const uint32_t at = ((uint32_t)scope_page(&scope)->first_row + row) %
                        (uint32_t)scope_page(&scope)->record_rows * 2U;
    return memory[at] | (uint32_t)memory[at + 1U] << 8;
}

static void assert_ramp(uint32_t first, uint32_t rows, uint32_t step)
{
    TEST_ASSERT_EQUAL_INT(SCOPE_COMPLETE, scope_page(&scope)->phase);
    TEST_ASSERT_EQUAL_UINT32(2U * rows, scope_record_bytes(&scope));
    for (uint32_t i = 0; i < rows; i++) {
        TEST_ASSERT_EQUAL_UINT32(first + i * step, value_of(i));
    }
}

/* Of 64 bytes rows of two bytes fill 32. */
void test_without_a_trigger_the_record_begins_at_once(void)
{
    set(WORD(signal[0]), FAST);
    set(WORD(run), 1);
    TEST_ASSERT_TRUE(scope_runs(&scope));
    periods(31);
    TEST_ASSERT_EQUAL_UINT32(0, scope_record_bytes(&scope));
    periods(9);
    TEST_ASSERT_FALSE(scope_runs(&scope));
    assert_ramp(1, 32, 1);
}

void test_a_row_is_taken_every_so_many_periods(void)
{
    set(WORD(signal[0]), FAST);
    set(WORD(periods), 7);
    set(WORD(rows), 5);
    set(WORD(run), 1);
    periods(100);
    assert_ramp(1, 5, 7);
}

/* The trigger's row is the one behind those before it, wherever the ring has been meanwhile. */
void test_an_edge_is_in_its_row_however_long_it_takes(void)
{
    for (int32_t level = 4; level < 120; level++) {
        setUp();
        set(WORD(signal[0]), FAST);
        set(WORD(trigger), SCOPE_RISES);
        set(WORD(trigger_signal), FAST);
        set(WORD(level), level);
        set(WORD(before_rows), 3);
        set(WORD(rows), 10);
        set(WORD(run), 1);
        periods(200);
        assert_ramp((uint32_t)level - 3U, 10, 1);
    }
}

/* The value passes the level in the second row, when three are still to come before the trigger. */
void test_an_edge_before_the_rows_before_it_are_there_does_not_count(void)
{
    set(WORD(signal[0]), FAST);
    set(WORD(trigger), SCOPE_RISES);
    set(WORD(trigger_signal), FAST);
    set(WORD(level), 2);
    set(WORD(before_rows), 3);
    set(WORD(run), 1);
    periods(100);
    TEST_ASSERT_EQUAL_INT(SCOPE_ARMED, scope_page(&scope)->phase);
}

static void trigger_by(int32_t trigger, int32_t level)
{
    setUp();
    set(WORD(signal[0]), FAST_BYTE);
    set(WORD(rows), 1);
    set(WORD(trigger), trigger);
    set(WORD(trigger_signal), FAST_BYTE);
    set(WORD(level), level);
    set(WORD(run), 1);
}

static bool triggers(uint8_t value)
{
    fast.flag = value;
    scope_fast_step(&scope);
    return scope_page(&scope)->phase == SCOPE_COMPLETE;
}

void test_levels_and_edges_of_both_directions(void)
{
    trigger_by(SCOPE_ABOVE, 5);
    TEST_ASSERT_FALSE(triggers(4));
    TEST_ASSERT_TRUE(triggers(5));
    trigger_by(SCOPE_BELOW, 5);
    TEST_ASSERT_FALSE(triggers(6));
    TEST_ASSERT_TRUE(triggers(5));
    trigger_by(SCOPE_RISES, 5);
    TEST_ASSERT_FALSE(triggers(6)); /* there is no row before */
    TEST_ASSERT_FALSE(triggers(4));
    TEST_ASSERT_TRUE(triggers(5));
    trigger_by(SCOPE_FALLS, 5);
    TEST_ASSERT_FALSE(triggers(4));
    TEST_ASSERT_FALSE(triggers(6));
    TEST_ASSERT_TRUE(triggers(5));
}

static void slow_step(void)
{
    scope_slow_step(&scope, &TABLE, &findings);
}

static void find(finding_t row)
{
    findings.present[(uint32_t)row / 32U] |= findings_bit(row);
}

/* One that is present already does not appear; another reason is none of the wanted. */
void test_a_finding_triggers_when_it_appears(void)
{
    const reason_t weak = findings_reason(&findings, FINDING_BRAKE_WEAK);
    find(FINDING_BRAKE_DEAD);
    trigger_by(SCOPE_FINDING, (int32_t)weak);
    find(FINDING_BRAKE_DEAD);
    slow_step();
    TEST_ASSERT_FALSE(triggers(0));
    slow_step();
    TEST_ASSERT_FALSE(triggers(0));
    find(FINDING_BRAKE_WEAK);
    TEST_ASSERT_FALSE(triggers(0)); /* the slow step sees it */
    slow_step();
    TEST_ASSERT_TRUE(triggers(0));
    trigger_by(SCOPE_FINDING, REASON_NONE);
    find(FINDING_BRAKE_DEAD);
    slow_step();
    TEST_ASSERT_FALSE(triggers(0));
    setUp();
    trigger_by(SCOPE_FINDING, REASON_NONE);
    slow_step();
    find(FINDING_BRAKE_DEAD);
    slow_step();
    TEST_ASSERT_TRUE(triggers(0));
}

/* Rows of 2, 4 and 1 bytes, in the order of the settings: the slow signal as it was at each slow
 * step. */
void test_slow_signals_stand_beside_fast_ones(void)
{
    set(WORD(signal[0]), FAST);
    set(WORD(signal[3]), SLOW);
    set(WORD(signal[7]), FAST_BYTE);
    set(WORD(rows), 3);
    slow = -2;
    set(WORD(run), 1);
    fast.flag = 9;
    periods(1);
    slow = 0x01020304;
    periods(1);
    slow_step();
    periods(1);
    static const uint8_t EXPECTED[21] = {1,    0,    0xFE, 0xFF, 0xFF, 0xFF, 9, 2, 0, 0xFE, 0xFF,
                                         0xFF, 0xFF, 9,    3,    0,    4,    3, 2, 1, 9};
    TEST_ASSERT_EQUAL_INT(7, scope_page(&scope)->row_bytes);
    TEST_ASSERT_EQUAL_HEX32(0x10004002, scope_page(&scope)->row_layout);
    TEST_ASSERT_EQUAL_UINT32(sizeof EXPECTED, scope_record_bytes(&scope));
    TEST_ASSERT_EQUAL_HEX8_ARRAY(EXPECTED, memory, sizeof EXPECTED);
}

void test_what_does_not_fit_is_refused(void)
{
    TEST_ASSERT_EQUAL_INT(XCP_ERROR_OUT_OF_RANGE, put(WORD(run), 1)); /* no signal */
    TEST_ASSERT_EQUAL_INT(XCP_ERROR_OUT_OF_RANGE, put(WORD(signal[0]), SIGNALS));
    TEST_ASSERT_EQUAL_INT(XCP_ERROR_OUT_OF_RANGE, put(WORD(signal[0]), -2));
    TEST_ASSERT_EQUAL_INT(XCP_ERROR_OUT_OF_RANGE, put(WORD(trigger), SCOPE_TRIGGERS));
    TEST_ASSERT_EQUAL_INT(XCP_ERROR_OUT_OF_RANGE, put(WORD(trigger), -1));
    TEST_ASSERT_EQUAL_INT(XCP_ERROR_OUT_OF_RANGE, put(WORD(trigger_signal), -1));
    TEST_ASSERT_EQUAL_INT(XCP_ERROR_OUT_OF_RANGE, put(WORD(periods), 0));
    TEST_ASSERT_EQUAL_INT(XCP_ERROR_OUT_OF_RANGE, put(WORD(periods), SCOPE_PERIODS_MOST + 1));
    TEST_ASSERT_EQUAL_INT(XCP_ERROR_OUT_OF_RANGE, put(WORD(rows), -1));
    TEST_ASSERT_EQUAL_INT(XCP_ERROR_OUT_OF_RANGE, put(WORD(run), 2));
    TEST_ASSERT_EQUAL_INT(XCP_ERROR_WRITE_PROTECTED, put(WORD(phase), 1));
    TEST_ASSERT_EQUAL_INT(XCP_ERROR_WRITE_PROTECTED, put(WORD(memory_bytes), 1));
    set(WORD(signal[0]), SLOW);
    set(WORD(rows), 17); /* of four bytes 16 fit */
    TEST_ASSERT_EQUAL_INT(XCP_ERROR_OUT_OF_RANGE, put(WORD(run), 1));
    set(WORD(rows), 16);
    set(WORD(before_rows), 16);
    TEST_ASSERT_EQUAL_INT(XCP_ERROR_OUT_OF_RANGE, put(WORD(run), 1));
    set(WORD(before_rows), 15);
    set(WORD(run), 1);
    TEST_ASSERT_EQUAL_INT(XCP_ERROR_NOT_ACCESSIBLE_NOW, put(WORD(level), 1));
    TEST_ASSERT_EQUAL_INT(XCP_ERROR_NOT_ACCESSIBLE_NOW, put(WORD(run), 1));
    set(WORD(run), 0);
    TEST_ASSERT_EQUAL_INT(SCOPE_OFF, scope_page(&scope)->phase);
    set(WORD(level), 1);
}

void test_a_port_without_memory_has_no_scope(void)
{
    const scope_entry_t one[SCOPE_CHANNELS] = {{FAST, 2}};
    scope_init(&scope, NULL, 0, PWM_Hz);
    TEST_ASSERT_EQUAL_INT(XCP_ERROR_WRITE_PROTECTED, put(WORD(run), 1));
    TEST_ASSERT_EQUAL_INT(XCP_ERROR_NOT_ACCESSIBLE_NOW,
                          scope_start_stream(&scope, &TABLE, one, 1, 0));
    TEST_ASSERT_EQUAL_INT(0, scope_page(&scope)->memory_bytes);
}

/* 50 us are five ticks: every third period 15, from the time given on. Rows of 4 bytes fill 16. */
void test_a_stream_has_its_time_and_says_what_was_lost(void)
{
    const scope_entry_t one[SCOPE_CHANNELS] = {{0, 0}, {FAST, 2}};
    uint8_t row[SCOPE_TIME_BYTES + SCOPE_ROW_BYTES];
    TEST_ASSERT_EQUAL_INT(XCP_ERROR_NONE, scope_start_stream(&scope, &TABLE, one, 3, 65530));
    TEST_ASSERT_EQUAL_INT(XCP_ERROR_NOT_ACCESSIBLE_NOW,
                          scope_start_stream(&scope, &TABLE, one, 3, 0));
    TEST_ASSERT_EQUAL_INT(XCP_ERROR_NOT_ACCESSIBLE_NOW, put(WORD(run), 0));
    for (uint32_t k = 0; k < 100; k++) {
        periods(1);
        const uint32_t time = (65530U + 5U + 15U * k) % 65536U;
        TEST_ASSERT_EQUAL_UINT32(4, scope_next_row(&scope, row));
        TEST_ASSERT_EQUAL_UINT32(time, row[0] | (uint32_t)row[1] << 8);
        TEST_ASSERT_EQUAL_UINT32(1U + 3U * k, row[2] | (uint32_t)row[3] << 8);
        scope_row_taken(&scope);
        TEST_ASSERT_EQUAL_UINT32(0, scope_next_row(&scope, row));
        periods(2);
    }
    periods(3 * 16);
    TEST_ASSERT_FALSE(scope.lost);
    periods(3);
    TEST_ASSERT_TRUE(scope.lost);
    for (uint32_t k = 0; k < 16; k++) { /* those that were there stay */
        TEST_ASSERT_EQUAL_UINT32(4, scope_next_row(&scope, row));
        TEST_ASSERT_EQUAL_UINT32(301U + 3U * k, row[2] | (uint32_t)row[3] << 8);
        scope_row_taken(&scope);
    }
    TEST_ASSERT_EQUAL_UINT32(0, scope_next_row(&scope, row));
    scope_stop(&scope);
    TEST_ASSERT_EQUAL_INT(SCOPE_OFF, scope_page(&scope)->phase);
}

void test_a_complete_record_stays_when_a_session_ends(void)
{
    set(WORD(signal[0]), FAST);
    set(WORD(run), 1);
    periods(40);
    scope_stop(&scope);
    assert_ramp(1, 32, 1);
    periods(10);
    assert_ramp(1, 32, 1);
}

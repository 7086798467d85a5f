/* SPDX-License-Identifier: Apache-2.0 */
/* The black box: what it holds around the first fault, and what a reset leaves of it. */
#include <string.h>

#include "app/recorder.h"
#include "config/validate.h"
#include "unity.h"

enum { PERIODS_PER_MS = 20 };

static recorder_memory_t memory;
static recorder_t recorder;
static slow_output_t output;
static wheel_temperatures_t temperature;
static recorder_start_t start;
static uint16_t periods;
static int32_t milliseconds;

static void power_up(void)
{
    memset(&memory, 0xA5, sizeof memory);
    recorder_init(&recorder, &memory, &start);
}

void setUp(void)
{
    const slow_output_t running = {.mode = MODE_RUN, .torque_reason = REASON_LOSS_OPTIMUM};
    const recorder_start_t usual = {.pwm_frequency_Hz = 20000, .config_crc32 = 0x12345678};
    output = running;
    start = usual;
    temperature.winding_cC = 5000;
    temperature.switch_cC = 4000;
    periods = 0;
    milliseconds = 0;
    power_up();
}

void tearDown(void) {}

/* Period n has the codes n, n + 1, n + 2; the slow step of millisecond m shows m/100 rad/s. */
static void run(int count_ms)
{
    for (int n = 0; n < count_ms; n++) {
        for (int k = 0; k < PERIODS_PER_MS; k++) {
            const recorder_fast_t sample = {
                .phase_code = {periods, (uint16_t)(periods + 1), (uint16_t)(periods + 2)},
                .bus_code = 3000,
                .rotor = (uint16_t)(periods * 7U),
                .on_a_counts = 99};
            if (recorder.takes_samples) {
                recorder_fast(&memory, &sample, BRIDGE_PWM);
            }
            periods++;
        }
        output.speed_mrad_s = 10 * milliseconds;
        milliseconds++;
        recorder_slow(&recorder, &output, &temperature);
    }
}

static void fail_now(void)
{
    output.fault_reason = REASON_OVERCURRENT;
    output.mode = MODE_FAULT;
}

void test_memory_is_at_most_8_kib(void)
{
    TEST_ASSERT_LESS_OR_EQUAL_size_t(8192, sizeof(recorder_memory_t));
}

void test_memory_of_any_content_begins_as_an_empty_recording(void)
{
    TEST_ASSERT_EQUAL_UINT8(RECORDER_RECORDING, memory.phase);
    for (int i = 0; i < RECORDER_COUNTED; i++) {
        TEST_ASSERT_EQUAL_UINT16(0, memory.counts[i]);
    }
    TEST_ASSERT_EQUAL_UINT32(20000, memory.pwm_frequency_Hz);
    TEST_ASSERT_EQUAL_UINT32(0x12345678, memory.config_crc32);
}

/* The latest fast entry is 5 ms after the slow step that saw the fault, the latest slow one 0.5 s
 * after it; both rings are full of consecutive entries before. */
void test_rings_hold_what_was_before_the_first_fault_and_what_followed(void)
{
    run(3000);
    const uint16_t at_fault = periods;
    fail_now();
    run(1000);
    TEST_ASSERT_EQUAL_UINT8(RECORDER_COMPLETE, memory.phase);
    TEST_ASSERT_EQUAL_UINT8(REASON_OVERCURRENT, memory.reason);
    TEST_ASSERT_EQUAL_UINT32(3000, memory.fault_ms);
    TEST_ASSERT_EQUAL_UINT8(0, memory.after_reset);
    uint16_t expected =
        (uint16_t)(at_fault + RECORDER_FAST_AFTER_ms * PERIODS_PER_MS - RECORDER_FAST_ENTRIES);
    for (uint32_t i = 0; i < RECORDER_FAST_ENTRIES; i++, expected++) {
        const recorder_fast_t *entry = &memory.fast[(memory.fast_next + i) % RECORDER_FAST_ENTRIES];
        TEST_ASSERT_EQUAL_UINT16(expected, entry->phase_code[0]);
        TEST_ASSERT_EQUAL_UINT16(expected + 2, entry->phase_code[2]);
        TEST_ASSERT_EQUAL_UINT16(expected * 7U, entry->rotor);
        TEST_ASSERT_EQUAL_UINT16(3000 + (BRIDGE_PWM << 14), entry->bus_code);
        TEST_ASSERT_EQUAL_UINT16(99, entry->on_a_counts);
    }
    const int32_t last_ms = 3000 + RECORDER_SLOW_AFTER_ms - RECORDER_SLOW_PERIOD_ms;
    int32_t at_ms = last_ms - (RECORDER_SLOW_ENTRIES - 1) * RECORDER_SLOW_PERIOD_ms;
    for (uint32_t i = 0; i < RECORDER_SLOW_ENTRIES; i++, at_ms += RECORDER_SLOW_PERIOD_ms) {
        const recorder_slow_t *entry = &memory.slow[(memory.slow_next + i) % RECORDER_SLOW_ENTRIES];
        TEST_ASSERT_EQUAL_INT16(at_ms / 10, entry->speed_dr_s);
        TEST_ASSERT_EQUAL_UINT8(at_ms < 3000 ? REASON_LOSS_OPTIMUM : REASON_OVERCURRENT,
                                entry->reason);
        TEST_ASSERT_EQUAL_INT8(50, entry->winding_C);
        TEST_ASSERT_EQUAL_INT8(40, entry->switch_C);
    }
}

void test_later_faults_are_counted_but_the_first_record_stays(void)
{
    run(100);
    fail_now();
    run(600);
    static recorder_memory_t first;
    first = memory;
    for (int n = 0; n < 3; n++) {
        output.fault_reason = REASON_NONE;
        run(50);
        output.fault_reason = REASON_CURRENT_SUM;
        run(600);
    }
    TEST_ASSERT_EQUAL_UINT16(1, memory.counts[REASON_OVERCURRENT - REASON_FIRST_FAULT]);
    TEST_ASSERT_EQUAL_UINT16(3, memory.counts[REASON_CURRENT_SUM - REASON_FIRST_FAULT]);
    TEST_ASSERT_EQUAL_MEMORY(first.fast, memory.fast, sizeof first.fast);
    TEST_ASSERT_EQUAL_MEMORY(first.slow, memory.slow, sizeof first.slow);
    TEST_ASSERT_EQUAL_UINT8(REASON_OVERCURRENT, memory.reason);
}

void test_a_sealed_record_and_its_counters_survive_a_reset_and_further_faults(void)
{
    run(100);
    fail_now();
    run(600);
    TEST_ASSERT_TRUE(recorder_seal(&recorder));
    TEST_ASSERT_FALSE(recorder_seal(&recorder));
    TEST_ASSERT_EQUAL_UINT8(RECORDER_SEALED, memory.phase);
    const uint8_t *bytes = (const uint8_t *)&memory;
    const size_t from = offsetof(recorder_memory_t, crc32) + 4;
    TEST_ASSERT_EQUAL_UINT32(config_crc32(&bytes[from], (uint32_t)(sizeof memory - from)),
                             memory.crc32);
    output.fault_reason = REASON_NONE;
    run(10);
    output.fault_reason = REASON_CURRENT_SUM; /* counted after the seal */
    run(10);
    static recorder_memory_t before;
    before = memory;
    start.was_watchdog = true;
    recorder_init(&recorder, &memory, &start);
    run(1000);
    TEST_ASSERT_EQUAL_MEMORY(before.fast, memory.fast, sizeof before.fast);
    TEST_ASSERT_EQUAL_UINT8(REASON_OVERCURRENT, memory.reason);
    TEST_ASSERT_EQUAL_UINT16(1, memory.counts[REASON_OVERCURRENT - REASON_FIRST_FAULT]);
}

void test_a_flipped_bit_of_a_sealed_record_voids_it_and_its_counters(void)
{
    run(100);
    fail_now();
    run(600);
    (void)recorder_seal(&recorder);
    memory.fast[123].rotor ^= 0x10U;
    recorder_init(&recorder, &memory, &start);
    TEST_ASSERT_EQUAL_UINT8(RECORDER_RECORDING, memory.phase);
    TEST_ASSERT_EQUAL_UINT16(0, memory.counts[REASON_OVERCURRENT - REASON_FIRST_FAULT]);
}

void test_a_watchdog_reset_ends_the_recording_as_a_fault_of_the_program(void)
{
    run(100);
    const uint16_t last = (uint16_t)(periods - 1U);
    start.was_watchdog = true;
    recorder_init(&recorder, &memory, &start);
    TEST_ASSERT_EQUAL_UINT8(RECORDER_COMPLETE, memory.phase);
    TEST_ASSERT_EQUAL_UINT8(REASON_PROGRAM_FLOW, memory.reason);
    TEST_ASSERT_EQUAL_UINT8(1, memory.after_reset);
    TEST_ASSERT_EQUAL_UINT16(1, memory.counts[REASON_PROGRAM_FLOW - REASON_FIRST_FAULT]);
    run(10);
    const uint32_t latest = (memory.fast_next + RECORDER_FAST_ENTRIES - 1U) % RECORDER_FAST_ENTRIES;
    TEST_ASSERT_EQUAL_UINT16(last, memory.fast[latest].phase_code[0]);
}

void test_a_reset_between_fault_and_end_keeps_the_fault_s_reason(void)
{
    run(100);
    fail_now();
    run(100);
    recorder_init(&recorder, &memory, &start);
    TEST_ASSERT_EQUAL_UINT8(RECORDER_COMPLETE, memory.phase);
    TEST_ASSERT_EQUAL_UINT8(REASON_OVERCURRENT, memory.reason);
    TEST_ASSERT_EQUAL_UINT8(1, memory.after_reset);
}

void test_a_restart_on_purpose_records_anew_and_keeps_the_counters(void)
{
    memory.counts[3] = 7;
    memory.counts_check = ~UINT32_C(7);
    run(100);
    recorder_expect_restart(&recorder);
    start.was_watchdog = true; /* that is how the restart is made */
    recorder_init(&recorder, &memory, &start);
    TEST_ASSERT_EQUAL_UINT8(RECORDER_RECORDING, memory.phase);
    TEST_ASSERT_EQUAL_UINT16(7, memory.counts[3]);
}

void test_damaged_counters_begin_at_zero(void)
{
    memory.counts[3] = 7;
    recorder_init(&recorder, &memory, &start);
    TEST_ASSERT_EQUAL_UINT16(0, memory.counts[3]);
}

void test_indices_beyond_the_rings_void_the_memory(void)
{
    memory.fast_next = RECORDER_FAST_ENTRIES;
    recorder_init(&recorder, &memory, &start);
    TEST_ASSERT_EQUAL_UINT16(0, memory.fast_next);
    memory.slow_next = 60000;
    recorder_init(&recorder, &memory, &start);
    TEST_ASSERT_EQUAL_UINT16(0, memory.slow_next);
}

void test_large_values_saturate(void)
{
    output.speed_mrad_s = INT32_MAX;
    output.bus_current_mA = INT32_MIN;
    temperature.winding_cC = 29999;
    recorder_slow(&recorder, &output, &temperature);
    TEST_ASSERT_EQUAL_INT16(INT16_MAX, memory.slow[0].speed_dr_s);
    TEST_ASSERT_EQUAL_INT16(INT16_MIN, memory.slow[0].bus_dA);
    TEST_ASSERT_EQUAL_INT8(INT8_MAX, memory.slow[0].winding_C);
}

void test_a_board_without_such_memory_keeps_no_record(void)
{
    recorder_init(&recorder, NULL, &start);
    fail_now();
    run(1000);
    recorder_expect_restart(&recorder);
    TEST_ASSERT_FALSE(recorder_seal(&recorder));
}

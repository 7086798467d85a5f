/* SPDX-License-Identifier: Apache-2.0 */
/* The black box's memory: what a start finds in it, keeps or clears; its counters and units. */
#include <string.h>

#include "app/recorder.h"
#include "core/fault.h"
#include "unity.h"

enum { FIRST = REASON_FIRST_FAULT };

/* What follows the memory is not the recorder's. */
static struct {
    recorder_memory_t memory;
    uint8_t after[32];
} board;
#define memory board.memory

static recorder_t recorder;
static slow_output_t output;
static wheel_temperatures_t temperature;
static recorder_start_t start;

static void restart(bool was_watchdog)
{
    start.was_watchdog = was_watchdog;
    recorder_init(&recorder, &memory, &start);
}

void setUp(void)
{
    const slow_output_t calm = {.mode = MODE_RUN};
    const recorder_start_t usual = {.pwm_frequency_Hz = 20000, .config_crc32 = 0x12345678};
    output = calm;
    start = usual;
    memset(&temperature, 0, sizeof temperature);
    memset(&memory, 0xA5, sizeof memory);
    restart(false);
}

void tearDown(void) {}

static void slow_steps(int count)
{
    for (int n = 0; n < count; n++) {
        recorder_slow(&recorder, &output, &temperature);
    }
}

static void fault(int code)
{
    output.fault_reason = (reason_t)code;
    slow_steps(1);
    output.fault_reason = REASON_NONE;
    slow_steps(1);
}

/* A complete record of one fault, not yet sealed, whose last entries are at the rings' ends. */
static void complete(void)
{
    setUp();
    fault(FIRST + 3);
    slow_steps(RECORDER_SLOW_AFTER_ms);
    TEST_ASSERT_EQUAL_UINT8(RECORDER_COMPLETE, memory.phase);
    memory.fast_next = RECORDER_FAST_ENTRIES - 1;
    memory.slow_next = RECORDER_SLOW_ENTRIES - 1;
}

static uint32_t check_of_the_counters(void)
{
    uint32_t sum = 0;
    for (int k = 0; k < RECORDER_COUNTED; k++) {
        sum += memory.counts[k];
    }
    return UINT32_MAX - sum;
}

static void assert_begun_anew(void)
{
    TEST_ASSERT_EQUAL_UINT8(RECORDER_RECORDING, memory.phase);
    TEST_ASSERT_TRUE(recorder.takes_samples);
    TEST_ASSERT_EQUAL_UINT16(0, memory.counts[3]);
}

/* ---- start ---- */

void test_everything_but_the_head_of_a_new_recording_is_zero(void)
{
    TEST_ASSERT_EACH_EQUAL_UINT8(0, memory.fast, sizeof memory.fast);
    TEST_ASSERT_EACH_EQUAL_UINT8(0, memory.slow, sizeof memory.slow);
    TEST_ASSERT_EACH_EQUAL_UINT8(0, memory.counts, sizeof memory.counts);
    TEST_ASSERT_EQUAL_UINT8(0, memory.restart_expected);
    TEST_ASSERT_EQUAL_UINT16(0, memory.supply);
    TEST_ASSERT_EQUAL_UINT8(0, memory.started_by);
    TEST_ASSERT_EQUAL_UINT8(0, memory.ended_by);
    TEST_ASSERT_EQUAL_UINT32(0, memory.crc32);
    TEST_ASSERT_EQUAL_UINT32(0, memory.fault_ms);
    TEST_ASSERT_EQUAL_UINT16(0, memory.fast_next);
    TEST_ASSERT_EQUAL_UINT16(0, memory.slow_next);
    TEST_ASSERT_EQUAL_UINT8(REASON_NONE, memory.reason);
    TEST_ASSERT_EQUAL_UINT8(0, memory.after_reset);
    TEST_ASSERT_EQUAL_UINT32(UINT32_MAX, memory.counts_check);
}

void test_a_record_with_an_index_at_the_end_of_its_ring_is_kept(void)
{
    complete();
    restart(false);
    TEST_ASSERT_EQUAL_UINT8(RECORDER_COMPLETE, memory.phase);
    TEST_ASSERT_FALSE(recorder.takes_samples);
    TEST_ASSERT_EQUAL_UINT16(1, memory.counts[3]);
    TEST_ASSERT_EQUAL_UINT8(FIRST + 3, memory.reason);
}

void test_each_wrong_field_of_the_head_makes_the_memory_begin_anew(void)
{
    for (int field = 0; field < 6; field++) {
        complete();
        memory.magic ^= field == 0 ? 1U : 0U;
        memory.format = (uint16_t)(memory.format + (field == 1 ? 1 : 0));
        memory.size_bytes = (uint16_t)(memory.size_bytes - (field == 2 ? 1 : 0));
        memory.fast_next = field == 3 ? RECORDER_FAST_ENTRIES : memory.fast_next;
        memory.slow_next = field == 4 ? RECORDER_SLOW_ENTRIES : memory.slow_next;
        memory.phase = field == 5 ? RECORDER_SEALED + 1 : memory.phase;
        restart(false);
        assert_begun_anew();
    }
}

void test_foreign_memory_is_no_recording_that_was_interrupted(void)
{
    const recorder_phase_t phases[] = {RECORDER_RECORDING, RECORDER_ENDING};
    for (int k = 0; k < 2; k++) {
        complete();
        memory.magic++;
        memory.phase = (uint8_t)phases[k];
        restart(true);
        assert_begun_anew();
        TEST_ASSERT_EQUAL_UINT8(0, memory.after_reset);
    }
}

void test_a_restart_that_is_expected_takes_no_samples_and_begins_anew(void)
{
    recorder_expect_restart(&recorder);
    TEST_ASSERT_EQUAL_UINT8(1, memory.restart_expected);
    TEST_ASSERT_FALSE(recorder.takes_samples);
    restart(true);
    assert_begun_anew();
}

void test_a_restart_that_is_expected_keeps_a_complete_record(void)
{
    complete();
    recorder_expect_restart(&recorder);
    TEST_ASSERT_EQUAL_UINT8(RECORDER_COMPLETE, memory.phase);
}

void test_the_record_is_complete_after_its_time_and_not_before(void)
{
    output.fault_reason = REASON_OVERCURRENT;
    slow_steps(RECORDER_SLOW_AFTER_ms - 1);
    TEST_ASSERT_EQUAL_UINT8(RECORDER_ENDING, memory.phase);
    slow_steps(1);
    TEST_ASSERT_EQUAL_UINT8(RECORDER_COMPLETE, memory.phase);
}

/* ---- counters ---- */

/* By the layout: codes from the first fault on in their order, then five that are lower. */
static int counter_of(int code)
{
    static const int LOWER[] = {19, 26, 27, 28, 29};
    for (int k = 0; k < 5; k++) {
        if (code == LOWER[k]) {
            return 50 + k;
        }
    }
    return code >= FIRST && code < FIRST + 50 ? code - FIRST : -1;
}

static void assert_counted(int code, int times)
{
    for (int k = 0; k < RECORDER_COUNTED; k++) {
        TEST_ASSERT_EQUAL_UINT16(counter_of(code) == k ? times : 0, memory.counts[k]);
    }
    TEST_ASSERT_EQUAL_UINT32(check_of_the_counters(), memory.counts_check);
}

void test_codes_from_the_first_fault_on_are_counted_and_five_below(void)
{
    static recorder_memory_t before;
    for (int code = 1; code < FIRST + RECORDER_COUNTED + 2; code++) {
        setUp();
        before = memory;
        fault(code);
        assert_counted(code, 1);
        TEST_ASSERT_EQUAL_UINT32(before.magic, memory.magic);
        TEST_ASSERT_EQUAL_UINT32(before.config_crc32, memory.config_crc32);
        TEST_ASSERT_EQUAL_UINT32(before.pwm_frequency_Hz, memory.pwm_frequency_Hz);
    }
}

void test_every_fault_has_a_counter_of_its_own(void)
{
    reason_t reason = REASON_NONE;
    for (uint32_t place = 0; fault_listed(place, &reason); place++) {
        TEST_ASSERT_NOT_EQUAL_INT_MESSAGE(-1, counter_of((int)reason), reason_name(reason));
    }
    for (uint32_t k = 0; k < RECORDER_FIRST_START; k++) {
        TEST_ASSERT_EQUAL_INT(k, counter_of((int)recorder_counted(k)));
    }
}

static void warn(int code, int milliseconds)
{
    output.warning_reason = (reason_t)code;
    output.present_warning = (reason_t)code;
    slow_steps(milliseconds);
    output.warning_reason = REASON_NONE;
    output.present_warning = REASON_NONE;
}

void test_a_warning_is_counted_once_at_its_beginning_and_starts_no_record(void)
{
    reason_t reason = REASON_NONE;
    for (uint32_t place = 0; fault_listed(place, &reason); place++) {
        setUp();
        warn((int)reason, 1);
        assert_counted((int)reason, 1);
        warn((int)reason, 100000);
        assert_counted((int)reason, 1);
        TEST_ASSERT_EQUAL_UINT8(RECORDER_RECORDING, memory.phase);
        slow_steps(1000);
        warn((int)reason, 1);
        assert_counted((int)reason, 2);
        restart(false);
        assert_counted((int)reason, 2);
    }
}

void test_a_warning_counts_again_after_a_second_without_any_and_not_before(void)
{
    warn(REASON_ROTOR_FROZEN, 1);
    for (int n = 0; n < 100; n++) {
        slow_steps(999);
        warn(REASON_ROTOR_FROZEN, 1);
    }
    assert_counted(REASON_ROTOR_FROZEN, 1);
    slow_steps(500);
    warn(REASON_MAX_TORQUE, 1); /* another one, which has no counter, ends the calm as well */
    slow_steps(999);
    warn(REASON_ROTOR_FROZEN, 1);
    assert_counted(REASON_ROTOR_FROZEN, 1);
    slow_steps(1000);
    warn(REASON_ROTOR_FROZEN, 1);
    assert_counted(REASON_ROTOR_FROZEN, 2);
    slow_steps(5000);
    warn(REASON_ROTOR_FROZEN, 1);
    assert_counted(REASON_ROTOR_FROZEN, 3);
}

/* Two that hide each other by turns; every pair of bits. */
void test_warnings_by_turns_count_once_each(void)
{
    reason_t first = REASON_NONE;
    reason_t second = REASON_NONE;
    for (uint32_t i = 0; fault_listed(i, &first); i++) {
        for (uint32_t k = 0; k < i && fault_listed(k, &second); k++) {
            setUp();
            for (int n = 0; n < 3; n++) {
                warn((int)first, 1);
                warn((int)second, 1);
            }
            TEST_ASSERT_EQUAL_UINT16(1, memory.counts[counter_of((int)first)]);
            TEST_ASSERT_EQUAL_UINT16(1, memory.counts[counter_of((int)second)]);
        }
    }
}

void test_a_present_warning_is_counted_beside_a_latched_one(void)
{
    output.warning_reason = REASON_DEMAND_TIMEOUT;
    slow_steps(5);
    output.present_warning = REASON_CURRENT_SENSOR_A;
    slow_steps(5);
    TEST_ASSERT_EQUAL_UINT16(1, memory.counts[counter_of(REASON_DEMAND_TIMEOUT)]);
    TEST_ASSERT_EQUAL_UINT16(1, memory.counts[counter_of(REASON_CURRENT_SENSOR_A)]);
}

/* An open contactor before the vehicle is switched on is no fault of it. */
void test_warnings_are_counted_where_torque_may_be_enabled(void)
{
    for (operating_mode_t mode = MODE_BOOT; mode <= MODE_FAULT; mode++) {
        setUp();
        output.mode = mode;
        warn(REASON_BATTERY_DISCONNECTED, 10);
        assert_counted(REASON_BATTERY_DISCONNECTED, mode == MODE_RUN || mode == MODE_LIMP);
    }
}

void test_a_start_forgets_which_warnings_were_counted(void)
{
    warn(REASON_BUS_SENSOR, 1);
    memset(&recorder, 0xFF, sizeof recorder);
    restart(false);
    warn(REASON_BUS_SENSOR, 1);
    assert_counted(REASON_BUS_SENSOR, 2);
}

/* ---- starts ---- */

static void start_by(uint8_t cause)
{
    start.reset_cause = cause;
    restart(false);
}

void test_each_cause_of_a_start_has_a_counter_but_the_supply(void)
{
    for (unsigned cause = 0; cause < 256; cause++) {
        setUp();
        start_by((uint8_t)cause);
        start_by((uint8_t)cause);
        for (unsigned k = 0; k < RECORDER_COUNTED; k++) {
            const bool counted = cause > RECORDER_START_BY_SUPPLY && cause < RECORDER_STARTS;
            const bool its_own = counted && k == RECORDER_FIRST_START + cause;
            TEST_ASSERT_EQUAL_UINT16(its_own ? 2 : 0, memory.counts[k]);
        }
        TEST_ASSERT_EQUAL_UINT32(check_of_the_counters(), memory.counts_check);
        TEST_ASSERT_EQUAL_UINT8(cause, memory.started_by);
    }
}

void test_a_start_in_foreign_memory_is_counted_as_well(void)
{
    for (uint8_t expected = 0; expected < 2; expected++) {
        setUp();
        memory.magic++;
        memory.restart_expected = expected;
        start_by(3);
        TEST_ASSERT_EQUAL_UINT16(1, memory.counts[RECORDER_FIRST_START + 3]);
        TEST_ASSERT_EQUAL_UINT32(check_of_the_counters(), memory.counts_check);
    }
}

/* Its CRC is beside the counters, and no cause is counted in it. */
void test_a_start_beside_a_sealed_record_is_counted(void)
{
    complete();
    TEST_ASSERT_TRUE(recorder_seal(&recorder));
    TEST_ASSERT_NOT_EQUAL_UINT16(0, memory.crc32 & UINT16_MAX);
    const uint32_t crc32 = memory.crc32;
    start_by(3);
    TEST_ASSERT_EQUAL_UINT16(1, memory.counts[RECORDER_FIRST_START + 3]);
    TEST_ASSERT_EQUAL_UINT32(check_of_the_counters(), memory.counts_check);
    start_by(RECORDER_STARTS);
    TEST_ASSERT_EQUAL_UINT32(crc32, memory.crc32);
}

void test_a_start_writes_to_its_memory_only(void)
{
    memset(board.after, 0xA5, sizeof board.after);
    restart(false);
    memory.magic++;
    restart(false);
    TEST_ASSERT_EACH_EQUAL_UINT8(0xA5, board.after, sizeof board.after);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, recorder.fault_before);
}

void test_a_start_that_is_expected_is_not_counted_but_the_next_is(void)
{
    void (*const before[])(void) = {setUp, complete};
    for (int k = 0; k < 2; k++) {
        before[k]();
        recorder_expect_restart(&recorder);
        start_by(3);
        TEST_ASSERT_EQUAL_UINT16(0, memory.counts[RECORDER_FIRST_START + 3]);
        start_by(3);
        TEST_ASSERT_EQUAL_UINT16(1, memory.counts[RECORDER_FIRST_START + 3]);
    }
}

void test_a_start_does_not_mend_counters_that_are_wrong(void)
{
    complete();
    memory.counts_check ^= 1U;
    start_by(3);
    TEST_ASSERT_EQUAL_UINT16(0, memory.counts[RECORDER_FIRST_START + 3]);
    TEST_ASSERT_NOT_EQUAL_UINT32(check_of_the_counters(), memory.counts_check);
}

void test_a_record_names_the_start_before_it_and_the_one_that_ended_it(void)
{
    start_by(2);
    start.reset_cause = 4;
    restart(true);
    TEST_ASSERT_EQUAL_UINT8(RECORDER_COMPLETE, memory.phase);
    TEST_ASSERT_EQUAL_UINT8(2, memory.started_by);
    TEST_ASSERT_EQUAL_UINT8(4, memory.ended_by);
    start_by(3); /* a later one changes neither */
    TEST_ASSERT_EQUAL_UINT8(2, memory.started_by);
    TEST_ASSERT_EQUAL_UINT8(4, memory.ended_by);
    setUp();
    fault(FIRST + 3);
    start_by(3);
    TEST_ASSERT_EQUAL_UINT8(3, memory.ended_by);
}

void test_counters_saturate(void)
{
    memory.counts[3] = UINT16_MAX - 1;
    memory.counts_check = check_of_the_counters();
    fault(FIRST + 3);
    TEST_ASSERT_EQUAL_UINT16(UINT16_MAX, memory.counts[3]);
    TEST_ASSERT_EQUAL_UINT32(check_of_the_counters(), memory.counts_check);
    fault(FIRST + 3);
    TEST_ASSERT_EQUAL_UINT16(UINT16_MAX, memory.counts[3]);
}

void test_a_watchdog_s_reset_is_counted_only_with_counters_that_are_right(void)
{
    const int flow = REASON_PROGRAM_FLOW - FIRST;
    restart(true);
    TEST_ASSERT_EQUAL_UINT16(1, memory.counts[flow]);
    TEST_ASSERT_EQUAL_UINT8(1, memory.after_reset);
    setUp();
    memory.counts_check ^= 1U;
    restart(true);
    TEST_ASSERT_EQUAL_UINT16(0, memory.counts[flow]);
    TEST_ASSERT_EQUAL_UINT8(RECORDER_COMPLETE, memory.phase);
}

void test_a_reset_while_a_record_ends_is_no_fault_of_the_program(void)
{
    fault(FIRST + 3);
    TEST_ASSERT_EQUAL_UINT8(RECORDER_ENDING, memory.phase);
    restart(true);
    TEST_ASSERT_EQUAL_UINT8(RECORDER_COMPLETE, memory.phase);
    TEST_ASSERT_EQUAL_UINT8(FIRST + 3, memory.reason);
    TEST_ASSERT_EQUAL_UINT16(0, memory.counts[REASON_PROGRAM_FLOW - FIRST]);
}

/* ---- units ---- */

void test_each_quantity_of_a_slow_step_is_in_its_own_unit(void)
{
    output.speed_mrad_s = 1000000;
    output.motor_torque_command_mNm = -900000;
    output.motor_torque_estimate_mNm = 800000;
    output.hydraulic_torque_mNm = 700000;
    output.bus_voltage_mV = 600000;
    output.bus_current_mA = -500000;
    temperature.winding_cC = 12600;
    temperature.switch_cC = -9900;
    slow_steps(1);
    TEST_ASSERT_EQUAL_INT16(10000, memory.slow[0].speed_dr_s);
    TEST_ASSERT_EQUAL_INT16(-9000, memory.slow[0].torque_command_dNm);
    TEST_ASSERT_EQUAL_INT16(8000, memory.slow[0].torque_estimate_dNm);
    TEST_ASSERT_EQUAL_INT16(7000, memory.slow[0].hydraulic_dNm);
    TEST_ASSERT_EQUAL_INT16(6000, memory.slow[0].bus_dV);
    TEST_ASSERT_EQUAL_INT16(-5000, memory.slow[0].bus_dA);
    TEST_ASSERT_EQUAL_INT8(126, memory.slow[0].winding_C);
    TEST_ASSERT_EQUAL_INT8(-99, memory.slow[0].switch_C);
}

void test_quantities_saturate_at_both_ends(void)
{
    output.speed_mrad_s = INT32_MIN;
    output.bus_voltage_mV = INT32_MAX;
    temperature.winding_cC = INT16_MAX;
    temperature.switch_cC = INT16_MIN;
    slow_steps(1);
    TEST_ASSERT_EQUAL_INT16(INT16_MIN, memory.slow[0].speed_dr_s);
    TEST_ASSERT_EQUAL_INT16(INT16_MAX, memory.slow[0].bus_dV);
    TEST_ASSERT_EQUAL_INT8(INT8_MAX, memory.slow[0].winding_C);
    TEST_ASSERT_EQUAL_INT8(INT8_MIN, memory.slow[0].switch_C);
}

/* SPDX-License-Identifier: Apache-2.0 */
#include "app/recorder.h"

#include <stddef.h>

#include "config/validate.h"
#include "core/q15.h"

static uint32_t check_of_counts(const recorder_memory_t *memory)
{
    uint32_t sum = 0;
    for (int i = 0; i < RECORDER_COUNTED; i++) {
        sum += memory->counts[i];
    }
    return ~sum;
}

static uint32_t crc_of(const recorder_memory_t *memory)
{
    const size_t from = offsetof(recorder_memory_t, crc32) + sizeof memory->crc32;
    return config_crc32((const uint8_t *)memory + from, (uint32_t)(sizeof *memory - from));
}

static bool is_ours(const recorder_memory_t *memory)
{
    return memory->magic == RECORDER_MAGIC && memory->format == RECORDER_FORMAT &&
           memory->size_bytes == sizeof *memory && memory->fast_next < RECORDER_FAST_ENTRIES &&
           memory->slow_next < RECORDER_SLOW_ENTRIES && memory->phase <= RECORDER_SEALED &&
           (memory->phase != RECORDER_SEALED || memory->crc32 == crc_of(memory));
}

/* Zero but for the counters. */
static void begin(recorder_memory_t *memory, const recorder_start_t *start, bool keep_counts)
{
    const recorder_fast_t no_sample = {.rotor = 0};
    const recorder_slow_t no_step = {.mode = 0};
    for (int i = 0; i < RECORDER_FAST_ENTRIES; i++) {
        memory->fast[i] = no_sample;
    }
    for (int i = 0; i < RECORDER_SLOW_ENTRIES; i++) {
        memory->slow[i] = no_step;
    }
    for (int i = 0; i < RECORDER_COUNTED && !keep_counts; i++) {
        memory->counts[i] = 0;
    }
    memory->format = RECORDER_FORMAT;
    memory->size_bytes = (uint16_t)sizeof *memory;
    memory->pwm_frequency_Hz = start->pwm_frequency_Hz;
    memory->config_crc32 = start->config_crc32;
    memory->fault_ms = 0;
    memory->fast_next = 0;
    memory->slow_next = 0;
    memory->phase = RECORDER_RECORDING;
    memory->reason = REASON_NONE;
    memory->after_reset = 0;
    memory->restart_expected = 0;
    if (!keep_counts) {
        memory->supply = 0;
    }
    memory->started_by = start->reset_cause;
    memory->ended_by = 0;
    memory->crc32 = 0;
    memory->counts_check = check_of_counts(memory);
    memory->magic = RECORDER_MAGIC;
}

/* The first counter of starts, that of an unknown cause, stands for no counter. */
static void count(recorder_memory_t *memory, uint32_t index)
{
    if (index != RECORDER_FIRST_START && memory->counts[index] < UINT16_MAX) {
        memory->counts[index]++;
        memory->counts_check--; /* its inverted sum */
    }
}

/* Rows of the list of faults below the first fault: one, and LOW_CODES in a row. */
enum { LOW_CODES = 4, FIRST_LOW_CODE = REASON_HYDRAULIC_FEEDBACK };
_Static_assert(RECORDER_FIRST_LOW + 1 + LOW_CODES == RECORDER_FIRST_START &&
                   (int)REASON_OFFSETS_STORED == FIRST_LOW_CODE + LOW_CODES - 1,
               "a counter for each");

reason_t recorder_counted(uint32_t index)
{
    return index < RECORDER_FIRST_LOW ? (reason_t)(RECORDER_FIRST_COUNTED + index)
           : index == RECORDER_FIRST_LOW
               ? REASON_ROTOR_UNCERTAIN
               : (reason_t)(FIRST_LOW_CODE + index - RECORDER_FIRST_LOW - 1U);
}

static uint32_t counter_of(reason_t reason)
{
    const uint32_t above = (uint32_t)reason - RECORDER_FIRST_COUNTED;
    const uint32_t low = (uint32_t)reason - FIRST_LOW_CODE;
    return above < RECORDER_FIRST_LOW         ? above
           : low < LOW_CODES                  ? RECORDER_FIRST_LOW + 1U + low
           : reason == REASON_ROTOR_UNCERTAIN ? (uint32_t)RECORDER_FIRST_LOW
                                              : (uint32_t)RECORDER_FIRST_START;
}

static void count_warning(recorder_t *recorder, reason_t reason)
{
    const uint32_t index = counter_of(reason);
    const uint32_t word = index / 32U;
    const uint32_t bit = UINT32_C(1) << index % 32U;
    if ((recorder->warned[word] & bit) == 0) {
        recorder->warned[word] |= bit;
        count(recorder->memory, index);
    }
}

/* A latched warning may hide a present one. */
static void count_warnings(recorder_t *recorder, const slow_output_t *output)
{
    if (output->warning_reason == REASON_NONE) {
        recorder->calm_ms++;
        if (recorder->calm_ms >= RECORDER_CALM_ms) {
            recorder->warned[0] = 0;
            recorder->warned[1] = 0;
        }
        return;
    }
    recorder->calm_ms = 0;
    if (output->mode == MODE_RUN || output->mode == MODE_LIMP) {
        count_warning(recorder, output->warning_reason);
        count_warning(recorder, output->present_warning);
    }
}

static void count_start(recorder_memory_t *memory, uint32_t cause)
{
    if (cause > RECORDER_START_BY_SUPPLY && cause < RECORDER_STARTS) {
        count(memory, RECORDER_FIRST_START + cause);
    }
}

void recorder_init(recorder_t *recorder, recorder_memory_t *memory, const recorder_start_t *start)
{
    const recorder_t fresh = {.memory = memory, .fault_before = REASON_NONE};
    *recorder = fresh;
    if (memory == NULL) {
        return;
    }
    const bool ours = is_ours(memory);
    const bool keep_counts = ours && memory->counts_check == check_of_counts(memory);
    const bool expected = ours && memory->restart_expected != 0;
    const bool interrupted = ours && memory->phase == RECORDER_RECORDING && start->was_watchdog;
    if (interrupted || (ours && memory->phase == RECORDER_ENDING)) {
        memory->reason = interrupted ? (uint8_t)REASON_PROGRAM_FLOW : memory->reason;
        memory->after_reset = 1;
        memory->ended_by = start->reset_cause;
        memory->phase = RECORDER_COMPLETE;
        if (interrupted && keep_counts) {
            count(memory, counter_of(REASON_PROGRAM_FLOW));
        }
    } else if (!ours || memory->phase <= RECORDER_RECORDING) {
        begin(memory, start, keep_counts);
        recorder->takes_samples = true;
    }
    memory->restart_expected = 0;
    if (!expected && memory->counts_check == check_of_counts(memory)) {
        count_start(memory, start->reset_cause);
    }
}

void recorder_expect_restart(recorder_t *recorder)
{
    if (recorder->memory == NULL) {
        return;
    }
    recorder->memory->restart_expected = 1;
    if (recorder->memory->phase == RECORDER_RECORDING) {
        recorder->takes_samples = false;
        recorder->memory->phase = RECORDER_EMPTY;
    }
}

/* value / unit in 16 bits, rounded towards zero. */
static int16_t in_units(int32_t value, int32_t unit)
{
    return (int16_t)q_clamp(value / unit, INT16_MIN, INT16_MAX);
}

static int8_t degrees(int32_t temperature_cC)
{
    return (int8_t)q_clamp(temperature_cC / 100, INT8_MIN, INT8_MAX);
}

static recorder_slow_t entry_of(const slow_output_t *output,
                                const wheel_temperatures_t *temperature)
{
    const bool fault = output->fault_reason != REASON_NONE;
    const recorder_slow_t out = {
        .speed_dr_s = in_units(output->speed_mrad_s, 100),
        .torque_command_dNm = in_units(output->motor_torque_command_mNm, 100),
        .torque_estimate_dNm = in_units(output->motor_torque_estimate_mNm, 100),
        .hydraulic_dNm = in_units(output->hydraulic_torque_mNm, 100),
        .bus_dV = in_units(output->bus_voltage_mV, 100),
        .bus_dA = in_units(output->bus_current_mA, 100),
        .winding_C = degrees(temperature->winding_cC),
        .switch_C = degrees(temperature->switch_cC),
        .mode = (uint8_t)output->mode,
        .reason = (uint8_t)(fault ? output->fault_reason : output->torque_reason),
    };
    return out;
}

static void end_when_due(recorder_t *recorder)
{
    recorder_memory_t *memory = recorder->memory;
    recorder->slow_left_ms--;
    if (recorder->slow_left_ms == RECORDER_SLOW_AFTER_ms - RECORDER_FAST_AFTER_ms) {
        recorder->takes_samples = false;
    }
    if (recorder->slow_left_ms == 0) {
        memory->phase = RECORDER_COMPLETE;
    }
}

void recorder_slow(recorder_t *recorder, const slow_output_t *output,
                   const wheel_temperatures_t *temperature)
{
    recorder_memory_t *memory = recorder->memory;
    if (memory == NULL) {
        return;
    }
    const uint32_t now_ms = recorder->now_ms++;
    const reason_t fault = output->fault_reason;
    const bool new_fault = fault != REASON_NONE && fault != recorder->fault_before;
    recorder->fault_before = fault;
    if (new_fault) {
        count(memory, counter_of(fault));
    }
    count_warnings(recorder, output);
    if (memory->phase == RECORDER_RECORDING && new_fault) {
        memory->fault_ms = now_ms;
        memory->reason = (uint8_t)fault;
        memory->phase = RECORDER_ENDING;
        recorder->slow_left_ms = RECORDER_SLOW_AFTER_ms;
    }
    if (memory->phase != RECORDER_RECORDING && memory->phase != RECORDER_ENDING) {
        return;
    }
    if (now_ms % RECORDER_SLOW_PERIOD_ms == 0) {
        const uint32_t next = memory->slow_next;
        memory->slow[next] = entry_of(output, temperature);
        memory->slow_next = (uint16_t)(next + 1U < RECORDER_SLOW_ENTRIES ? next + 1U : 0U);
    }
    if (memory->phase == RECORDER_ENDING) {
        end_when_due(recorder);
    }
}

bool recorder_seal(recorder_t *recorder)
{
    recorder_memory_t *memory = recorder->memory;
    if (memory == NULL || memory->phase != RECORDER_COMPLETE) {
        return false;
    }
    memory->phase = RECORDER_SEALED;
    memory->crc32 = crc_of(memory);
    return true;
}

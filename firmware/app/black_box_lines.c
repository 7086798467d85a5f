/* SPDX-License-Identifier: Apache-2.0 */
#include <stddef.h>

#include "app/report.h"
#include "core/fault.h"

enum { BYTES_A_LINE = 32 };

static const char *phase_text(uint8_t phase)
{
    switch ((recorder_phase_t)phase) {
    case RECORDER_RECORDING:
        return "recording, no fault yet";
    case RECORDER_ENDING:
        return "fault, recording what follows: ";
    case RECORDER_COMPLETE:
    case RECORDER_SEALED:
        return "record of ";
    case RECORDER_EMPTY:
        break;
    }
    return "empty";
}

_Static_assert((int)RESET_CAUSES == RECORDER_STARTS && (int)RESET_POWER == RECORDER_START_BY_SUPPLY,
               "the same numbers");

static void add_start(uint32_t cause, text_t *line)
{
    report_start(cause < RESET_CAUSES ? (reset_cause_t)cause : RESET_UNKNOWN, line);
}

static void add_heading(const recorder_memory_t *box, text_t *line)
{
    text_add(line, "black box: ");
    text_add(line, phase_text(box->phase));
    if (box->phase >= RECORDER_ENDING) {
        text_add_integer(line, box->reason);
        text_add(line, " ");
        text_add(line, reason_text((reason_t)box->reason));
        text_add(line, ", ");
        text_add_integer(line, (int32_t)(box->fault_ms & (uint32_t)INT32_MAX));
        text_add(line, " ms after the start");
        text_add(line, box->after_reset != 0 ? ", ended by a reset" : "");
        if (box->ended_by != RESET_UNKNOWN) {
            text_add(line, ", then ");
            add_start(box->ended_by, line);
        }
    }
}

/* The counter that is the `left`th not to be zero; then `left` is zero. */
static bool add_count(const report_status_t *status, uint32_t *left, text_t *line)
{
    const recorder_memory_t *box = status->black_box;
    for (uint32_t i = 0; i < RECORDER_COUNTED; i++) {
        const uint32_t total = fault_journal_total(status->journal, box, i);
        if (total == 0) {
            continue;
        }
        if (*left == 0) {
            text_add_integer(line, box->counts[i]);
            text_add(line, " times ");
            if (i < RECORDER_FIRST_START) {
                text_add(line, reason_text(recorder_counted(i)));
            } else {
                add_start(i - RECORDER_FIRST_START, line);
            }
            text_add(line, ", since production ");
            text_add_integer(line, (int32_t)total);
            return true;
        }
        (*left)--;
    }
    return false;
}

static void add_digits(text_t *line, uint32_t value, uint32_t digits)
{
    for (uint32_t shift = 4U * digits; shift > 0; shift -= 4U) {
        const char digit[2] = {"0123456789ABCDEF"[(value >> (shift - 4U)) & 0xFU], '\0'};
        text_add(line, digit);
    }
}

static bool add_bytes(const recorder_memory_t *box, uint32_t number, text_t *line)
{
    const uint8_t *bytes = (const uint8_t *)box;
    const uint32_t from = number * BYTES_A_LINE;
    if (box->phase < RECORDER_COMPLETE || from >= sizeof *box) {
        return false;
    }
    add_digits(line, from, 4);
    text_add(line, ": ");
    for (uint32_t i = from; i < from + BYTES_A_LINE && i < sizeof *box; i++) {
        add_digits(line, bytes[i], 2);
    }
    return true;
}

bool report_black_box(const report_status_t *status, uint32_t number, text_t *line)
{
    if (status->black_box == NULL) {
        text_add(line, "no black box: no control, or no memory that a reset keeps");
        return number == 0;
    }
    if (number == 0) {
        add_heading(status->black_box, line);
        return true;
    }
    uint32_t left = number - 1U;
    return add_count(status, &left, line) || add_bytes(status->black_box, left, line);
}

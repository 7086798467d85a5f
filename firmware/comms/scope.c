/* SPDX-License-Identifier: Apache-2.0 */
#include "comms/scope.h"

#include <stddef.h>

#include "comms/daq.h"

enum {
    READ_ONLY = offsetof(scope_page_t, phase) / sizeof(int32_t),
    RUN = offsetof(scope_page_t, run) / sizeof(int32_t),
    TRIGGER = SCOPE_CHANNELS, /* its place among those of the channels */
    NO_SIGNAL = -1,
    Q16 = 16
};

void scope_init(scope_t *scope, void *memory, uint32_t bytes, uint32_t pwm_frequency_Hz)
{
    static const scope_page_t NO_RECORD = {.periods = 1};
    scope->page = NO_RECORD;
    scope->page.memory_bytes = (int32_t)bytes;
    scope->memory = memory;
    scope->channels = 0;
    scope->rows = 0;
    scope->phase = SCOPE_OFF;
    scope->lost = false;
    scope->written_rows = 0;
    scope->read_rows = 0;
    scope->time_q16 = 0;
    scope->period_q16 = (uint32_t)((UINT64_C(1000000) << Q16) / DAQ_TICK_us / pwm_frequency_Hz);
    for (uint32_t i = 0; i < SCOPE_CHANNELS; i++) {
        scope->page.signal[i] = NO_SIGNAL;
    }
}

static uint8_t *row_at(const scope_t *scope, uint32_t row)
{
    const uint32_t at = row * (uint32_t)scope->page.row_bytes;
    return &scope->memory[at];
}

const scope_page_t *scope_page(scope_t *scope)
{
    scope->page.phase = scope->phase;
    scope->page.run = scope_runs(scope) && scope->phase != SCOPE_STREAMS;
    return &scope->page;
}

uint32_t scope_record_bytes(const scope_t *scope)
{
    return scope->phase == SCOPE_COMPLETE ? scope->rows * (uint32_t)scope->page.row_bytes : 0U;
}

/* Fast signals are read where they are, those of the slow step where scope_slow_step() puts them.
 */
static scope_channel_t channel_of(scope_t *scope, const xcp_table_t *table, uint32_t k,
                                  int32_t place)
{
    const xcp_signal_t *signal = &table->signals[place];
    const bool fast = xcp_signal_is_fast(signal);
    const scope_channel_t channel = {
        .at = fast ? xcp_signal_at(table, (uint32_t)place) : &scope->of_slow_step[k],
        .at_bytes = fast ? signal->size_bytes : (uint8_t)sizeof scope->of_slow_step[k],
        .row_bytes = signal->size_bytes,
    };
    scope->place[k] = fast ? NO_SIGNAL : place;
    scope->of_slow_step[k] = xcp_signal_value(table, (uint32_t)place);
    return channel;
}

static bool is_place(const xcp_table_t *table, int32_t place)
{
    return place >= 0 && (uint32_t)place < table->signals_count;
}

static uint32_t add_channels(scope_t *scope, const xcp_table_t *table,
                             const scope_entry_t entry[SCOPE_CHANNELS])
{
    uint32_t bytes = 0;
    scope->channels = 0;
    for (uint32_t i = 0; i < SCOPE_CHANNELS; i++) {
        if (entry[i].bytes > 0) {
            const uint32_t k = scope->channels;
            scope->channel[k] = channel_of(scope, table, k, entry[i].place);
            scope->channel[k].row_bytes = entry[i].bytes;
            bytes += entry[i].bytes;
            scope->channels++;
        }
    }
    for (uint32_t k = scope->channels; k <= TRIGGER; k++) {
        scope->place[k] = NO_SIGNAL;
    }
    return bytes;
}

static void begin(scope_t *scope, uint32_t rows, uint32_t periods, scope_phase_t phase)
{
    scope->rows = rows;
    scope->periods = periods;
    scope->periods_left = 1;
    scope->next_row = 0;
    scope->taken = 0;
    scope->finding_came = false;
    scope->finding_present = true; /* what is there already does not appear */
    scope->written_rows = 0;
    scope->read_rows = 0;
    scope->lost = false;
    scope->phase = (uint8_t)phase;
}

static bool needs_signal(int32_t trigger)
{
    return trigger >= SCOPE_ABOVE && trigger <= SCOPE_FALLS;
}

static xcp_error_t arm(scope_t *scope, const xcp_table_t *table)
{
    scope_page_t *page = &scope->page;
    scope_entry_t entry[SCOPE_CHANNELS];
    for (uint32_t i = 0; i < SCOPE_CHANNELS; i++) {
        const bool wanted = is_place(table, page->signal[i]);
        entry[i].place = wanted ? (uint8_t)page->signal[i] : 0U;
        entry[i].bytes = wanted ? table->signals[page->signal[i]].size_bytes : 0U;
    }
    const uint32_t bytes = add_channels(scope, table, entry);
    uint32_t layout = 0;
    for (uint32_t i = 0; i < SCOPE_CHANNELS; i++) {
        layout |= (uint32_t)entry[i].bytes << 4U * i;
    }
    const uint32_t most = bytes == 0 ? 0U : (uint32_t)page->memory_bytes / bytes;
    const uint32_t rows = page->rows == 0 ? most : (uint32_t)page->rows;
    if (rows == 0 || rows > most || (uint32_t)page->before_rows >= rows ||
        (needs_signal(page->trigger) && !is_place(table, page->trigger_signal))) {
        return XCP_ERROR_OUT_OF_RANGE;
    }
    if (needs_signal(page->trigger)) {
        scope->trigger = channel_of(scope, table, TRIGGER, page->trigger_signal);
    }
    page->row_bytes = (int32_t)bytes;
    page->row_layout = (int32_t)layout;
    page->record_rows = (int32_t)rows;
    page->first_row = 0;
    scope->before_rows = (uint32_t)page->before_rows;
    begin(scope, rows, (uint32_t)page->periods, SCOPE_ARMED);
    return XCP_ERROR_NONE;
}

static bool is_in_range(const xcp_table_t *table, uint32_t word, int32_t value)
{
    switch (word) {
    case offsetof(scope_page_t, trigger) / sizeof(int32_t):
        return value >= SCOPE_NO_TRIGGER && value < SCOPE_TRIGGERS;
    case offsetof(scope_page_t, trigger_signal) / sizeof(int32_t):
        return is_place(table, value);
    case offsetof(scope_page_t, level) / sizeof(int32_t):
        return true;
    case offsetof(scope_page_t, before_rows) / sizeof(int32_t):
    case offsetof(scope_page_t, rows) / sizeof(int32_t):
        return value >= 0;
    case offsetof(scope_page_t, periods) / sizeof(int32_t):
        return value >= 1 && value <= SCOPE_PERIODS_MOST;
    case RUN:
        return value == 0 || value == 1;
    default:
        return value == NO_SIGNAL || is_place(table, value);
    }
}

xcp_error_t scope_write(scope_t *scope, const xcp_table_t *table, uint32_t word, int32_t value)
{
    if (word >= READ_ONLY || scope->page.memory_bytes == 0) {
        return XCP_ERROR_WRITE_PROTECTED;
    }
    if (!is_in_range(table, word, value)) {
        return XCP_ERROR_OUT_OF_RANGE;
    }
    if (scope->phase == SCOPE_STREAMS || (scope_runs(scope) && !(word == RUN && value == 0))) {
        return XCP_ERROR_NOT_ACCESSIBLE_NOW;
    }
    if (word == RUN) {
        scope->phase = SCOPE_OFF;
        return value == 1 ? arm(scope, table) : XCP_ERROR_NONE;
    }
    ((int32_t *)&scope->page)[word] = value;
    return XCP_ERROR_NONE;
}

xcp_error_t scope_start_stream(scope_t *scope, const xcp_table_t *table,
                               const scope_entry_t entry[SCOPE_CHANNELS], uint32_t periods,
                               uint32_t time_ticks)
{
    if (scope_runs(scope) || scope->page.memory_bytes == 0) {
        return XCP_ERROR_NOT_ACCESSIBLE_NOW;
    }
    scope->phase = SCOPE_OFF;
    const uint32_t bytes = SCOPE_TIME_BYTES + add_channels(scope, table, entry);
    scope->page.row_bytes = (int32_t)bytes;
    scope->time_q16 = time_ticks << Q16;
    begin(scope, (uint32_t)scope->page.memory_bytes / bytes, periods, SCOPE_STREAMS);
    return XCP_ERROR_NONE;
}

uint32_t scope_next_row(const scope_t *scope, uint8_t *to)
{
    const uint32_t read = scope->read_rows;
    if (scope->phase != SCOPE_STREAMS || read == scope->written_rows) {
        return 0;
    }
    const uint32_t bytes = (uint32_t)scope->page.row_bytes;
    const uint8_t *row = row_at(scope, read % scope->rows);
    for (uint32_t i = 0; i < bytes; i++) {
        to[i] = row[i];
    }
    return bytes;
}

void scope_row_taken(scope_t *scope)
{
    const uint32_t next = scope->read_rows + 1U;
    scope->read_rows = next == 2U * scope->rows ? 0U : next;
}

void scope_stop(scope_t *scope)
{
    if (scope_runs(scope)) {
        scope->phase = SCOPE_OFF;
    }
}

static bool is_found(const findings_t *findings, int32_t reason)
{
    bool found = false;
    for (finding_t row = (finding_t)0; row < FINDING_COUNT; row++) {
        const reason_t own = row == FINDING_TRIP ? findings->trip : findings_reason(findings, row);
        found = found || (findings_present(findings, row) &&
                          (reason == REASON_NONE || (int32_t)own == reason));
    }
    return found;
}

void scope_slow_step(scope_t *scope, const xcp_table_t *table, const findings_t *findings)
{
    for (uint32_t k = 0; k <= TRIGGER; k++) {
        if (scope->place[k] != NO_SIGNAL) {
            scope->of_slow_step[k] = xcp_signal_value(table, (uint32_t)scope->place[k]);
        }
    }
    if (scope->phase == SCOPE_ARMED && scope->page.trigger == SCOPE_FINDING) {
        const bool present = is_found(findings, scope->page.level);
        scope->finding_came = scope->finding_came || (present && !scope->finding_present);
        scope->finding_present = present;
    }
}

static void put_row(const scope_t *scope, uint8_t *to)
{
    for (uint32_t k = 0; k < scope->channels; k++) {
        const scope_channel_t *channel = &scope->channel[k];
        xcp_put(to, xcp_load(channel->at, channel->at_bytes), channel->row_bytes);
        to += channel->row_bytes;
    }
}

/* Of the row that has just been taken. */
static bool is_triggered(scope_t *scope)
{
    const scope_page_t *page = &scope->page;
    if (page->trigger == SCOPE_NO_TRIGGER || page->trigger == SCOPE_FINDING) {
        return page->trigger == SCOPE_NO_TRIGGER || scope->finding_came;
    }
    const int32_t value = (int32_t)xcp_load(scope->trigger.at, scope->trigger.at_bytes);
    const int32_t before = scope->taken == 0 ? value : scope->value_before;
    scope->value_before = value;
    switch (page->trigger) {
    case SCOPE_ABOVE:
        return value >= page->level;
    case SCOPE_BELOW:
        return value <= page->level;
    case SCOPE_RISES:
        return value >= page->level && before < page->level;
    default: /* SCOPE_FALLS */
        return value <= page->level && before > page->level;
    }
}

static void record_row(scope_t *scope)
{
    const bool triggered = is_triggered(scope);
    put_row(scope, row_at(scope, scope->next_row));
    scope->next_row = scope->next_row + 1U < scope->rows ? scope->next_row + 1U : 0U;
    if (scope->phase == SCOPE_TRIGGERED) {
        scope->left_rows--;
    } else if (triggered && scope->taken >= scope->before_rows) {
        scope->left_rows = scope->rows - scope->before_rows - 1U;
        scope->phase = SCOPE_TRIGGERED;
    }
    scope->taken += scope->taken <= scope->before_rows ? 1U : 0U;
    if (scope->phase == SCOPE_TRIGGERED && scope->left_rows == 0) {
        scope->page.first_row = (int32_t)scope->next_row;
        scope->phase = SCOPE_COMPLETE;
    }
}

/* The counts of rows run to twice the ring, so that a full one is not an empty one. */
static void stream_row(scope_t *scope)
{
    const uint32_t written = scope->written_rows;
    const uint32_t read = scope->read_rows;
    const uint32_t waiting = written >= read ? written - read : written + 2U * scope->rows - read;
    if (waiting >= scope->rows) {
        scope->lost = true;
        return;
    }
    uint8_t *row = row_at(scope, written % scope->rows);
    xcp_put(row, scope->time_q16 >> Q16, SCOPE_TIME_BYTES);
    put_row(scope, row + SCOPE_TIME_BYTES);
    scope->written_rows = written + 1U == 2U * scope->rows ? 0U : written + 1U;
}

void scope_fast_step(scope_t *scope)
{
    scope->time_q16 += scope->period_q16;
    scope->periods_left--;
    if (scope->periods_left > 0) {
        return;
    }
    scope->periods_left = scope->periods;
    if (scope->phase == SCOPE_STREAMS) {
        stream_row(scope);
    } else if (scope_runs(scope)) {
        record_row(scope);
    }
}

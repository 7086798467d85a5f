/* SPDX-License-Identifier: Apache-2.0 */
#include "comms/daq.h"

static const struct {
    uint8_t first, count;
} ODTS[DAQ_LISTS] = {{0, DAQ_SLOW_ODTS}, {DAQ_FAST_ODT, 1}};

uint32_t daq_first_odt(daq_list_t list)
{
    return ODTS[list].first;
}

uint32_t daq_odts(daq_list_t list)
{
    return ODTS[list].count;
}

void daq_clear(daq_t *daq, daq_list_t list)
{
    static const scope_entry_t NONE = {0, 0};
    for (uint32_t odt = 0; odt < ODTS[list].count; odt++) {
        for (uint32_t k = 0; k < DAQ_ENTRIES; k++) {
            daq->entry[ODTS[list].first + odt][k] = NONE;
        }
    }
    daq->prescaler[list] = 1;
    daq->selected[list] = false;
}

void daq_init(daq_t *daq)
{
    for (uint32_t list = 0; list < DAQ_LISTS; list++) {
        daq_clear(daq, (daq_list_t)list);
        daq->running[list] = false;
    }
    daq->packets_a_ms = 0;
    daq->countdown = 1;
    daq->lost = false;
    daq->slow_steps = 0;
    daq->written = 0;
    daq->released = 0;
    daq->read = 0;
    daq->next_is_fast = false;
}

/* Of the signals of an ODT. */
static uint32_t bytes_of(const daq_t *daq, uint32_t odt)
{
    uint32_t bytes = 0;
    for (uint32_t k = 0; k < DAQ_ENTRIES; k++) {
        bytes += daq->entry[odt][k].bytes;
    }
    return bytes;
}

static bool has_time(uint32_t odt)
{
    return odt == ODTS[DAQ_LIST_SLOW].first || odt == ODTS[DAQ_LIST_FAST].first;
}

static uint32_t head_bytes(uint32_t odt)
{
    return has_time(odt) ? 1U + DAQ_TIME_BYTES : 1U;
}

xcp_error_t daq_write(daq_t *daq, const daq_line_t *line, uint32_t odt, uint32_t entry,
                      scope_entry_t what)
{
    const scope_entry_t before = daq->entry[odt][entry];
    daq->entry[odt][entry] = what;
    if (head_bytes(odt) + bytes_of(daq, odt) > line->packet_bytes) {
        daq->entry[odt][entry] = before;
        return XCP_ERROR_DAQ_CONFIG;
    }
    return XCP_ERROR_NONE;
}

/* Packets of a sample of the slow list. The first ODT is sent for its time, too. */
static uint32_t packets_of(const daq_t *daq)
{
    uint32_t packets = 0;
    for (uint32_t odt = 0; odt < DAQ_SLOW_ODTS; odt++) {
        packets += bytes_of(daq, odt) > 0 ? 1U : 0U;
    }
    return packets + (bytes_of(daq, 0) == 0 ? 1U : 0U);
}

static bool fits(const daq_t *daq, const daq_line_t *line, daq_list_t list)
{
    bool fits = list == DAQ_LIST_FAST
                    ? line->carries_fast_list
                    : packets_of(daq) <= (uint32_t)daq->prescaler[list] * line->packets_a_ms;
    uint32_t bytes = 0;
    for (uint32_t k = 0; k < ODTS[list].count; k++) {
        const uint32_t odt = ODTS[list].first + k;
        fits = fits && head_bytes(odt) + bytes_of(daq, odt) <= line->packet_bytes;
        bytes += bytes_of(daq, odt);
    }
    return fits && bytes > 0;
}

xcp_error_t daq_start(daq_t *daq, const daq_line_t *line, const xcp_table_t *table, scope_t *scope,
                      daq_list_t list, uint16_t slow_steps)
{
    if (daq->running[list]) {
        return XCP_ERROR_NONE;
    }
    if (!fits(daq, line, list)) {
        return XCP_ERROR_DAQ_CONFIG;
    }
    if (list == DAQ_LIST_FAST) {
        const xcp_error_t error =
            scope_start_stream(scope, table, daq->entry[DAQ_FAST_ODT], daq->prescaler[list],
                               (uint32_t)slow_steps * DAQ_SLOW_STEP_ticks);
        if (error != XCP_ERROR_NONE) {
            return error;
        }
    } else {
        daq->packets_a_ms = line->packets_a_ms;
        daq->countdown = 1;
        daq->lost = false;
        daq->read = daq->written;
        daq->released = daq->written;
    }
    daq->selected[list] = false;
    daq->running[list] = true;
    return XCP_ERROR_NONE;
}

void daq_stop(daq_t *daq, scope_t *scope, daq_list_t list)
{
    if (list == DAQ_LIST_FAST && daq->running[list]) {
        scope_stop(scope);
    }
    daq->running[list] = false;
    daq->selected[list] = false;
    if (list == DAQ_LIST_SLOW) {
        daq->read = daq->written;
        daq->released = daq->written;
    }
}

static uint8_t after(uint8_t place, uint32_t steps)
{
    return (uint8_t)((place + steps) % DAQ_QUEUE);
}

static uint32_t between(uint8_t from, uint8_t to)
{
    return ((uint32_t)to + DAQ_QUEUE - from) % DAQ_QUEUE;
}

static void put_packet(daq_t *daq, const xcp_table_t *table, uint32_t odt)
{
    daq_packet_t *packet = &daq->queue[daq->written];
    uint8_t *to = packet->bytes;
    *to++ = (uint8_t)(odt | (daq->lost ? (uint32_t)DAQ_OVERLOAD : 0U));
    daq->lost = false;
    if (has_time(odt)) {
        xcp_put(to, (uint32_t)daq->slow_steps * DAQ_SLOW_STEP_ticks, DAQ_TIME_BYTES);
        to += DAQ_TIME_BYTES;
    }
    for (uint32_t k = 0; k < DAQ_ENTRIES; k++) {
        const scope_entry_t *entry = &daq->entry[odt][k];
        if (entry->bytes > 0) {
            xcp_put(to, xcp_signal_value(table, entry->place), entry->bytes);
            to += entry->bytes;
        }
    }
    packet->length = (uint8_t)(to - packet->bytes);
    daq->written = after(daq->written, 1);
}

static void sample(daq_t *daq, const xcp_table_t *table)
{
    if (DAQ_QUEUE - 1U - between(daq->read, daq->written) < packets_of(daq)) {
        daq->lost = true;
        return;
    }
    for (uint32_t odt = 0; odt < DAQ_SLOW_ODTS; odt++) {
        if (odt == 0 || bytes_of(daq, odt) > 0) {
            put_packet(daq, table, odt);
        }
    }
}

void daq_slow_step(daq_t *daq, const xcp_table_t *table, uint16_t slow_steps)
{
    daq->slow_steps = slow_steps;
    daq->countdown--;
    if (daq->countdown == 0) {
        daq->countdown = daq->prescaler[DAQ_LIST_SLOW];
        sample(daq, table);
    }
    const uint32_t waiting = between(daq->released, daq->written);
    daq->released = after(daq->released, waiting < daq->packets_a_ms ? waiting : daq->packets_a_ms);
}

uint32_t daq_next(daq_t *daq, scope_t *scope, uint8_t packet[DAQ_PACKET_BYTES])
{
    daq->next_is_fast = !daq->running[DAQ_LIST_SLOW] || daq->read == daq->released;
    if (!daq->next_is_fast) {
        const daq_packet_t *next = &daq->queue[daq->read];
        for (uint32_t i = 0; i < next->length; i++) {
            packet[i] = next->bytes[i];
        }
        return next->length;
    }
    const uint32_t bytes = daq->running[DAQ_LIST_FAST] ? scope_next_row(scope, &packet[1]) : 0U;
    packet[0] = (uint8_t)(DAQ_FAST_ODT | (scope->lost ? DAQ_OVERLOAD : 0));
    return bytes > 0 ? 1U + bytes : 0U;
}

void daq_taken(daq_t *daq, scope_t *scope)
{
    if (daq->next_is_fast) {
        scope->lost = false;
        scope_row_taken(scope);
    } else {
        daq->read = after(daq->read, 1);
    }
}

/* SPDX-License-Identifier: Apache-2.0 */
/*
 * daq.h: the DAQ lists of XCP: which signals a tool gets without asking, and when. Pure.
 *
 *     list            event                     ODTs            way to the tool
 *     DAQ_LIST_SLOW   every slow step           0 .. 7          CAN and packets
 *     DAQ_LIST_FAST   every PWM period          8               packets alone, by scope_t's stream
 *
 * A packet is an ODT: its number, two bytes of time in the first ODT of a list, its signals. Time
 * counts DAQ_TICK_us: of the slow list the slow steps, of the fast one the PWM periods.
 *
 * The signals of a slow list are of one slow step. Of its packets the slow step releases as many as
 * daq_line_t has: on CAN one a millisecond. A packet without a place is lost, and the next one says
 * so (DAQ_OVERLOAD in its number).
 *
 *     daq_slow_step()   every millisecond, after the slow step, while daq_runs_slow()
 *     the others        background; the former may interrupt them
 *
 * A list that starts does so when daq_start() has returned: whoever calls the step begins then.
 */
#ifndef COMMS_DAQ_H
#define COMMS_DAQ_H

#include <stdbool.h>
#include <stdint.h>

#include "comms/scope.h"
#include "comms/xcp_error.h"
#include "comms/xcp_signals.h"

enum {
    DAQ_TICK_us = 10,
    DAQ_SLOW_STEP_ticks = 1000 / DAQ_TICK_us,
    DAQ_SLOW_ODTS = 8,
    DAQ_FAST_ODT = DAQ_SLOW_ODTS,
    DAQ_ODTS = DAQ_SLOW_ODTS + 1,
    DAQ_ENTRIES = SCOPE_CHANNELS, /* signals of an ODT */
    DAQ_TIME_BYTES = SCOPE_TIME_BYTES,
    DAQ_PACKET_BYTES = 1 + DAQ_TIME_BYTES + SCOPE_ROW_BYTES,
    DAQ_QUEUE = 16, /* packets of the slow list, less one */
    DAQ_OVERLOAD = 0x80
};

typedef enum { DAQ_LIST_SLOW = 0, DAQ_LIST_FAST = 1, DAQ_LISTS } daq_list_t;

/* What the way to the tool can carry. */
typedef struct {
    uint8_t packet_bytes; /* at most DAQ_PACKET_BYTES */
    uint8_t packets_a_ms; /* of the slow list */
    bool carries_fast_list;
} daq_line_t;

typedef struct {
    uint8_t length;
    uint8_t bytes[DAQ_PACKET_BYTES];
} daq_packet_t;

typedef struct {
    scope_entry_t entry[DAQ_ODTS][DAQ_ENTRIES];
    uint8_t prescaler[DAQ_LISTS];
    bool selected[DAQ_LISTS];
    bool running[DAQ_LISTS];
    uint8_t packets_a_ms;
    uint8_t countdown; /* slow steps until the next sample */
    bool lost;         /* millisecond */
    uint16_t slow_steps;
    daq_packet_t queue[DAQ_QUEUE];
    uint8_t written, released; /* millisecond */
    uint8_t read;              /* background */
    bool next_is_fast;         /* of which list daq_next() has given a packet */
} daq_t;

void daq_init(daq_t *daq);

/* The ODTs of a list. */
uint32_t daq_first_odt(daq_list_t list);
uint32_t daq_odts(daq_list_t list);

/* Empties a list that does not run. */
void daq_clear(daq_t *daq, daq_list_t list);

/* DAQ_CONFIG: the ODT has no space for it on this line. */
xcp_error_t daq_write(daq_t *daq, const daq_line_t *line, uint32_t odt, uint32_t entry,
                      scope_entry_t what);

/* slow_steps: the latest. DAQ_CONFIG: the line does not carry so much; NOT_ACCESSIBLE_NOW: the
 * scope has what the list needs. */
xcp_error_t daq_start(daq_t *daq, const daq_line_t *line, const xcp_table_t *table, scope_t *scope,
                      daq_list_t list, uint16_t slow_steps);
void daq_stop(daq_t *daq, scope_t *scope, daq_list_t list);

static inline bool daq_runs_slow(const daq_t *daq)
{
    return daq->running[DAQ_LIST_SLOW];
}

void daq_slow_step(daq_t *daq, const xcp_table_t *table, uint16_t slow_steps);

/* The next packet, its bytes, 0: there is none; and after it, that the next call is to give the one
 * behind it. */
uint32_t daq_next(daq_t *daq, scope_t *scope, uint8_t packet[DAQ_PACKET_BYTES]);
void daq_taken(daq_t *daq, scope_t *scope);

#endif

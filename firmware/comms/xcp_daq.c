/* SPDX-License-Identifier: Apache-2.0 */
#include "xcp_exchange.h"

/* Bits and codes of the standard, part 2. */
enum {
    LIST_SELECTED = 0x01,
    LIST_HAS_TIME = 0x10,
    LIST_RUNNING = 0x40,
    STOP = 0,
    START = 1,
    SELECT = 2,
    STOP_ALL = 0,
    START_SELECTED = 1,
    STOP_SELECTED = 2,
    PRESCALER_SUPPORTED = 0x02,
    TIME_SUPPORTED = 0x10,
    OVERLOAD_IN_NUMBER = 0x40,
    NUMBERS_OF_ODTS = 0, /* absolute, without an address extension or optimisation */
    TIME_FIXED = 0x08,
    UNIT_10_us = 0x40,
    EVENT_FIXED = 0x02,
    OF_DAQ = 0x04,
    UNIT_us = 3,
    UNIT_ms = 6,
    NO_BIT = 0xFF
};

/* Of each list, whose event has its number. */
static const char *const EVENT_NAMES[DAQ_LISTS] = {"slow step", "PWM period"};

bool xcp_daq_runs(const xcp_access_t *access)
{
    return access->daq->running[DAQ_LIST_SLOW] || access->daq->running[DAQ_LIST_FAST];
}

void xcp_daq_end(const xcp_access_t *access)
{
    for (uint32_t list = 0; list < DAQ_LISTS; list++) {
        daq_stop(access->daq, access->scope, (daq_list_t)list);
        daq_clear(access->daq, (daq_list_t)list);
    }
    scope_stop(access->scope);
}

/* The list of a command, which is to stand still. */
static xcp_error_t list_at_rest(const exchange_t *x, daq_list_t *list)
{
    const uint32_t number = half_at(&x->command[2]);
    if (number >= DAQ_LISTS) {
        return XCP_ERROR_OUT_OF_RANGE;
    }
    *list = (daq_list_t)number;
    return x->access->daq->running[number] ? XCP_ERROR_DAQ_ACTIVE : XCP_ERROR_NONE;
}

/* Stops it. */
static xcp_error_t clear_list(const exchange_t *x)
{
    const uint32_t number = half_at(&x->command[2]);
    if (number >= DAQ_LISTS) {
        return XCP_ERROR_OUT_OF_RANGE;
    }
    daq_stop(x->access->daq, x->access->scope, (daq_list_t)number);
    daq_clear(x->access->daq, (daq_list_t)number);
    return XCP_ERROR_NONE;
}

static xcp_error_t set_pointer(exchange_t *x)
{
    daq_list_t list;
    const uint32_t odt = x->command[4];
    const uint32_t entry = x->command[5];
    const xcp_error_t error = list_at_rest(x, &list);
    if (error != XCP_ERROR_NONE) {
        return error;
    }
    if (odt >= daq_odts(list) || entry >= DAQ_ENTRIES) {
        return XCP_ERROR_OUT_OF_RANGE;
    }
    x->slave->daq_odt = (uint8_t)(daq_first_odt(list) + odt);
    x->slave->daq_entry = (uint8_t)entry;
    return XCP_ERROR_NONE;
}

/* Signals of the table alone, from their first byte on. */
static xcp_error_t write_entry(exchange_t *x)
{
    xcp_t *slave = x->slave;
    const uint32_t bytes = x->command[2];
    const uint32_t offset = word_at(&x->command[4]) - XCP_SIGNALS_ADDRESS;
    const scope_entry_t what = {(uint8_t)(offset / XCP_SIGNAL_BYTES), (uint8_t)bytes};
    if (slave->daq_odt >= DAQ_ODTS) {
        return XCP_ERROR_SEQUENCE;
    }
    const daq_list_t list = slave->daq_odt == DAQ_FAST_ODT ? DAQ_LIST_FAST : DAQ_LIST_SLOW;
    if (x->access->daq->running[list]) {
        return XCP_ERROR_DAQ_ACTIVE;
    }
    if (x->command[1] != NO_BIT || x->command[3] != 0 || slave->daq_entry >= DAQ_ENTRIES ||
        (bytes != 1U && bytes != 2U && bytes != XCP_SIGNAL_BYTES)) {
        return XCP_ERROR_OUT_OF_RANGE;
    }
    if (offset % XCP_SIGNAL_BYTES != 0 ||
        offset / XCP_SIGNAL_BYTES >= x->access->table.signals_count) {
        return XCP_ERROR_ACCESS_DENIED;
    }
    const xcp_error_t error =
        daq_write(x->access->daq, x->access->line, slave->daq_odt, slave->daq_entry, what);
    if (error == XCP_ERROR_NONE) {
        slave->daq_entry++;
    }
    return error;
}

/* Each list has its event; its packets always have their time. */
static xcp_error_t set_mode(exchange_t *x)
{
    daq_list_t list;
    const xcp_error_t error = list_at_rest(x, &list);
    if (error != XCP_ERROR_NONE) {
        return error;
    }
    if ((x->command[1] & ~(uint32_t)LIST_HAS_TIME) != 0) {
        return XCP_ERROR_MODE_NOT_VALID;
    }
    if (x->command[1] == 0) {
        return XCP_ERROR_COMMAND_SYNTAX;
    }
    if (half_at(&x->command[4]) != (uint32_t)list || x->command[6] == 0) {
        return XCP_ERROR_OUT_OF_RANGE;
    }
    x->access->daq->prescaler[list] = x->command[6];
    return XCP_ERROR_NONE;
}

static xcp_error_t get_mode(exchange_t *x)
{
    const daq_t *daq = x->access->daq;
    const uint32_t list = half_at(&x->command[2]);
    if (list >= DAQ_LISTS) {
        return XCP_ERROR_OUT_OF_RANGE;
    }
    x->answer[1] = (uint8_t)(LIST_HAS_TIME | (daq->selected[list] ? LIST_SELECTED : 0) |
                             (daq->running[list] ? LIST_RUNNING : 0));
    x->answer[2] = 0;
    x->answer[3] = 0;
    xcp_put(&x->answer[4], list, 2);
    x->answer[6] = daq->prescaler[list];
    x->answer[7] = 0;
    x->answer_bytes = 8;
    return XCP_ERROR_NONE;
}

static xcp_error_t start(const xcp_access_t *access, daq_list_t list)
{
    return daq_start(access->daq, access->line, &access->table, access->scope, list,
                     access->slow_steps);
}

static xcp_error_t start_stop_list(exchange_t *x)
{
    const xcp_access_t *access = x->access;
    const uint32_t mode = x->command[1];
    const uint32_t number = half_at(&x->command[2]);
    xcp_error_t error = XCP_ERROR_NONE;
    if (number >= DAQ_LISTS) {
        return XCP_ERROR_OUT_OF_RANGE;
    }
    const daq_list_t list = (daq_list_t)number;
    if (mode == STOP) {
        daq_stop(access->daq, access->scope, list);
    } else if (mode == START) {
        error = start(access, list);
    } else if (mode == SELECT) {
        access->daq->selected[list] = true;
    } else {
        error = XCP_ERROR_MODE_NOT_VALID;
    }
    x->answer[1] = (uint8_t)daq_first_odt(list);
    x->answer_bytes = 2;
    return error;
}

/* What starts before an error goes on; the tool stops it. */
static xcp_error_t start_stop_synch(exchange_t *x)
{
    const xcp_access_t *access = x->access;
    const uint32_t mode = x->command[1];
    xcp_error_t error = mode > STOP_SELECTED ? XCP_ERROR_MODE_NOT_VALID : XCP_ERROR_NONE;
    for (uint32_t k = 0; k < DAQ_LISTS && error == XCP_ERROR_NONE; k++) {
        const daq_list_t list = (daq_list_t)k;
        const bool selected = access->daq->selected[list];
        if (mode == START_SELECTED && selected) {
            error = start(access, list);
        } else if (mode == STOP_ALL || (mode == STOP_SELECTED && selected)) {
            daq_stop(access->daq, access->scope, list);
        }
    }
    return error;
}

static xcp_error_t get_clock(exchange_t *x)
{
    x->answer[1] = 0;
    x->answer[2] = 0;
    x->answer[3] = 0;
    xcp_put(&x->answer[4], (uint32_t)(uint16_t)(x->access->slow_steps * DAQ_SLOW_STEP_ticks),
            sizeof(uint32_t));
    x->answer_bytes = 8;
    return XCP_ERROR_NONE;
}

static xcp_error_t get_processor_info(exchange_t *x)
{
    x->answer[1] = PRESCALER_SUPPORTED | TIME_SUPPORTED | OVERLOAD_IN_NUMBER;
    xcp_put(&x->answer[2], DAQ_LISTS, 2);
    xcp_put(&x->answer[4], DAQ_LISTS, 2); /* events */
    x->answer[6] = 0;                     /* predefined lists */
    x->answer[7] = NUMBERS_OF_ODTS;
    x->answer_bytes = 8;
    return XCP_ERROR_NONE;
}

static xcp_error_t get_resolution_info(exchange_t *x)
{
    x->answer[1] = 1; /* granularity, of DAQ and of STIM, which there is none of */
    x->answer[2] = XCP_SIGNAL_BYTES;
    x->answer[3] = 1;
    x->answer[4] = 0;
    x->answer[5] = (uint8_t)(UNIT_10_us | TIME_FIXED | DAQ_TIME_BYTES);
    xcp_put(&x->answer[6], 1, 2);
    x->answer_bytes = 8;
    return XCP_ERROR_NONE;
}

static xcp_error_t get_list_info(exchange_t *x)
{
    const uint32_t list = half_at(&x->command[2]);
    if (list >= DAQ_LISTS) {
        return XCP_ERROR_OUT_OF_RANGE;
    }
    x->answer[1] = EVENT_FIXED | OF_DAQ;
    x->answer[2] = (uint8_t)daq_odts((daq_list_t)list);
    x->answer[3] = DAQ_ENTRIES;
    xcp_put(&x->answer[4], list, 2);
    x->answer_bytes = 6;
    return XCP_ERROR_NONE;
}

static uint8_t length_of(const char *text)
{
    uint8_t length = 0;
    while (text[length] != '\0') {
        length++;
    }
    return length;
}

/* The name is uploaded. */
static xcp_error_t get_event_info(exchange_t *x)
{
    const uint32_t event = half_at(&x->command[2]);
    if (event >= DAQ_LISTS) {
        return XCP_ERROR_OUT_OF_RANGE;
    }
    const uint32_t Hz = (uint32_t)x->access->in_force->drive.pwm_frequency_Hz;
    const bool slow = event == DAQ_LIST_SLOW;
    x->slave->text = EVENT_NAMES[event];
    x->slave->mta = 0;
    x->answer[1] = OF_DAQ;
    x->answer[2] = 1; /* list of this event */
    x->answer[3] = length_of(EVENT_NAMES[event]);
    x->answer[4] = (uint8_t)(slow ? 1U : (1000000U + Hz / 2U) / Hz);
    x->answer[5] = slow ? UNIT_ms : UNIT_us;
    x->answer[6] = 0;
    x->answer_bytes = 7;
    return XCP_ERROR_NONE;
}

xcp_error_t xcp_daq_execute(exchange_t *x)
{
    switch (x->command[0]) {
    case CLEAR_DAQ_LIST:
        return clear_list(x);
    case SET_DAQ_PTR:
        return set_pointer(x);
    case WRITE_DAQ:
        return write_entry(x);
    case SET_DAQ_LIST_MODE:
        return set_mode(x);
    case GET_DAQ_LIST_MODE:
        return get_mode(x);
    case START_STOP_DAQ_LIST:
        return start_stop_list(x);
    case START_STOP_SYNCH:
        return start_stop_synch(x);
    case GET_DAQ_CLOCK:
        return get_clock(x);
    case GET_DAQ_PROCESSOR_INFO:
        return get_processor_info(x);
    case GET_DAQ_RESOLUTION_INFO:
        return get_resolution_info(x);
    case GET_DAQ_LIST_INFO:
        return get_list_info(x);
    default: /* GET_DAQ_EVENT_INFO */
        return get_event_info(x);
    }
}

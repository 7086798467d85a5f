/* SPDX-License-Identifier: Apache-2.0 */
/* xcp_exchange.h: one command on its way through xcp.c and xcp_daq.c. */
#ifndef COMMS_XCP_EXCHANGE_H
#define COMMS_XCP_EXCHANGE_H

#include "comms/xcp.h"

/* Command codes of the standard, part 2. */
enum {
    CONNECT = 0xFF,
    DISCONNECT = 0xFE,
    GET_STATUS = 0xFD,
    SYNCH = 0xFC,
    GET_COMM_MODE_INFO = 0xFB,
    GET_ID = 0xFA,
    SET_REQUEST = 0xF9,
    GET_SEED = 0xF8,
    UNLOCK = 0xF7,
    SET_MTA = 0xF6,
    UPLOAD = 0xF5,
    SHORT_UPLOAD = 0xF4,
    BUILD_CHECKSUM = 0xF3,
    DOWNLOAD = 0xF0,
    SET_CAL_PAGE = 0xEB,
    GET_CAL_PAGE = 0xEA,
    GET_PAG_PROCESSOR_INFO = 0xE9,
    COPY_CAL_PAGE = 0xE4,
    CLEAR_DAQ_LIST = 0xE3,
    SET_DAQ_PTR = 0xE2,
    WRITE_DAQ = 0xE1,
    SET_DAQ_LIST_MODE = 0xE0,
    GET_DAQ_LIST_MODE = 0xDF,
    START_STOP_DAQ_LIST = 0xDE,
    START_STOP_SYNCH = 0xDD,
    GET_DAQ_CLOCK = 0xDC,
    GET_DAQ_PROCESSOR_INFO = 0xDA,
    GET_DAQ_RESOLUTION_INFO = 0xD9,
    GET_DAQ_LIST_INFO = 0xD8,
    GET_DAQ_EVENT_INFO = 0xD7
};

/* Each function for a command returns an error, or has written the answer behind its first byte and
 * counted its bytes in. */
typedef struct {
    xcp_t *slave;
    const xcp_access_t *access;
    uint32_t now_ms;
    const uint8_t *command;
    uint32_t length;
    uint8_t *answer;
    uint32_t answer_bytes;
} exchange_t;

static inline uint32_t half_at(const uint8_t *at)
{
    return at[0] | (uint32_t)at[1] << 8;
}

static inline uint32_t word_at(const uint8_t *at)
{
    return half_at(at) | half_at(&at[2]) << 16;
}

/* The commands of DAQ, from CLEAR_DAQ_LIST down. */
xcp_error_t xcp_daq_execute(exchange_t *x);

bool xcp_daq_runs(const xcp_access_t *access);

/* Stops and empties the lists, and stops a scope that is not complete. */
void xcp_daq_end(const xcp_access_t *access);

#endif

/* SPDX-License-Identifier: Apache-2.0 */
/*
 * xcp.h: a slave of ASAM MCD-1 XCP 1.x: measurement and parameters for any tool that speaks it.
 * Pure: a command packet and the time in, an answer packet out. Background context.
 *
 *     a tool's address                      what is there
 *     XCP_SIGNALS_ADDRESS + 4 * place       signal `place` of the table, an int32_t, read only
 *     XCP_PAGE_ADDRESS + place in config_t  the page: in force (0, read only) or staging (1)
 *     XCP_SCOPE_ADDRESS                     scope_page_t, written a word at a time, without a key
 *     XCP_RECORD_ADDRESS                    the scope's record, read only, while it is COMPLETE
 *
 * Nothing else can be read or written, whatever address a command names. The pages end before
 * config_t's checksum, and with it before the key.
 *
 * Pages: segment 0 has page 0, which the controller uses, and page 1, the staging page in RAM.
 * Writing is locked until UNLOCK; it fills the staging page from the one in force. SET_REQUEST
 * (store) asks the caller to check, store and use the staging page as a whole.
 *
 * DAQ: two static lists (comms/daq.h), always with time. A session's end stops lists and scope.
 *
 * Lock: GET_SEED returns six fresh bytes, UNLOCK takes the first six of mac_of() them and two zero
 * bytes. A wrong key ends the session, after three of them there is no seed for XCP_WRONG_KEYS_ms:
 * 48 bits are guessed in 10^7 years. A session also ends after XCP_IDLE_ms without a command.
 *
 * Every error code is the standard's. A command outside a session is not answered.
 */
#ifndef COMMS_XCP_H
#define COMMS_XCP_H

#include <stdbool.h>
#include <stdint.h>

#include "comms/daq.h"
#include "comms/scope.h"
#include "comms/xcp_error.h"
#include "comms/xcp_signals.h"
#include "config/config.h"

enum {
    XCP_PACKET_BYTES = 8,                  /* MAX_CTO: a classic CAN frame */
    XCP_SEED_BYTES = XCP_PACKET_BYTES - 2, /* and of the key that answers it */
    XCP_IDLE_ms = 60000,
    XCP_WRONG_KEYS = 3,
    XCP_WRONG_KEYS_ms = 10000
};
/* Addresses of the protocol, where no port has memory: the same in every image. */
#define XCP_SIGNALS_ADDRESS UINT32_C(0xA0000000)
#define XCP_PAGE_ADDRESS UINT32_C(0xB0000000)
#define XCP_SCOPE_ADDRESS UINT32_C(0xC0000000)
#define XCP_RECORD_ADDRESS UINT32_C(0xD0000000)
#define XCP_SEED_MASK UINT64_C(0xFFFFFFFFFFFF)

typedef enum { XCP_PAGE_IN_FORCE = 0, XCP_PAGE_STAGING = 1, XCP_PAGES } xcp_page_t;

/* What a slave may read and write. */
typedef struct {
    xcp_table_t table;   /* of which the slow records are of one slow step */
    uint16_t slow_steps; /* that one's number, wrapping: the clock of DAQ */
    const daq_line_t *line;
    daq_t *daq;
    scope_t *scope; /* without memory: this port has none */
    const config_t *in_force;
    config_t *staging;          /* NULL: not to be had now */
    const char *identification; /* of GET_ID: the name of the image's A2L */
} xcp_access_t;

typedef struct {
    bool connected;
    bool unlocked;
    bool store_wanted; /* SET_REQUEST is not answered yet */
    xcp_page_t page;   /* which the tool reads and writes */
    const char *text;  /* not NULL: the memory transfer address counts in it */
    uint32_t mta;
    uint8_t daq_odt, daq_entry; /* of SET_DAQ_PTR; daq_odt DAQ_ODTS: none */
    uint32_t latest_ms;         /* the latest command */
    uint64_t seed;
    bool seed_drawn;          /* and not used yet */
    bool seed_given;          /* by GET_SEED */
    uint32_t wrong_keys;      /* since the last right one or pause */
    uint32_t paused_since_ms; /* while there are XCP_WRONG_KEYS of them */
    uint32_t unlocks;         /* since the start */
} xcp_t;

void xcp_init(xcp_t *slave);

/* Every pass, before commands: ends idle sessions, and access to a staging page that is gone. */
void xcp_tick(xcp_t *slave, const xcp_access_t *access, uint32_t now_ms);

/* True: xcp_give_seed() is to be called when there are 48 bits that nobody can predict. Without
 * them nothing can be unlocked. */
bool xcp_wants_seed(const xcp_t *slave);
void xcp_give_seed(xcp_t *slave, uint64_t seed);

/* One command of the tool; returns the bytes of the answer, 0: none. After it, where
 * slave->store_wanted is true, the answer is that of xcp_store(). */
uint32_t xcp_command(xcp_t *slave, const xcp_access_t *access, uint32_t now_ms,
                     const uint8_t *command, uint32_t length, uint8_t answer[XCP_PACKET_BYTES]);

/* The caller's decision about the staging page, once while slave->store_wanted is true: an error of
 * the standard, or XCP_ERROR_NONE: it will be stored and used, and is locked until then. Returns
 * the bytes of the answer. */
uint32_t xcp_store(xcp_t *slave, xcp_error_t error, uint8_t answer[XCP_PACKET_BYTES]);

#endif

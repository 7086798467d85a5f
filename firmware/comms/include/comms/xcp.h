/* SPDX-License-Identifier: Apache-2.0 */
/*
 * xcp.h: a slave of ASAM MCD-1 XCP 1.x: measurement and parameters for any tool that speaks it.
 * Pure: a command packet and the time in, an answer packet out. Background context.
 *
 *     a tool's address                      what is there
 *     XCP_SIGNALS_ADDRESS + 4 * place       signal `place` of the table, an int32_t, read only
 *     XCP_PAGE_ADDRESS + place in config_t  the page: in force (0, read only) or staging (1)
 *
 * Nothing else can be read or written, whatever address a command names. The pages end before
 * config_t's checksum, and with it before the key.
 *
 * Pages: segment 0 has page 0, which the controller uses, and page 1, the staging page in RAM.
 * Writing is locked until UNLOCK; it fills the staging page from the one in force. SET_REQUEST
 * (store) asks the caller to check, store and use the staging page as a whole.
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
#define XCP_SEED_MASK UINT64_C(0xFFFFFFFFFFFF)

typedef enum { XCP_PAGE_IN_FORCE = 0, XCP_PAGE_STAGING = 1, XCP_PAGES } xcp_page_t;

/* Error codes of the standard, part 2. */
typedef enum {
    XCP_ERROR_NONE = -1,
    XCP_ERROR_SYNCH = 0x00,
    XCP_ERROR_COMMAND_UNKNOWN = 0x20,
    XCP_ERROR_COMMAND_SYNTAX = 0x21,
    XCP_ERROR_OUT_OF_RANGE = 0x22,
    XCP_ERROR_WRITE_PROTECTED = 0x23,
    XCP_ERROR_ACCESS_DENIED = 0x24,
    XCP_ERROR_ACCESS_LOCKED = 0x25,
    XCP_ERROR_PAGE_NOT_VALID = 0x26,
    XCP_ERROR_MODE_NOT_VALID = 0x27,
    XCP_ERROR_SEGMENT_NOT_VALID = 0x28,
    XCP_ERROR_SEQUENCE = 0x29,
    XCP_ERROR_NOT_ACCESSIBLE_NOW = 0x33
} xcp_error_t;

enum { XCP_RECORD_OUTPUT = 0, XCP_RECORD_INPUT = 1, XCP_RECORDS };

/* Where a signal is: unsigned or bool in one or two bytes, int32_t or unsigned in four. */
typedef struct {
    uint16_t offset_bytes;
    uint8_t size_bytes;
    uint8_t record; /* of xcp_access_t */
} xcp_signal_t;

/* What a slave may read and write. */
typedef struct {
    const xcp_signal_t *signals;
    uint32_t signals_count;
    const void *record[XCP_RECORDS]; /* of one slow step */
    const config_t *in_force;
    config_t *staging;          /* NULL: not to be had now */
    const char *identification; /* of GET_ID: the name of the image's A2L */
} xcp_access_t;

typedef struct {
    bool connected;
    bool unlocked;
    bool store_wanted; /* SET_REQUEST is not answered yet */
    xcp_page_t page;   /* which the tool reads and writes */
    bool mta_is_text;  /* the memory transfer address counts in access->identification */
    uint32_t mta;
    uint32_t latest_ms; /* the latest command */
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

/* SPDX-License-Identifier: Apache-2.0 */
/*
 * console_xcp.h: the console's serial line in the hands of a tool that speaks XCP (comms/sxi.h),
 * from the shell's `xcp` until its DISCONNECT has been answered or nothing has come for
 * SXI_SILENCE_ms. One command is on its way at a time; the next waits in the line. Background
 * context.
 *
 *     console_xcp.c         the line is turned over
 *     console_xcp_absent.c  for a port without XCP: never
 */
#ifndef APP_CONSOLE_XCP_H
#define APP_CONSOLE_XCP_H

#include <stdbool.h>
#include <stdint.h>

#include "comms/sxi.h"

typedef enum {
    CONSOLE_TEXT,
    CONSOLE_LAST_TEXT, /* of `xcp`; what comes is the tool's already */
    CONSOLE_XCP,
    CONSOLE_LAST_ANSWER /* the one to DISCONNECT */
} console_use_t;

typedef struct {
    console_use_t use; /* of the line */
    sxi_t sxi;
    uint8_t command_bytes; /* of the tool's packet in sxi.frame; 0: none that is complete */
    uint8_t answer[SXI_FRAME_BYTES];
    uint8_t answer_bytes, answer_sent;
    bool ended; /* by silence, not yet said */
} console_xcp_t;

void console_xcp_init(console_xcp_t *xcp);

/* False: this port has no XCP. */
bool console_xcp_open(console_xcp_t *xcp, uint32_t now_ms);

/* True while received bytes are the tool's; and while text may be sent. */
bool console_xcp_has_line(const console_xcp_t *xcp);
bool console_xcp_lets_text(const console_xcp_t *xcp);

/* Every pass: bytes of the line, and of answers. text_has_left: all of it that may be sent. */
void console_xcp_pump(console_xcp_t *xcp, uint32_t now_ms, bool text_has_left);

/* Once, the tool's packet; NULL: there is none. */
const uint8_t *console_xcp_packet(console_xcp_t *xcp, uint32_t *length);

/* The answer to it, at most XCP_PACKET_BYTES. */
void console_xcp_answer(console_xcp_t *xcp, const uint8_t *packet, uint32_t length);

/* True once, when a tool that has been silent has lost the line. */
bool console_xcp_has_ended(console_xcp_t *xcp);

#endif

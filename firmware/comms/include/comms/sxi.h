/* SPDX-License-Identifier: Apache-2.0 */
/*
 * sxi.h: XCP packets on a serial line, framed as ASAM MCD-1 XCP calls SxI. Pure.
 *
 *     length, counter, packet, checksum       a byte each, but for the packet; HEADER_LEN_CTR_BYTE
 *                                             and CHECKSUM_BYTE: the sum of all bytes before it
 *
 * The tool's counter is not looked at: it has one command on its way at a time. Where bytes are no
 * frame, all are left out until the line has been silent for SXI_GAP_ms, so that both ends begin
 * with a frame again.
 */
#ifndef COMMS_SXI_H
#define COMMS_SXI_H

#include <stdbool.h>
#include <stdint.h>

#include "comms/xcp.h"

enum {
    SXI_HEADER_BYTES = 2,
    SXI_FRAME_BYTES = SXI_HEADER_BYTES + XCP_PACKET_BYTES + 1,
    SXI_GAP_ms = 100,
    SXI_SILENCE_ms = 2000 /* after which the tool has gone */
};

typedef struct {
    uint8_t frame[SXI_FRAME_BYTES]; /* the packet of a complete one is behind the header */
    uint8_t received;               /* bytes of it */
    bool skips;                     /* until a gap */
    uint8_t counter;                /* of the next answer */
    uint32_t latest_ms;             /* the latest byte, or the beginning */
} sxi_t;

void sxi_init(sxi_t *sxi, uint32_t now_ms);

/* One received byte. Returns the length of the packet that it completes, 0: none; the packet stays
 * in frame[SXI_HEADER_BYTES] until the next byte. */
uint32_t sxi_receive(sxi_t *sxi, uint8_t byte, uint32_t now_ms);

/* Makes the frame of an answer of at most XCP_PACKET_BYTES; returns its bytes. */
uint32_t sxi_frame(sxi_t *sxi, const uint8_t *packet, uint32_t length,
                   uint8_t frame[SXI_FRAME_BYTES]);

/* True while nothing has come for SXI_SILENCE_ms. */
bool sxi_is_silent(const sxi_t *sxi, uint32_t now_ms);

#endif

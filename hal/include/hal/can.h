/* SPDX-License-Identifier: Apache-2.0 */
/*
 * can.h: classic CAN 2.0B data frames: with 11-bit identifiers, and with 29-bit ones, which are
 * sent but never received. Background context only.
 *
 * Up to three frames wait for the bus at a time, each in a place of the controller. Of them the one
 * with the lowest identifier takes part in the next arbitration. A place stays taken until
 * can_progress() has said what became of its frame.
 *
 * A frame with a 29-bit identifier is taken only while no other frame has a place, and gives its
 * place to any other frame that needs one: however urgent its leading bits make it on the bus, it
 * delays one of 11 bits by its own length at most.
 */
#ifndef HAL_CAN_H
#define HAL_CAN_H

#include <stdbool.h>
#include <stdint.h>

/* In an identifier: it has 29 bits. */
#define CAN_EXTENDED (UINT32_C(1) << 31)

typedef struct {
    uint32_t identifier; /* 0 .. 0x7FF, or with CAN_EXTENDED 0 .. 0x1FFFFFFF */
    uint8_t length;      /* 0 .. 8 */
    uint8_t data[8];
} can_frame_t;

/* What became of a frame. */
typedef enum {
    CAN_PENDING, /* it waits for the bus or for an acknowledgement */
    CAN_SENT,    /* another node has acknowledged it */
    CAN_ABORTED  /* it gave its place to another frame, or was never taken */
} can_progress_t;

/* 500 kbit/s. accepted_identifiers, of 11 bits: the only ones that can_receive() will deliver, at
 * most 14.
 * False if the controller has not joined the bus in time (no transceiver, bus held dominant). Where
 * it can, it joins when the bus becomes free; until then the other functions are harmless and
 * deliver nothing. */
bool can_init(const uint16_t *accepted_identifiers, uint32_t count);

/* The oldest frame not yet delivered; false if there is none. */
bool can_receive(can_frame_t *frame);

/* Takes a frame. It replaces a pending one of the same identifier; where all places are taken, the
 * pending one of the highest identifier, if that is higher than its own. False: not taken, because
 * there is no place, or not yet one, as the frame to be replaced is on the bus. */
bool can_transmit(const can_frame_t *frame);

/* Of the frame with this identifier that can_transmit() took last. SENT is said once. */
can_progress_t can_progress(uint32_t identifier);

/* True while the controller is off the bus after too many errors; it comes back by itself when the
 * bus recovers. */
bool can_bus_off(void);

#endif

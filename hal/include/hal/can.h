/* SPDX-License-Identifier: Apache-2.0 */
/*
 * can.h: classic CAN 2.0A data frames with 11-bit identifiers. Background context only.
 */
#ifndef HAL_CAN_H
#define HAL_CAN_H

#include <stdbool.h>
#include <stdint.h>

typedef struct {
    uint16_t identifier; /* 0 .. 0x7FF */
    uint8_t length;      /* 0 .. 8 */
    uint8_t data[8];
} can_frame_t;

/* 500 kbit/s. accepted_identifiers: the only ones that can_receive() will deliver, at most 14.
 * False if the controller has not joined the bus in time (no transceiver, bus held dominant). Where
 * it can, it joins when the bus becomes free; until then the other functions are harmless and
 * deliver nothing. */
bool can_init(const uint16_t *accepted_identifiers, uint32_t count);

/* The oldest frame not yet delivered; false if there is none. */
bool can_receive(can_frame_t *frame);

/* Queues a frame; false if the queue is full (bus busy or disconnected): the frame is then dropped.
 */
bool can_transmit(const can_frame_t *frame);

/* True while the controller is off the bus after too many errors; it comes back by itself when the
 * bus recovers. */
bool can_bus_off(void);

#endif

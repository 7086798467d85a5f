/* SPDX-License-Identifier: Apache-2.0 */
/*
 * packets.h: a line for the packets of the service protocol alone, beside CAN. Background context.
 * Boards have none: nothing is received, nothing is taken.
 */
#ifndef HAL_PACKETS_H
#define HAL_PACKETS_H

#include <stdbool.h>
#include <stdint.h>

enum { PACKET_BYTES = 40 };

typedef struct {
    uint8_t length; /* at most PACKET_BYTES */
    uint8_t bytes[PACKET_BYTES];
} packet_t;

/* The oldest packet not yet delivered; false if there is none. */
bool packets_receive(packet_t *packet);

/* False: not taken, because there is no place. */
bool packets_send(const packet_t *packet);

#endif

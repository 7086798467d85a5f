/* SPDX-License-Identifier: Apache-2.0 */
/*
 * ring.h: bytes between one writing and one reading context of a single core, without locks.
 *
 * Each index is written by one side only and as one aligned word. The compiler keeps the order of
 * the volatile accesses; a single core reads its own writes in order, so a byte is stored before
 * the index is updated.
 */
#ifndef STM32_RING_H
#define STM32_RING_H

#include <stdbool.h>
#include <stdint.h>

enum { RING_SIZE = 256 }; /* power of two; holds one byte less */

typedef struct {
    volatile uint8_t bytes[RING_SIZE];
    volatile uint32_t written; /* index of the next byte to write */
    volatile uint32_t read;    /* index of the next byte to read */
} ring_t;

static inline bool ring_put(ring_t *ring, uint8_t byte)
{
    const uint32_t next = (ring->written + 1U) % RING_SIZE;
    if (next == ring->read) {
        return false;
    }
    ring->bytes[ring->written] = byte;
    ring->written = next;
    return true;
}

static inline bool ring_get(ring_t *ring, uint8_t *byte)
{
    if (ring->read == ring->written) {
        return false;
    }
    *byte = ring->bytes[ring->read];
    ring->read = (ring->read + 1U) % RING_SIZE;
    return true;
}

#endif

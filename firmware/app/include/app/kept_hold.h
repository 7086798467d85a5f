/* SPDX-License-Identifier: Apache-2.0 */
/*
 * kept_hold.h: how the hydraulic brake holds the vehicle at standstill, kept over a reset in memory
 * that the start does not clear: a vehicle that stood on a slope is held again in the first
 * millisecond after it. A brown-out may damage the memory, and after a power-up it holds anything:
 * a record whose CRC is wrong is no hold.
 */
#ifndef APP_KEPT_HOLD_H
#define APP_KEPT_HOLD_H

#include <stddef.h>
#include <stdint.h>

#include "config/validate.h"
#include "torque/hill_hold.h"

typedef struct {
    uint32_t direction; /* drive_direction_t */
    uint32_t leaves;    /* 1: it has just driven off */
    uint32_t crc32;     /* of both */
} kept_hold_t;

static inline hill_hold_kept_t kept_hold_read(const kept_hold_t *kept)
{
    const uint32_t crc32 = config_crc32(kept, (uint32_t)offsetof(kept_hold_t, crc32));
    const bool holds = kept->crc32 == crc32 && kept->direction <= DRIVE_DIRECTION_REVERSE;
    const hill_hold_kept_t out = {
        .direction = holds ? (drive_direction_t)kept->direction : DRIVE_DIRECTION_NEUTRAL,
        .leaves = holds && kept->leaves == 1U,
    };
    return out;
}

static inline void kept_hold_write(kept_hold_t *kept, hill_hold_kept_t hold)
{
    kept->direction = (uint32_t)hold.direction;
    kept->leaves = hold.leaves ? 1U : 0U;
    kept->crc32 = config_crc32(kept, (uint32_t)offsetof(kept_hold_t, crc32));
}

/* 1 kHz, after one kept_hold_write(): a reset seldom finds half a record. */
static inline void kept_hold_follow(kept_hold_t *kept, hill_hold_kept_t hold)
{
    if (kept->direction != (uint32_t)hold.direction || kept->leaves != (hold.leaves ? 1U : 0U)) {
        kept_hold_write(kept, hold);
    }
}

#endif

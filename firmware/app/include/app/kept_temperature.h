/* SPDX-License-Identifier: Apache-2.0 */
/*
 * kept_temperature.h: the warmest estimate of winding and switches, kept over a reset in memory
 * that the start does not clear. A motor that was hot before a reset is hot after it, whatever its
 * sensors say.
 */
#ifndef APP_KEPT_TEMPERATURE_H
#define APP_KEPT_TEMPERATURE_H

#include "core/measured.h"

typedef struct {
    int32_t warmest_cC;
    uint32_t inverted; /* copy of it: after a power-up the memory holds anything */
} kept_temperature_t;

/* TEMPERATURE_NONE_cC if nothing was kept. */
static inline int32_t kept_temperature_read(const kept_temperature_t *kept)
{
    return kept->inverted == ~(uint32_t)kept->warmest_cC ? kept->warmest_cC : TEMPERATURE_NONE_cC;
}

static inline void kept_temperature_write(kept_temperature_t *kept, int32_t warmest_cC)
{
    kept->warmest_cC = warmest_cC;
    kept->inverted = ~(uint32_t)kept->warmest_cC;
}

#endif

/* SPDX-License-Identifier: Apache-2.0 */
/*
 * filter.h: first-order low-pass with a power-of-two time constant.
 *
 *     y += (x - y) / 2^shift
 *
 * Time constant about 2^shift steps, unity gain at rest without dead zone: the state keeps `shift`
 * extra bits, so y settles exactly on a constant x.
 */
#ifndef CORE_FILTER_H
#define CORE_FILTER_H

#include <stdint.h>

typedef struct {
    int32_t accumulator; /* y * 2^shift */
} filter_t;

/* x: Q15 or any value with |x| * 2^shift < 2^30. */
static inline int32_t filter_step(filter_t *filter, int32_t x, unsigned shift)
{
    filter->accumulator += x - (filter->accumulator >> shift);
    return filter->accumulator >> shift;
}

static inline void filter_reset(filter_t *filter, int32_t x, unsigned shift)
{
    filter->accumulator = x * (int32_t)(1UL << shift);
}

#endif

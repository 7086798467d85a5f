/* SPDX-License-Identifier: Apache-2.0 */
/*
 * circle.h: the largest second component of a vector inside a circle when the first is given,
 * sqrt(r^2 - x^2), without a square root. Fast loop.
 */
#ifndef CORE_CIRCLE_H
#define CORE_CIRCLE_H

#include <stdint.h>

#include "core/pair.h"
#include "core/q15.h"

enum { CIRCLE_TABLE_SEGMENTS = 64 };

/* sqrt(1 - k / 64) in Q31 plus twice the step to the next point in Q15, whose lower half is thus
 * that step: one load gives both. The step is <= 0, so the value is at most 1 LSB of Q15 too small.
 */
extern const int32_t CIRCLE_TABLE[CIRCLE_TABLE_SEGMENTS + 1];

/* sqrt(1 - x^2) in Q15 for |x| <= 32768, by linear interpolation over x^2. The chord of a concave
 * curve lies below it: the result never exceeds the true value (except by table rounding, 1 LSB),
 * so a vector limited with it never leaves the unit circle. Falls short by at most 0.8 % for |x| <
 * 0.97. */
Q_TARGET_INLINE int32_t circle_other_q15(int32_t x)
{
    const uint32_t square_q30 = (uint32_t)(x * x);
    const int32_t point = CIRCLE_TABLE[square_q30 >> 24];
    const int32_t fraction_q15 = (int32_t)((square_q30 >> 9) & 32767U);
    return q_mac_lower(point, point, fraction_q15) >> 16;
}

/* A circle of any radius up to 1: the radius and its reciprocal. */
typedef struct {
    int32_t radius_q15;
    int32_t inverse_q14; /* 2^29 / radius_q15, rounded up, so that the result is rounded down */
} circle_t;

/* radius_q15 >= 164 (half a per cent, the least of config.h), smaller values are raised
 * to it. Divides: for initialisation only. */
static inline circle_t circle_init(int32_t radius_q15)
{
    const int32_t radius = q_clamp(radius_q15, 164, Q15_ONE);
    const circle_t out = {.radius_q15 = radius, .inverse_q14 = (1 << 29) / radius + 1};
    return out;
}

/* The largest |y| with x^2 + y^2 <= radius^2, for |x| <= radius. Rounding lengthens the vector by
 * less than 1 LSB. */
static inline int32_t circle_other(const circle_t *circle, int32_t x)
{
    const int32_t share = q_saturate16((x * circle->inverse_q14) >> 14);
    return (circle_other_q15(share) * circle->radius_q15) >> 15;
}

#endif

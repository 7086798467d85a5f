/* SPDX-License-Identifier: Apache-2.0 */
/*
 * transforms.h: Park and inverse Park, amplitude-invariant, per-unit Q15 (Clarke: sense.h). All
 * results are rounded down.
 */
#ifndef FOC_TRANSFORMS_H
#define FOC_TRANSFORMS_H

#include "core/angle.h"
#include "core/frames.h"
#include "core/q15.h"

enum { TRANSFORMS_SQRT3_2_Q15 = 28378 /* round(32768 sqrt(3) / 2) */ };

/* d = alpha cos + beta sin, q = beta cos - alpha sin; error at most 1 LSB plus that of sin and cos.
 * |x| <= 1.9. */
static inline dq_t transforms_park(ab_t x, sincos_t angle)
{
    const dq_t out = {
        .d = (x.alpha * angle.cos + x.beta * angle.sin) >> 15,
        .q = (x.beta * angle.cos - x.alpha * angle.sin) >> 15,
    };
    return out;
}

/* alpha = d cos - q sin, beta = q cos + d sin. |x| <= 1.9. */
static inline ab_t transforms_inverse_park(dq_t x, sincos_t angle)
{
    const ab_t out = {
        .alpha = (x.d * angle.cos - x.q * angle.sin) >> 15,
        .beta = (x.q * angle.cos + x.d * angle.sin) >> 15,
    };
    return out;
}

/* Sine and cosine of the sum of two angles; within 2 LSB of the exact values. */
static inline sincos_t transforms_advance(sincos_t angle, sincos_t by)
{
    const sincos_t out = {
        .sin = (angle.sin * by.cos + angle.cos * by.sin) >> 15,
        .cos = (angle.cos * by.cos - angle.sin * by.sin) >> 15,
    };
    return out;
}

#endif

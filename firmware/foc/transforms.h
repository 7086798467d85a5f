/* SPDX-License-Identifier: Apache-2.0 */
/*
 * transforms.h: Park, its inverse and that of Clarke, amplitude-invariant, per-unit Q15 (Clarke
 * itself: sense.h). A rotation by theta is the product with cos theta + j sin theta, the reverse
 * rotation that with its conjugate. All results are rounded down.
 */
#ifndef FOC_TRANSFORMS_H
#define FOC_TRANSFORMS_H

#include "core/angle.h"
#include "core/frames.h"
#include "core/q15.h"
#include "core/sqrt3.h"

/* d = alpha cos + beta sin, q = beta cos - alpha sin; each saturated to 16 bits. */
Q_TARGET_INLINE dq16_t transforms_park(ab16_t x, rotation_t angle)
{
    const dq16_t out = {.v = q_pair(q_saturate16(q_pair_dot(angle.v, x.v) >> 15),
                                    q_saturate16(q_pair_cross(angle.v, x.v) >> 15))};
    return out;
}

/* alpha = d cos - q sin, beta = d sin + q cos. */
Q_TARGET_INLINE ab_t transforms_inverse_park(dq16_t x, rotation_t angle)
{
    const ab_t out = {
        .alpha = q_pair_re(x.v, angle.v) >> 15,
        .beta = q_pair_im(x.v, angle.v) >> 15,
    };
    return out;
}

/* The phases of a vector of components up to 2: a = alpha, b and c = +-sqrt(3)/2 beta - alpha/2. */
static inline abc_t transforms_inverse_clarke(ab_t x)
{
    const int32_t across = (x.beta * SQRT3_2_Q15) >> 15;
    const int32_t half = x.alpha >> 1;
    const abc_t out = {.a = x.alpha, .b = across - half, .c = -across - half};
    return out;
}

/* The rotation by the sum of two angles; within 3 LSB of the exact values; +1 saturates. */
Q_TARGET_INLINE rotation_t transforms_advance(rotation_t angle, rotation_t by)
{
    const rotation_t out = {.v = q_pair(q_saturate16(q_pair_re(angle.v, by.v) >> 15),
                                        q_saturate16(q_pair_im(angle.v, by.v) >> 15))};
    return out;
}

#endif

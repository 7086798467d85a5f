/* SPDX-License-Identifier: Apache-2.0 */
/*
 * vectors.h: what a proof takes for a vector inside a circle, and for a sine and cosine: larger
 * sets with straight borders.
 */
#ifndef VECTORS_H
#define VECTORS_H

#include "core/angle.h"
#include "core/frames.h"
#include "core/q15.h"
#include "proof.h"

/* What tests/unit shows of sine and cosine at every angle: their magnitudes add up to sqrt 2 and 1
 * LSB each. */
static inline sincos_t any_angle(void)
{
    const sincos_t angle = {.sin = any_within(-32768, 32768), .cos = any_within(-32768, 32768)};
    ASSUME(q_abs(angle.sin) + q_abs(angle.cos) <= 46342);
    return angle;
}

static inline bool rotation_holds(rotation_t angle)
{
    return q_abs(q_pair_x(angle.v)) + q_abs(q_pair_y(angle.v)) <= 46342;
}

/* Any content of a packed pair, as on the Cortex-M4. */
static inline q_pair_t any_pair(void)
{
    return q_pair(any_within(Q15_MIN, Q15_ONE), any_within(Q15_MIN, Q15_ONE));
}

static inline rotation_t any_rotation(void)
{
    const rotation_t out = {.v = any_pair()};
    ASSUME(rotation_holds(out));
    return out;
}

/* The octagon around a circle: its sides and, sqrt 2 times as far out, its diagonals. */
static inline dq_t any_vector(int32_t radius)
{
    const dq_t out = {.d = any_within(-radius, radius), .q = any_within(-radius, radius)};
    const int32_t diagonal = (int32_t)(((int64_t)radius * 46341) >> 15) + 1;
    ASSUME(q_abs(out.d) + q_abs(out.q) <= diagonal);
    return out;
}

#endif

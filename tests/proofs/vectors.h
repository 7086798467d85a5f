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

static inline rotation_t any_rotation(void)
{
    const sincos_t angle = any_angle();
    const rotation_t out = {.v = q_pair(q_saturate16(angle.cos), q_saturate16(angle.sin))};
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

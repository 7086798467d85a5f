/* SPDX-License-Identifier: Apache-2.0 */
/*
 * frames.h: phase, stator and rotor frame as three types that do not convert implicitly.
 *
 * Amplitude-invariant everywhere: a balanced set of peak value X has |alpha-beta| = |dq| = X.
 * Components are per-unit Q15, 1.0 = 32768. Phase values fit 16 bits. The packed types hold vectors
 * whose components are saturated to 16 bits (pair.h).
 */
#ifndef CORE_FRAMES_H
#define CORE_FRAMES_H

#include <stdint.h>

#include "core/pair.h"
#include "core/q15.h"

typedef struct {
    int32_t a, b, c; /* phases */
} abc_t;

typedef struct {
    int32_t alpha, beta; /* stator frame, alpha along phase a */
} ab_t;

typedef struct {
    int32_t d, q; /* rotor frame, d along the magnet flux, q leading by a quarter electrical turn */
} dq_t;

/* Packed: x = alpha, y = beta. */
typedef struct {
    q_pair_t v;
} ab16_t;

/* Packed: x = d, y = q. */
typedef struct {
    q_pair_t v;
} dq16_t;

/* Components saturated to 16 bits. */
Q_TARGET_INLINE ab16_t ab16_saturated(ab_t a)
{
    const ab16_t out = {.v = q_pair(q_saturate16(a.alpha), q_saturate16(a.beta))};
    return out;
}

Q_TARGET_INLINE dq16_t dq16_saturated(dq_t a)
{
    const dq16_t out = {.v = q_pair(q_saturate16(a.d), q_saturate16(a.q))};
    return out;
}

/* Components within 16 bits. */
Q_TARGET_INLINE dq16_t dq16_of(dq_t a)
{
    const dq16_t out = {.v = q_pair(a.d, a.q)};
    return out;
}

Q_TARGET_INLINE dq_t dq_of(dq16_t a)
{
    const dq_t out = {.d = q_pair_x(a.v), .q = q_pair_y(a.v)};
    return out;
}

#endif

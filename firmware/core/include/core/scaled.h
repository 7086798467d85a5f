/* SPDX-License-Identifier: Apache-2.0 */
/*
 * scaled.h: arithmetic on quantities in binary scales, for the slow loop. No 64-bit division: the
 * quotient takes one 32-bit one, the root two.
 *
 * A binary scale is a unit divided by a power of two, chosen at start so that a quantity uses 23
 * bits (firmware/motor/DERIVATIONS.md, Binary scales). Ratios of two such units carry 24 fraction
 * bits.
 */
#ifndef CORE_SCALED_H
#define CORE_SCALED_H

#include <stdint.h>

#include "core/q15.h"

enum { SCALED_ONE = 1 << 24 };

/* a b / 2^24, rounded down. |a b| < 2^55. */
static inline int32_t scaled_multiply(int32_t a, int32_t b)
{
    return (int32_t)(((int64_t)a * b) >> 24);
}

/* (a b + c d) / 2^24, rounded down. |a b + c d| < 2^55. */
static inline int32_t scaled_dot(int32_t a, int32_t b, int32_t c, int32_t d)
{
    return (int32_t)(((int64_t)a * b + (int64_t)c * d) >> 24);
}

/* x 2^shift, -62 <= shift <= 30; rounded down, saturated. */
static inline int32_t scaled_shift(int32_t x, int32_t shift)
{
    if (shift <= 0) {
        return x >> q_min(-shift, 31);
    }
    const int32_t shifted = (int32_t)((uint32_t)x << shift);
    return shifted >> shift == x ? shifted : (x >> 31) ^ INT32_MAX;
}

/* Number of leading zero bits of x, x > 0. A port may supply its core's instruction. */
static inline uint32_t scaled_leading_zeros(uint32_t x)
{
#ifdef Q_TARGET_LEADING_ZEROS
    return Q_TARGET_LEADING_ZEROS(x);
#else
    uint32_t zeros = 0;
    for (uint32_t width = 16; width > 0; width >>= 1) {
        if (x >> (32U - width) == 0) {
            x <<= width;
            zeros += width;
        }
    }
    return zeros;
#endif
}

/* n 2^24 / d to nearest, d > 0; relative error below 2^-27. A quotient beyond +-2^29 is some number
 * of its sign between 2^29 and 2^30. */
int32_t scaled_ratio(int32_t n, int32_t d);

/* The square root of x, 0 <= x < 2^62; relative error below 2^-14, at most one unit below 2^16. */
int32_t scaled_root(int64_t x);

/* value 2^shift / divisor, 0 <= value, 0 < divisor < 2^62; saturated at 2^30. Takes a
 * 64-bit division: for start-up. */
int32_t scaled_constant(int64_t value, int64_t divisor, int32_t shift);

#endif

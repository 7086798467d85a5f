/* SPDX-License-Identifier: Apache-2.0 */
/*
 * pair.h: two signed 16-bit numbers x and y processed together, e.g. the components of a vector or
 * a complex number x + j y. One to two instructions each where a port supplies them
 * (hal/cortex_m/pair.h); here the portable definition with the same results. Any context.
 *
 * Arguments named x and y must be within 16 bits; products are exact in 32 bits. Precondition of
 * q_pair_dot() and q_pair_im(): not both arguments are (-32768, -32768), the only sum that
 * overflows.
 */
#ifndef CORE_PAIR_H
#define CORE_PAIR_H

#include <stdint.h>

#include "core/q15.h"

#ifndef Q_TARGET_PAIR

typedef struct {
    int32_t x, y;
} q_pair_t;

/* Constant initialiser. */
#define Q_PAIR_INIT(x_value, y_value)                                                              \
    {                                                                                              \
        (x_value), (y_value)                                                                       \
    }

/* (x >> bits, y >> 16); bits: a literal such that x >> bits is within 16 bits. */
#define Q_PAIR_SHIFTED(x_value, bits, y_value) q_pair((x_value) >> (bits), (y_value) >> 16)

Q_TARGET_INLINE q_pair_t q_pair(int32_t x, int32_t y)
{
    const q_pair_t out = {.x = x, .y = y};
    return out;
}

/* y_q25 in Q15; it must then be within 16 bits. */
Q_TARGET_INLINE q_pair_t q_pair_of_q25(int32_t x, int32_t y_q25)
{
    return q_pair(x, y_q25 >> 10);
}

Q_TARGET_INLINE int32_t q_pair_x(q_pair_t a)
{
    return a.x;
}

Q_TARGET_INLINE int32_t q_pair_y(q_pair_t a)
{
    return a.y;
}

/* The pair in memory, by one instruction where a port supplies it. */
Q_TARGET_INLINE q_pair_t q_pair_load(const q_pair_t *from)
{
#ifdef Q_TARGET_LOAD_TWO
    q_pair_t out;
    Q_TARGET_LOAD_TWO(out.x, out.y, from);
    return out;
#else
    return *from;
#endif
}

/* a + b; both sums must be within 16 bits. */
Q_TARGET_INLINE q_pair_t q_pair_add(q_pair_t a, q_pair_t b)
{
    return q_pair(a.x + b.x, a.y + b.y);
}

/* a - b; both differences must be within 16 bits. */
Q_TARGET_INLINE q_pair_t q_pair_difference(q_pair_t a, q_pair_t b)
{
    return q_pair(a.x - b.x, a.y - b.y);
}

/* a - b, each component saturated to 16 bits. */
Q_TARGET_INLINE q_pair_t q_pair_subtract(q_pair_t a, q_pair_t b)
{
    return q_pair(q_saturate16(a.x - b.x), q_saturate16(a.y - b.y));
}

/* |a|^2, up to 2^31. */
Q_TARGET_INLINE uint32_t q_pair_square(q_pair_t a)
{
    return (uint32_t)(a.x * a.x) + (uint32_t)(a.y * a.y);
}

/* Real part of conj(a) b. */
Q_TARGET_INLINE int32_t q_pair_dot(q_pair_t a, q_pair_t b)
{
    return a.x * b.x + a.y * b.y;
}

/* Imaginary part of conj(a) b. */
Q_TARGET_INLINE int32_t q_pair_cross(q_pair_t a, q_pair_t b)
{
    return a.x * b.y - a.y * b.x;
}

/* Real part of a b. */
Q_TARGET_INLINE int32_t q_pair_re(q_pair_t a, q_pair_t b)
{
    return a.x * b.x - a.y * b.y;
}

/* Imaginary part of a b. */
Q_TARGET_INLINE int32_t q_pair_im(q_pair_t a, q_pair_t b)
{
    return a.x * b.y + a.y * b.x;
}

/* a times a factor 0 .. 65 535 over 2^16, rounded down. */
Q_TARGET_INLINE q_pair_t q_pair_scale(q_pair_t a, int32_t factor_q16)
{
    return q_pair((factor_q16 * a.x) >> 16, (factor_q16 * a.y) >> 16);
}

/* sum + a b / 2^17, rounded down; b 0 .. 32 767, the product and the result within 32 bits. */
Q_TARGET_INLINE int32_t q_mac_q17(int32_t sum, int32_t a, int32_t b_q17)
{
    return sum + ((a * b_q17) >> 17);
}

/* sum + the lower halves of a and b, signed, multiplied; the result must be within 32 bits. */
Q_TARGET_INLINE int32_t q_mac_lower(int32_t sum, int32_t a, int32_t b)
{
    return sum + (int16_t)a * (int16_t)b;
}

/* sum + a.x b.x; the result must be within 32 bits. */
Q_TARGET_INLINE int32_t q_pair_mac_x(int32_t sum, q_pair_t a, q_pair_t b)
{
    return sum + a.x * b.x;
}

/* sum + a.y b.y; the result must be within 32 bits. */
Q_TARGET_INLINE int32_t q_pair_mac_y(int32_t sum, q_pair_t a, q_pair_t b)
{
    return sum + a.y * b.y;
}

#endif

#endif

/* SPDX-License-Identifier: Apache-2.0 */
/*
 * q15.h: saturating fixed point.
 *
 * Q15 is an int16_t that stands for value/32768, so it spans [-1, 1 - 2^-15]. Products and sums
 * are int32_t. No function overflows, wraps or divides, except where noted; results outside the
 * range saturate. All functions are straight-line code without data-dependent branches after
 * compilation (clamps become saturating or conditional instructions), cost 1 to 4 instructions
 * each, and are safe in any context.
 */
#ifndef CORE_Q15_H
#define CORE_Q15_H

#include <stdint.h>

#define Q15_ONE 32767 /* the largest value; 1.0 itself is not representable */
#define Q15_MIN (-32768)

/* The shifts below assume it; in C it is implementation-defined. */
_Static_assert((-3 >> 1) == -2, "right shift of a negative number must be arithmetic");

/* Declaration of a kernel of the fast loop. A port may define it to force inlining also when
 * optimising for size: a call costs more time and more code than such a short function. */
#ifndef Q_TARGET_INLINE
#define Q_TARGET_INLINE static inline
#endif

static inline int32_t q_clamp(int32_t x, int32_t lowest, int32_t highest)
{
    x = x < lowest ? lowest : x;
    return x > highest ? highest : x;
}

/* x clamped to -most .. most, most >= 0. The common case, inside, is tested first. */
Q_TARGET_INLINE int32_t q_limit(int32_t x, int32_t most)
{
    if ((uint32_t)x + (uint32_t)most <= 2U * (uint32_t)most) {
        return x;
    }
    return x < 0 ? -most : most;
}

static inline int32_t q_min(int32_t a, int32_t b)
{
    return a < b ? a : b;
}

static inline int32_t q_max(int32_t a, int32_t b)
{
    return a > b ? a : b;
}

/* A field of the configuration as a divisor, at least 1. Every accepted one is; a bit that flips in
 * its memory may make it zero until the background's check of the image finds that. */
static inline int32_t q_divisor(int32_t field)
{
    return q_max(field, 1);
}

/* max(x, 0) and min(x, 0) without a condition; a port may supply the first as one instruction. */
#ifndef Q_TARGET_POSITIVE
#define Q_TARGET_POSITIVE(x) ((x) & ~((x) >> 31))
#endif

Q_TARGET_INLINE int32_t q_positive(int32_t x)
{
    return Q_TARGET_POSITIVE(x);
}

Q_TARGET_INLINE int32_t q_negative(int32_t x)
{
    return x & (x >> 31);
}

/* |x|; |INT32_MIN| saturates to INT32_MAX. */
Q_TARGET_INLINE int32_t q_abs(int32_t x)
{
    const uint32_t sign = (uint32_t)(x >> 31); /* all ones for x < 0 */
    const uint32_t magnitude = ((uint32_t)x ^ sign) - sign;
    return (int32_t)(magnitude - (magnitude >> 31));
}

/* x saturated to the range of a signed number of `bits` bits, 1 <= bits <= 31. The common case, x
 * inside the range, is tested first (for 16 bits a single instruction). */
Q_TARGET_INLINE int32_t q_saturate_bits(int32_t x, unsigned bits)
{
    const int32_t cut =
        bits == 16U ? (int16_t)x : (int32_t)((uint32_t)x << (32U - bits)) >> (32U - bits);
    return cut == x ? x : (x >> 31) ^ (int32_t)(((uint32_t)1 << (bits - 1U)) - 1U);
}

/* A port may supply Q_TARGET_SATURATE as one instruction with the same meaning; `bits` must be a
 * literal for that. */
#ifndef Q_TARGET_SATURATE
#define Q_TARGET_SATURATE(x, bits) q_saturate_bits((x), (bits))
#endif

Q_TARGET_INLINE int32_t q_saturate13(int32_t x)
{
    return Q_TARGET_SATURATE(x, 13);
}

Q_TARGET_INLINE int32_t q_saturate16(int32_t x)
{
    return Q_TARGET_SATURATE(x, 16);
}

Q_TARGET_INLINE int32_t q_saturate17(int32_t x)
{
    return Q_TARGET_SATURATE(x, 17);
}

Q_TARGET_INLINE int32_t q_saturate18(int32_t x)
{
    return Q_TARGET_SATURATE(x, 18);
}

Q_TARGET_INLINE int32_t q_saturate26(int32_t x)
{
    return Q_TARGET_SATURATE(x, 26);
}

Q_TARGET_INLINE int32_t q_saturate27(int32_t x)
{
    return Q_TARGET_SATURATE(x, 27);
}

Q_TARGET_INLINE int32_t q_saturate31(int32_t x)
{
    return Q_TARGET_SATURATE(x, 31);
}

static inline int16_t q15_saturate(int32_t x)
{
    return (int16_t)q_saturate16(x);
}

/* int64_t to int32_t, saturated: the lower half, where the upper one only repeats its sign. A port
 * may supply its own. */
static inline int32_t q_saturate64(int64_t x)
{
#ifdef Q_TARGET_SATURATE64
    return Q_TARGET_SATURATE64(x);
#else
    const int32_t low = (int32_t)x;
    const int32_t high = (int32_t)(x >> 32);
    return low >> 31 == high ? low : (high >> 31) ^ INT32_MAX;
#endif
}

/* a + b and a - b, saturated; a port may supply them as one instruction. */
#ifndef Q_TARGET_ADD
#define Q_TARGET_ADD(a, b) q_saturate64((int64_t)(a) + (b))
#define Q_TARGET_SUBTRACT(a, b) q_saturate64((int64_t)(a) - (b))
#endif

Q_TARGET_INLINE int32_t q_add(int32_t a, int32_t b)
{
    return Q_TARGET_ADD(a, b);
}

Q_TARGET_INLINE int32_t q_subtract(int32_t a, int32_t b)
{
    return Q_TARGET_SUBTRACT(a, b);
}

/* value * share, share in Q15, for physical quantities of the slow loop; rounded towards zero, so
 * never larger than value. */
static inline int32_t q15_share_of(int32_t value, int16_t share_q15)
{
    return q_saturate64((int64_t)value * share_q15 / 32768);
}

/* a * b / 32768 with a 64-bit product, rounded down and saturated to int32_t. */
static inline int32_t q15_product(int32_t a, int32_t b)
{
    return q_saturate64(((int64_t)a * b) >> 15);
}

/* (a * b) / c with a 64-bit product, rounded towards zero and saturated to int32_t. c must not be
 * 0. For the slow loop only: it divides. */
static inline int32_t q_scale(int32_t a, int32_t b, int32_t c)
{
    return q_saturate64((int64_t)a * b / c);
}

#endif

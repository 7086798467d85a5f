/* SPDX-License-Identifier: Apache-2.0 */
#include "core/reciprocal.h"

#include "core/q15.h"

/* round(2^30 / (2^15 + 512 k)): the reciprocal of [1, 2] in 64 steps, Q15; tests recompute every
 * entry. */
/* clang-format off */
static const uint16_t RECIPROCAL_TABLE[65] = {
    32768, 32264, 31775, 31301, 30840, 30394, 29959, 29537, 29127, 28728,
    28340, 27962, 27594, 27236, 26887, 26546, 26214, 25891, 25575, 25267,
    24966, 24672, 24385, 24105, 23831, 23564, 23302, 23046, 22795, 22550,
    22310, 22075, 21845, 21620, 21400, 21183, 20972, 20764, 20560, 20361,
    20165, 19973, 19784, 19600, 19418, 19240, 19065, 18893, 18725, 18559,
    18396, 18236, 18079, 17924, 17772, 17623, 17476, 17332, 17190, 17050,
    16913, 16777, 16644, 16513, 16384,
};
/* clang-format on */

/* How far n, 1 .. 65535, must be shifted left for its highest bit to be bit 15. */
static unsigned normalising_shift(uint32_t n)
{
#ifdef Q_TARGET_LEADING_ZEROS
    return Q_TARGET_LEADING_ZEROS(n) - 16U;
#else
    unsigned shift = n < 0x0100U ? 8 : 0;
    shift += n << shift < 0x1000U ? 4U : 0U;
    shift += n << shift < 0x4000U ? 2U : 0U;
    return shift + (n << shift < 0x8000U ? 1U : 0U);
#endif
}

/* 2^30 / x for 2^15 <= x < 2^16. */
static uint32_t mantissa_of(uint32_t x)
{
    const uint16_t *const point = &RECIPROCAL_TABLE[(x - 0x8000U) >> 9];
    const uint32_t drop = (uint32_t)point[0] - point[1];
    return point[0] - ((drop * (x & 511U) + 256U) >> 9);
}

uint32_t reciprocal_scale(uint32_t x, uint16_t n)
{
    const uint32_t least = n == 0 ? 1U : n;
    const unsigned shift = normalising_shift(least);
    /* 1/n = mantissa 2^shift / 2^30, shift 0 .. 15. */
    const uint64_t product = (uint64_t)x * mantissa_of(least << shift);
    return (uint32_t)(product >> 32) << (2U + shift) | (uint32_t)product >> (30U - shift);
}

/* SPDX-License-Identifier: Apache-2.0 */
#include "divide64.h"

/* Smaller cores keep the run-time library's. */
#if !defined(__arm__) || (defined(__ARM_FEATURE_IDIV) && defined(__ARM_FEATURE_CLZ))

/* Zero bits above the highest one of x > 0. */
static unsigned leading_zeros(uint64_t x)
{
    const uint32_t high = (uint32_t)(x >> 32);
    return high != 0 ? (unsigned)__builtin_clz(high) : 32U + (unsigned)__builtin_clz((uint32_t)x);
}

static uint32_t upper(uint32_t a, uint32_t b)
{
    return (uint32_t)((uint64_t)a * b >> 32);
}

/*
 * 2^62 / (by + 1) or less, by up to 2^-27 of it, for by >= 2^31: 16 digits of the reciprocal by a
 * division, with a relative error e, |e| < 2^-14, and a step of Newton's method, which leaves
 * 1 - e^2. Its three roundings add at most 2 to it, and 1 / (by + 1) is less than 1 / by by at most
 * one.
 */
static uint32_t reciprocal_below(uint32_t by)
{
    const uint32_t rough = (UINT32_MAX / (by >> 16)) << 14; /* 2^62 / by (1 + e) */
    const uint32_t less = 0U - 2U * upper(rough, by);       /* 2^31 (1 - e) */
    return (upper(rough, less) << 1) - 3U;
}

/*
 * Each turn takes a part of the quotient that is never too large: the leading 32 bits of n, rounded
 * down, times the reciprocal of the leading 32 bits of d, rounded up, shifted into place. Where
 * that rounds to zero, n is less than 2 d, and it is one. A quotient of up to 26 digits takes one
 * or two turns, any one four.
 */
uint64_t divide64(uint64_t n, uint64_t d, uint64_t *rest)
{
    const unsigned d_zeros = leading_zeros(d);
    const uint32_t inverse = reciprocal_below((uint32_t)(d << d_zeros >> 32));
    uint64_t quotient = 0;
    while (n >= d) {
        const unsigned n_zeros = leading_zeros(n); /* at most d_zeros */
        const uint32_t leading = upper((uint32_t)(n << n_zeros >> 32), inverse);
        const unsigned left = d_zeros - n_zeros;
        uint64_t part = left > 30U ? (uint64_t)leading << (left - 30U) : leading >> (30U - left);
        part = part == 0 ? 1U : part;
        quotient += part;
        n -= part * d;
    }
    *rest = n;
    return quotient;
}

#endif

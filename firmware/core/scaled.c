/* SPDX-License-Identifier: Apache-2.0 */
#include "core/scaled.h"

/* Upper half of a 64-bit product. */
static uint32_t upper(uint32_t a, uint32_t b)
{
    return (uint32_t)(((uint64_t)a * b) >> 32);
}

/* d is shifted until its highest bit is bit 31. A division gives 16 digits of its reciprocal, with
 * a relative error e, |e| < 2^-15; one step of Newton's method leaves e^2. One function for all
 * callers: its copies took 2.5 kB of flash, the calls take 1 % of a slow step. */
int32_t scaled_ratio(int32_t n, int32_t d)
{
    const uint32_t sign = (uint32_t)(n >> 31); /* all ones for n < 0 */
    const uint32_t magnitude = ((uint32_t)n ^ sign) - sign;
    const uint32_t n_zeros = scaled_leading_zeros(magnitude | 1U);
    const uint32_t d_zeros = scaled_leading_zeros((uint32_t)d);
    const uint32_t by = (uint32_t)d << d_zeros;
    const uint32_t rough = (UINT32_MAX / (by >> 16)) << 14; /* 2^62 / by (1 + e) */
    const uint32_t less = 0U - 2U * upper(rough, by);       /* 2^31 (1 - e) */
    const uint32_t inverse = upper(rough, less) << 1;       /* 2^62 / by */
    const uint32_t product = upper(magnitude << n_zeros, inverse);
    const uint32_t shift = n_zeros - d_zeros + 5U; /* wraps below zero */
    if (shift >= 31U) {
        return shift >> 31 == 0 ? 0 : (int32_t)(((UINT32_C(1) << 30) ^ sign) - sign);
    }
    return (int32_t)(((((product >> shift) + 1U) >> 1) ^ sign) - sign);
}

/* n in [2^30, 2^32): the chord of the root is at most 6 % below it; two steps of Newton leave the
 * rounding of 16 bits. */
static uint32_t root_of_normalised(uint32_t n)
{
    uint32_t y = 21845U + (((n >> 16) * 43690U) >> 16);
    y = (y + n / y) >> 1;
    return (y + n / y) >> 1;
}

int32_t scaled_root(int64_t x)
{
    if (x <= 0) {
        return 0;
    }
    /* An even number of digits to the left: root of the leading 32, shifted back by half as many.
     */
    const uint32_t high = (uint32_t)((uint64_t)x >> 32);
    const uint32_t low = (uint32_t)x;
    if (high == 0) {
        const uint32_t shift = scaled_leading_zeros(low) & ~1U;
        return (int32_t)(root_of_normalised(low << shift) >> (shift >> 1));
    }
    const uint32_t shift = scaled_leading_zeros(high) & ~1U;
    const uint32_t leading = (high << shift) | ((low >> 1) >> (31U - shift));
    return (int32_t)(root_of_normalised(leading) << (16U - (shift >> 1)));
}

int32_t scaled_constant(int64_t value, int64_t divisor, int32_t shift)
{
    const uint64_t by = (uint64_t)divisor;
    const uint64_t v = value > 0 ? (uint64_t)value : 0;
    uint64_t quotient = v / by;
    uint64_t rest = v % by;
    int32_t left = shift;
    /* One binary digit at a time, as far as 31 bits hold them. */
    for (; left > 0 && quotient < (UINT64_C(1) << 30); left--) {
        rest <<= 1;
        quotient = (quotient << 1) + (rest >= by ? 1U : 0U);
        rest -= rest >= by ? by : 0U;
    }
    for (; left < 0 && quotient > 0; left++) {
        quotient = (quotient + (left == -1 ? 1U : 0U)) >> 1;
    }
    return left > 0 || quotient > (UINT64_C(1) << 30) ? 1 << 30 : (int32_t)quotient;
}

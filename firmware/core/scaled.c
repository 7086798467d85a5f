/* SPDX-License-Identifier: Apache-2.0 */
#include "core/scaled.h"

/* n in [2^30, 2^32): the chord of the root is at most 6 % below it; two steps of Newton leave the
 * rounding of 16 bits. */
static uint32_t root_of_normalised(uint32_t n)
{
    uint32_t y = 21845U + (n >> 16) / 3U * 2U;
    y = (y + n / y) >> 1;
    return (y + n / y) >> 1;
}

int32_t scaled_root(int64_t x)
{
    if (x <= 0) {
        return 0;
    }
    uint64_t rest = (uint64_t)x;
    uint32_t shift = 0;
    if (rest >> 32 == 0) {
        uint32_t n = (uint32_t)rest;
        for (uint32_t width = 8; width > 0; width >>= 1) {
            if (n >> (32U - 2U * width) == 0) {
                n <<= 2U * width;
                shift += width;
            }
        }
        return (int32_t)(root_of_normalised(n) >> shift);
    }
    for (uint32_t width = 8; width > 0; width >>= 1) {
        if (rest >> (32U + 2U * width - 2U) != 0) {
            rest >>= 2U * width;
            shift += width;
        }
    }
    return (int32_t)(root_of_normalised((uint32_t)rest) << shift);
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

/* SPDX-License-Identifier: Apache-2.0 */
#include "core/reciprocal.h"

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

reciprocal_t reciprocal_of(uint16_t n)
{
    uint32_t x = n == 0 ? 1U : n;
    uint8_t shift = 0;
    if (x < 0x0100U) {
        x <<= 8;
        shift = 8;
    }
    if (x < 0x1000U) {
        x <<= 4;
        shift = (uint8_t)(shift + 4U);
    }
    if (x < 0x4000U) {
        x <<= 2;
        shift = (uint8_t)(shift + 2U);
    }
    if (x < 0x8000U) {
        x <<= 1;
        shift = (uint8_t)(shift + 1U);
    }
    const uint32_t k = (x - 0x8000U) >> 9;
    const uint32_t fraction = x & 511U;
    const uint32_t drop = (uint32_t)RECIPROCAL_TABLE[k] - RECIPROCAL_TABLE[k + 1U];
    const reciprocal_t out = {
        .mantissa = (uint16_t)(RECIPROCAL_TABLE[k] - ((drop * fraction + 256U) >> 9)),
        .shift = shift,
    };
    return out;
}

uint32_t reciprocal_scale(uint32_t x, uint16_t n)
{
    const reciprocal_t r = reciprocal_of(n);
    /* 1/n = mantissa 2^shift / 2^30 */
    return (uint32_t)(((uint64_t)x * r.mantissa) >> (30U - r.shift));
}

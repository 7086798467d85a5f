/* SPDX-License-Identifier: Apache-2.0 */
/*
 * reciprocal.h: 1/n by table, for the fast loop, which must not divide.
 *
 * n is normalised to [2^15, 2^16) by four conditional shifts, then read from 65 points with linear
 * interpolation. Relative error below 8e-5 for every n: the chord lies up to 6.1e-5 (2^-14) above
 * 1/n, the rest is the rounding of table and interpolation. Powers of two are exact. No division,
 * no loop.
 */
#ifndef CORE_RECIPROCAL_H
#define CORE_RECIPROCAL_H

#include <stdint.h>

/* x / n for 0 <= x < 2^32 and 1 <= n <= 65535: x times the reciprocal, rounded down. n = 0 counts
 * as 1. */
uint32_t reciprocal_scale(uint32_t x, uint16_t n);

#endif

/* SPDX-License-Identifier: Apache-2.0 */
/*
 * divide.h: 64-bit quotients by the powers of ten between units, without a division.
 *
 * A 32-bit core has no instruction for 64-bit divisions and calls a routine of 60 to 150
 * instructions for any divisor. These multiply by the reciprocal instead, in about 30, and are
 * exact: each is x / n, rounded towards zero, for every int64_t x, INT64_MIN included (divide.c has
 * the proof). For the slow loop.
 */
#ifndef CORE_DIVIDE_H
#define CORE_DIVIDE_H

#include <stdint.h>

/* x / 1000
 *
 * @post (x < 0 || result >= 0) && (x > 0 || result <= 0)
 *
 * @post is_within(result, INT64_MIN / 1000, INT64_MAX / 1000)
 *
 * @post is_within(x - result * 1000, -999, 999) && (x < 0 || result * 1000 <= x)
 */
int64_t divide_by_thousand(int64_t x);

/* x / 1000000: ppm, micro to one, 1e-6 mV to mV
 *
 * @post (x < 0 || result >= 0) && (x > 0 || result <= 0)
 *
 * @post is_within(result, INT64_MIN / 1000000, INT64_MAX / 1000000)
 *
 * @post is_within(x - result * 1000000, -999999, 999999)
 */
int64_t divide_by_million(int64_t x);

/* x / 1000000000: nano to one
 *
 * @post (x < 0 || result >= 0) && (x > 0 || result <= 0)
 *
 * @post is_within(result, INT64_MIN / 1000000000, INT64_MAX / 1000000000)
 *
 * @post is_within(x - result * 1000000000, -999999999, 999999999)
 */
int64_t divide_by_billion(int64_t x);

#endif

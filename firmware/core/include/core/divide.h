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

/* x / 1000 */
int64_t divide_by_thousand(int64_t x);

/* x / 1000000: ppm, micro to one, 1e-6 mV to mV */
int64_t divide_by_million(int64_t x);

/* x / 1000000000: nano to one */
int64_t divide_by_billion(int64_t x);

#endif

/* SPDX-License-Identifier: Apache-2.0 */
/*
 * grid.h: linear interpolation in a table on a uniform grid whose step is a power of two, so that
 * the index is a shift. Slow loop.
 *
 * Values are of either sign; the interpolated value never leaves the range of the neighbouring
 * points.
 */
#ifndef CORE_GRID_H
#define CORE_GRID_H

#include <stdint.h>

enum { GRID_WHOLE_Q20 = 1 << 20 };

/* Position on an axis: point `index` plus the fraction fraction_q20 / 2^20 (0 .. 2^20) of the step
 * to the next point. The widest step is 2^20, so the fraction is exact on every grid. */
typedef struct {
    int32_t index;
    int32_t fraction_q20;
} grid_position_t;

/* x: distance from the first point, in the axis' unit. Outside the axis clamped to the nearest end
 * (no extrapolation). points >= 2; 0 <= step_log2 <= 20. */
grid_position_t grid_locate(int32_t x, int32_t points, int32_t step_log2);

/* a + (b - a) fraction_q20 / 2^20, rounded to nearest (halves upwards). |a|, |b| < 2^30, which is
 * ten times the largest entry of a map, so that the difference fits 32 bits: one product of up to
 * 2^51, between 0 and 2^20 (b - a). The result lies between a and b. */
static inline int32_t grid_interpolate(int32_t a, int32_t b, int32_t fraction_q20)
{
    return a + (int32_t)(((int64_t)(b - a) * fraction_q20 + GRID_WHOLE_Q20 / 2) >> 20);
}

/* Weights of the four corners of a cell of 16-bit entries, which count in 2^lsb_log2 of the unit:
 * none negative, sum one. */
typedef struct {
    int32_t at_00, at_10, at_01, at_11; /* 16 fraction bits */
    int32_t shift;                      /* from the sum to half a unit */
} grid_weights_t;

static inline grid_weights_t grid_weights(int32_t x_q20, int32_t y_q20, int32_t lsb_log2)
{
    const int32_t x = x_q20 >> 4;
    const int32_t y = y_q20 >> 4;
    const int32_t both = (int32_t)(((int64_t)x * y + (1 << 15)) >> 16);
    const grid_weights_t out = {.at_00 = (1 << 16) - x - y + both,
                                .at_10 = x - both,
                                .at_01 = y - both,
                                .at_11 = both,
                                .shift = 15 - lsb_log2};
    return out;
}

/* Bilinear interpolation of entries, in the unit, rounded to nearest (halves upwards). The result
 * lies between the smallest and the largest corner. Entries above -2^15 keep the sum within 32
 * bits: 2^16 (2^15 - 1). */
static inline int32_t grid_weighted(const grid_weights_t *weights, int16_t at_00, int16_t at_10,
                                    int16_t at_01, int16_t at_11)
{
    const int32_t sum_q16 = weights->at_00 * at_00 + weights->at_10 * at_10 +
                            weights->at_01 * at_01 + weights->at_11 * at_11;
    return ((sum_q16 >> weights->shift) + 1) >> 1;
}

#endif

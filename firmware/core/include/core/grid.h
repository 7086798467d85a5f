/* SPDX-License-Identifier: Apache-2.0 */
/*
 * grid.h: linear interpolation in a table on a uniform grid whose step is a power of two, so that
 * the index is a shift. Slow loop.
 *
 * Values are int32_t of either sign; the interpolated value never leaves the range of the
 * neighbouring points.
 */
#ifndef CORE_GRID_H
#define CORE_GRID_H

#include <stdint.h>

enum { GRID_WHOLE_Q20 = 1 << 20 };

/* Where on an axis: between point `index` and the next, fraction_q20 / 2^20 of the way (0 .. 2^20).
 * The widest step is 2^20, so the fraction is exact on every grid. */
typedef struct {
    int32_t index;
    int32_t fraction_q20;
} grid_position_t;

/* x: distance from the first point, in the axis' unit. Outside the axis the nearest end counts (no
 * extrapolation). points >= 2; 0 <= step_log2 <= 20. */
grid_position_t grid_locate(int32_t x, int32_t points, int32_t step_log2);

/* a + (b - a) fraction_q20 / 2^20, rounded to nearest (halves upwards). Two products of up to 2^51
 * each. Both shares are >= 0, so the sum lies between 2^20 a and 2^20 b, and rounding to integers
 * does not leave two integers. */
static inline int32_t grid_interpolate(int32_t a, int32_t b, int32_t fraction_q20)
{
    const int64_t weighed_q20 =
        (int64_t)a * (GRID_WHOLE_Q20 - fraction_q20) + (int64_t)b * fraction_q20;
    return (int32_t)((weighed_q20 + GRID_WHOLE_Q20 / 2) >> 20);
}

#endif

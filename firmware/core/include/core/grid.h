/*
 * grid.h: reading a table on a uniform grid whose step is a power of two, so that the index is a shift.
 *
 * Values are int32_t of either sign; the interpolated value never leaves the range of the neighbouring points.
 */
#ifndef CORE_GRID_H
#define CORE_GRID_H

#include <stdint.h>

/* Where on an axis: between point `index` and the next, `fraction` / 2^step_log2 of the way. */
typedef struct {
    int32_t index;
    int32_t fraction;
} grid_position_t;

/* x: distance from the first point, in the axis' unit. Outside the axis the nearest end counts (no extrapolation).
 * points >= 2; 0 <= step_log2 <= 20. */
grid_position_t grid_locate(int32_t x, int32_t points, int32_t step_log2);

/* a + (b - a) fraction / 2^step_log2, rounded to nearest. */
int32_t grid_interpolate(int32_t a, int32_t b, int32_t fraction, int32_t step_log2);

#endif

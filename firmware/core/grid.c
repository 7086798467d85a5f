#include "core/grid.h"

grid_position_t grid_locate(int32_t x, int32_t points, int32_t step_log2)
{
    const int32_t intervals = points - 1;
    const int32_t step = (int32_t)(UINT32_C(1) << step_log2);
    grid_position_t position = {.index = 0, .fraction = 0};
    if (x <= 0) {
        return position;
    }
    position.index = x >> step_log2;
    if (position.index >= intervals) {
        position.index = intervals - 1;
        position.fraction = step;
        return position;
    }
    position.fraction = x & (step - 1);
    return position;
}

int32_t grid_interpolate(int32_t a, int32_t b, int32_t fraction, int32_t step_log2)
{
    const int64_t half = step_log2 > 0 ? INT64_C(1) << (step_log2 - 1) : 0;
    const int64_t scaled = ((int64_t)b - a) * fraction + half;
    return (int32_t)(a + (scaled >> step_log2));
}

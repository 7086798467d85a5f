/* SPDX-License-Identifier: Apache-2.0 */
#include "core/grid.h"

grid_position_t grid_locate(int32_t x, int32_t points, int32_t step_log2)
{
    const int32_t intervals = points - 1;
    const int32_t step = (int32_t)(UINT32_C(1) << step_log2);
    grid_position_t position = {.index = 0, .fraction_q20 = 0};
    if (x <= 0) {
        return position;
    }
    position.index = x >> step_log2;
    if (position.index >= intervals) {
        position.index = intervals - 1;
        position.fraction_q20 = GRID_WHOLE_Q20;
        return position;
    }
    position.fraction_q20 = (x & (step - 1)) * (int32_t)(UINT32_C(1) << (20 - step_log2));
    return position;
}

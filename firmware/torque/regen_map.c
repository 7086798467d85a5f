/* SPDX-License-Identifier: Apache-2.0 */
#include "torque/regen_map.h"

#include "core/grid.h"
#include "core/q15.h"

int32_t regen_map_torque_mNm(const config_t *config, int32_t speed_mrad_s,
                             int32_t winding_temperature_cC)
{
    const config_regen_map_t *map = &config->regen_map;
    const grid_position_t s =
        grid_locate(q_abs(speed_mrad_s), map->speed_points, map->speed_step_log2);
    const int32_t above_origin_cC =
        q_saturate64((int64_t)winding_temperature_cC - map->temperature_origin_cC);
    const grid_position_t t =
        grid_locate(above_origin_cC, map->temperature_points, map->temperature_step_log2);
    const int32_t *cold = &map->torque_mNm[t.index * map->speed_points + s.index];
    const int32_t *hot = cold + map->speed_points;
    const int32_t at_cold = grid_interpolate(cold[0], cold[1], s.fraction_q20);
    const int32_t at_hot = grid_interpolate(hot[0], hot[1], s.fraction_q20);
    return q_max(grid_interpolate(at_cold, at_hot, t.fraction_q20), 0);
}

/* SPDX-License-Identifier: Apache-2.0 */
#include "torque/loss_maps.h"

#include <stddef.h>

#include "core/grid.h"
#include "core/q15.h"

int32_t loss_maps_torque_mNm(const config_t *config, int32_t speed_mrad_s,
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
    /* Below the speed where regeneration begins the stored line goes on below zero, so that it is
     * straight where it begins. */
    return q_max(grid_interpolate(at_cold, at_hot, t.fraction_q20), 0);
}

/* One layer of equal temperature, read between four of its points. */
static int32_t layer_d_mA(const config_current_map_t *map, const int32_t *layer, grid_position_t s,
                          grid_position_t t)
{
    const int32_t *slow = &layer[s.index * map->torque_points + t.index];
    const int32_t *fast = slow + map->torque_points;
    const int32_t at_slow_mA = grid_interpolate(slow[0], slow[1], t.fraction_q20);
    const int32_t at_fast_mA = grid_interpolate(fast[0], fast[1], t.fraction_q20);
    return grid_interpolate(at_slow_mA, at_fast_mA, s.fraction_q20);
}

int32_t loss_maps_d_current_mA(const config_t *config, int32_t speed_mrad_s,
                               int32_t winding_temperature_cC, int32_t airgap_torque_mNm)
{
    const config_current_map_t *map = &config->current_map;
    /* Torque counts in the direction of rotation: driving is positive, braking negative. */
    const int64_t along_mNm = speed_mrad_s >= 0 ? airgap_torque_mNm : -(int64_t)airgap_torque_mNm;
    /* The middle point is zero torque; at most 32 steps of 2^20 mNm before it. */
    const int32_t zero_mNm =
        (map->torque_points / 2) * (int32_t)(UINT32_C(1) << map->torque_step_log2);
    const grid_position_t t =
        grid_locate(q_saturate64(along_mNm + zero_mNm), map->torque_points, map->torque_step_log2);
    const grid_position_t s =
        grid_locate(q_abs(speed_mrad_s), map->speed_points, map->speed_step_log2);
    if (map->temperature_points == 1) {
        return layer_d_mA(map, map->current_d_mA, s, t);
    }
    const int32_t above_origin_cC =
        q_saturate64((int64_t)winding_temperature_cC - map->temperature_origin_cC);
    const grid_position_t w =
        grid_locate(above_origin_cC, map->temperature_points, map->temperature_step_log2);
    const size_t layer_points = (size_t)map->speed_points * (size_t)map->torque_points;
    const int32_t *cold = &map->current_d_mA[(size_t)w.index * layer_points];
    const int32_t at_cold_mA = layer_d_mA(map, cold, s, t);
    const int32_t at_hot_mA = layer_d_mA(map, cold + layer_points, s, t);
    return grid_interpolate(at_cold_mA, at_hot_mA, w.fraction_q20);
}

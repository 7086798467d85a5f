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

loss_maps_row_t loss_maps_row_at(const config_t *config, int32_t speed_mrad_s,
                                 int32_t winding_temperature_cC)
{
    const config_current_map_t *map = &config->current_map;
    loss_maps_row_t row = {
        .map = map,
        .layer = map->current_d_mA,
        .speed = grid_locate(q_abs(speed_mrad_s), map->speed_points, map->speed_step_log2),
        .temperature = {.index = 0, .fraction_q20 = 0},
    };
    if (map->temperature_points > 1) {
        const int32_t above_origin_cC =
            q_saturate64((int64_t)winding_temperature_cC - map->temperature_origin_cC);
        row.temperature =
            grid_locate(above_origin_cC, map->temperature_points, map->temperature_step_log2);
        const size_t layer_points = (size_t)map->speed_points * (size_t)map->torque_points;
        row.layer = &map->current_d_mA[(size_t)row.temperature.index * layer_points];
    }
    return row;
}

/* One layer of equal temperature, read between four of its points. */
static int32_t layer_d_mA(const loss_maps_row_t *row, const int32_t *layer, grid_position_t t)
{
    const int32_t *slow = &layer[row->speed.index * row->map->torque_points + t.index];
    const int32_t *fast = slow + row->map->torque_points;
    const int32_t at_slow_mA = grid_interpolate(slow[0], slow[1], t.fraction_q20);
    const int32_t at_fast_mA = grid_interpolate(fast[0], fast[1], t.fraction_q20);
    return grid_interpolate(at_slow_mA, at_fast_mA, row->speed.fraction_q20);
}

int32_t loss_maps_row_d_mA(const loss_maps_row_t *row, int32_t along_mNm)
{
    const config_current_map_t *map = row->map;
    /* The middle point is zero torque; at most 32 steps of 2^20 mNm before it. */
    const int32_t zero_mNm =
        (map->torque_points / 2) * (int32_t)(UINT32_C(1) << map->torque_step_log2);
    const grid_position_t t = grid_locate(q_saturate64((int64_t)along_mNm + zero_mNm),
                                          map->torque_points, map->torque_step_log2);
    const int32_t at_cold_mA = layer_d_mA(row, row->layer, t);
    if (row->temperature.fraction_q20 == 0) {
        return at_cold_mA;
    }
    const size_t layer_points = (size_t)map->speed_points * (size_t)map->torque_points;
    const int32_t at_hot_mA = layer_d_mA(row, row->layer + layer_points, t);
    return grid_interpolate(at_cold_mA, at_hot_mA, row->temperature.fraction_q20);
}

int32_t loss_maps_d_current_mA(const config_t *config, int32_t speed_mrad_s,
                               int32_t winding_temperature_cC, int32_t airgap_torque_mNm)
{
    const loss_maps_row_t row = loss_maps_row_at(config, speed_mrad_s, winding_temperature_cC);
    return loss_maps_row_d_mA(&row, speed_mrad_s >= 0 ? airgap_torque_mNm
                                                      : -q_max(airgap_torque_mNm, -INT32_MAX));
}

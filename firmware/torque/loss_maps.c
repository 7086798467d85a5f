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
    /* Below the speed where regeneration begins the stored torque is negative by extrapolation, so
     * that the interpolation is exact there. */
    return q_max(grid_interpolate(at_cold, at_hot, t.fraction_q20), 0);
}

loss_maps_row_t loss_maps_row_at(const config_t *config, int32_t speed_mrad_s,
                                 int32_t winding_temperature_cC)
{
    const config_current_map_t *map = &config->current_map;
    const grid_position_t speed =
        grid_locate(q_abs(speed_mrad_s), map->speed_points, map->speed_step_log2);
    const size_t layer_points = (size_t)map->speed_points * (size_t)map->torque_points;
    /* The middle point is zero torque; at most 32 steps of 2^20 mNm before it. */
    const int32_t half = (int32_t)(UINT32_C(1) << map->torque_step_log2);
    loss_maps_row_t row = {
        .line_mA = &map->current_d_mA[(size_t)speed.index * (size_t)map->torque_points],
        .next_speed = map->torque_points,
        .next_temperature = 0,
        .speed_q20 = speed.fraction_q20,
        .temperature_q20 = 0,
        .points = map->torque_points,
        .step_log2 = map->torque_step_log2,
        .zero_mNm = (map->torque_points / 2) * half,
    };
    if (map->temperature_points > 1) {
        const grid_position_t temperature =
            grid_locate(q_saturate64((int64_t)winding_temperature_cC - map->temperature_origin_cC),
                        map->temperature_points, map->temperature_step_log2);
        row.line_mA += (size_t)temperature.index * layer_points;
        row.next_temperature = (int32_t)layer_points;
        row.temperature_q20 = temperature.fraction_q20;
    }
    return row;
}

/* At one point along torque: between two speeds, then between two temperatures. */
static inline int32_t at_torque_mA(const loss_maps_row_t *row, const int32_t *point_mA)
{
    const int32_t cold_mA =
        grid_interpolate(point_mA[0], point_mA[row->next_speed], row->speed_q20);
    if (row->temperature_q20 == 0) {
        return cold_mA;
    }
    const int32_t *hot = point_mA + row->next_temperature;
    const int32_t hot_mA = grid_interpolate(hot[0], hot[row->next_speed], row->speed_q20);
    return grid_interpolate(cold_mA, hot_mA, row->temperature_q20);
}

int32_t loss_maps_row_d_mA(const loss_maps_row_t *row, int32_t along_mNm)
{
    const grid_position_t torque =
        grid_locate(q_saturate64((int64_t)along_mNm + row->zero_mNm), row->points, row->step_log2);
    const int32_t *point_mA = &row->line_mA[torque.index];
    const int32_t below_mA = at_torque_mA(row, point_mA);
    const int32_t above_mA = at_torque_mA(row, point_mA + 1);
    return grid_interpolate(below_mA, above_mA, torque.fraction_q20);
}

int32_t loss_maps_d_current_mA(const config_t *config, int32_t speed_mrad_s,
                               int32_t winding_temperature_cC, int32_t airgap_torque_mNm)
{
    const loss_maps_row_t row = loss_maps_row_at(config, speed_mrad_s, winding_temperature_cC);
    return loss_maps_row_d_mA(&row, speed_mrad_s >= 0 ? airgap_torque_mNm
                                                      : -q_max(airgap_torque_mNm, -INT32_MAX));
}

/* SPDX-License-Identifier: Apache-2.0 */
#include "motor/loss_maps.h"

#include "core/grid.h"
#include "core/q15.h"

/* Above the first point, without overflow: 2^30 hundredths of a degree are beyond every axis. */
static inline int32_t above_cC(int32_t winding_temperature_cC, int32_t origin_cC)
{
    return q_limit(winding_temperature_cC, 1 << 30) - origin_cC;
}

int32_t loss_maps_torque_mNm(const config_t *config, int32_t speed_mrad_s,
                             int32_t winding_temperature_cC)
{
    const config_regen_map_t *map = &config->regen_map;
    const grid_position_t s =
        grid_locate(q_abs(speed_mrad_s), map->speed_points, map->speed_step_log2);
    const grid_position_t t =
        grid_locate(above_cC(winding_temperature_cC, map->temperature_origin_cC),
                    map->temperature_points, map->temperature_step_log2);
    const int16_t *cold_lsb = &map->torque_lsb[t.index * map->speed_points + s.index];
    const int16_t *hot_lsb = cold_lsb + map->speed_points;
    const grid_weights_t weights = grid_weights(s.fraction_q20, t.fraction_q20, map->lsb_log2);
    /* Below the speed where regeneration begins the stored torque is negative by extrapolation, so
     * that the interpolation is exact there. */
    return q_max(grid_weighted(&weights, cold_lsb[0], cold_lsb[1], hot_lsb[0], hot_lsb[1]), 0);
}

loss_maps_row_t loss_maps_row_at(const config_t *config, int32_t speed_mrad_s,
                                 int32_t winding_temperature_cC)
{
    const config_current_map_t *map = &config->current_map;
    const grid_position_t speed =
        grid_locate(q_abs(speed_mrad_s), map->speed_points, map->speed_step_log2);
    const int32_t layer_points = map->speed_points * map->torque_points;
    grid_position_t temperature = {.index = 0, .fraction_q20 = 0};
    if (map->temperature_points > 1) {
        temperature = grid_locate(above_cC(winding_temperature_cC, map->temperature_origin_cC),
                                  map->temperature_points, map->temperature_step_log2);
    }
    /* The middle point is zero torque; at most 32 steps of 2^20 mNm before it. */
    const int32_t step_mNm = (int32_t)(UINT32_C(1) << map->torque_step_log2);
    const int32_t first = temperature.index * layer_points + speed.index * map->torque_points;
    const loss_maps_row_t row = {
        .cold_lsb = &map->current_d_lsb[first],
        .hot_lsb = &map->current_d_lsb[first + (map->temperature_points > 1 ? layer_points : 0)],
        .weights = grid_weights(speed.fraction_q20, temperature.fraction_q20, map->lsb_log2),
        .points = map->torque_points,
        .step_log2 = map->torque_step_log2,
        .zero_mNm = (map->torque_points / 2) * step_mNm,
    };
    return row;
}

/* At one point along torque: between two speeds and two temperatures. */
static inline int32_t at_torque_mA(const loss_maps_row_t *row, int32_t point)
{
    const int16_t *cold_lsb = &row->cold_lsb[point];
    const int16_t *hot_lsb = &row->hot_lsb[point];
    return grid_weighted(&row->weights, cold_lsb[0], cold_lsb[row->points], hot_lsb[0],
                         hot_lsb[row->points]);
}

int32_t loss_maps_row_d_mA(const loss_maps_row_t *row, int32_t along_mNm)
{
    const int32_t above_first_mNm = q_limit(along_mNm, row->zero_mNm) + row->zero_mNm;
    const int32_t point = q_min(above_first_mNm >> row->step_log2, row->points - 2);
    const int32_t part_mNm = above_first_mNm - (int32_t)((uint32_t)point << row->step_log2);
    const int32_t below_mA = at_torque_mA(row, point);
    const int32_t above_mA = at_torque_mA(row, point + 1);
    return grid_interpolate(below_mA, above_mA,
                            (int32_t)((uint32_t)part_mNm << (20 - row->step_log2)));
}

int32_t loss_maps_row_rise_mA(const loss_maps_row_t *row, int32_t along_mNm)
{
    if (q_limit(along_mNm, row->zero_mNm) != along_mNm) {
        return 0;
    }
    const int32_t point = q_min((along_mNm + row->zero_mNm) >> row->step_log2, row->points - 2);
    return at_torque_mA(row, point + 1) - at_torque_mA(row, point);
}

/* SPDX-License-Identifier: Apache-2.0 */
#include "motor/loss_maps.h"

#include <stdbool.h>

#include "core/grid.h"
#include "core/q15.h"

enum {
    POINTS_MAX = 65, /* along any axis */
    LAST_CELL_OF_TORQUE = CONFIG_REGEN_POINTS_MAX - 2
};

/* Number of points along an axis. One that flips in memory changes what is read, until the check of
 * the image finds it; with this and a clamped position nothing beside the map is read. */
static inline int32_t points_of(int32_t points)
{
    return q_clamp(points, 2, POINTS_MAX);
}

/* Above the first point, without overflow: 2^30 hundredths of a degree are beyond every axis. */
static inline int32_t above_cC(int32_t winding_temperature_cC, int32_t origin_cC)
{
    return q_limit(winding_temperature_cC, 1 << 30) - origin_cC;
}

int32_t loss_maps_torque_mNm(const config_t *config, int32_t speed_mrad_s,
                             int32_t winding_temperature_cC)
{
    const config_regen_map_t *map = &config->regen_map;
    const int32_t speeds = points_of(map->speed_points);
    const grid_position_t s = grid_locate(q_abs(speed_mrad_s), speeds, map->speed_step_log2);
    const grid_position_t t =
        grid_locate(above_cC(winding_temperature_cC, map->temperature_origin_cC),
                    points_of(map->temperature_points), map->temperature_step_log2);
    const int32_t first = t.index * speeds + s.index;
    const int16_t *cold_lsb = &map->torque_lsb[q_min(first, LAST_CELL_OF_TORQUE)];
    const int16_t *hot_lsb = &map->torque_lsb[q_min(first + speeds, LAST_CELL_OF_TORQUE)];
    const grid_weights_t weights = grid_weights(s.fraction_q20, t.fraction_q20, map->lsb_log2);
    /* Below the speed where regeneration begins the stored torque is negative by extrapolation, so
     * that the interpolation is exact there. */
    return q_max(grid_weighted(&weights, cold_lsb[0], cold_lsb[1], hot_lsb[0], hot_lsb[1]), 0);
}

loss_maps_row_t loss_maps_row_at(const config_t *config, int32_t speed_mrad_s,
                                 int32_t winding_temperature_cC)
{
    const config_current_map_t *map = &config->current_map;
    const int32_t speeds = points_of(map->speed_points);
    const int32_t torques = points_of(map->torque_points);
    const grid_position_t speed = grid_locate(q_abs(speed_mrad_s), speeds, map->speed_step_log2);
    const bool warms = map->temperature_points > 1;
    grid_position_t temperature = {.index = 0, .fraction_q20 = 0};
    if (warms) {
        temperature = grid_locate(above_cC(winding_temperature_cC, map->temperature_origin_cC),
                                  points_of(map->temperature_points), map->temperature_step_log2);
    }
    /* The middle point is zero torque; at most 32 steps of 2^20 mNm before it. */
    const int32_t step_mNm = (int32_t)(UINT32_C(1) << map->torque_step_log2);
    const int32_t first = (temperature.index * speeds + speed.index) * torques;
    const int32_t last = CONFIG_CURRENT_MAP_POINTS_MAX - 2 * torques;
    const loss_maps_row_t row = {
        .cold_lsb = &map->current_d_lsb[q_min(first, last)],
        .hot_lsb = &map->current_d_lsb[q_min(first + (warms ? speeds * torques : 0), last)],
        .weights = grid_weights(speed.fraction_q20, temperature.fraction_q20, map->lsb_log2),
        .points = torques,
        .step_log2 = map->torque_step_log2,
        .zero_mNm = (torques / 2) * step_mNm,
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

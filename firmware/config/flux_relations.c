/* SPDX-License-Identifier: Apache-2.0 */
#include "flux_relations.h"

#include <stdbool.h>
#include <stddef.h>

#include "config/flux_largest.h"
#include "core/q15.h"

enum { LEAST_D_POINTS = 3, LEAST_Q_POINTS = 2 };

static bool points_fit(const config_flux_map_t *map)
{
    return map->d_points >= LEAST_D_POINTS && map->q_points >= LEAST_Q_POINTS &&
           map->d_points * map->q_points <= CONFIG_FLUX_MAP_POINTS_MAX;
}

/* Zero current is a point, and neither the first nor the last along i_d. */
static bool zero_is_inside(const config_flux_map_t *map)
{
    return map->d_negative_points > 0 && map->d_negative_points < map->d_points - 1;
}

static bool holds_current(const config_flux_map_t *map, int32_t current_mA)
{
    return (int64_t)map->d_negative_points * map->d_step_mA >= current_mA &&
           (int64_t)(map->q_points - 1) * map->q_step_mA >= current_mA;
}

/* psi_q odd in i_q: zero without i_q. */
static bool odd(const config_flux_map_t *map)
{
    bool good = true;
    for (int32_t d = 0; d < map->d_points; d++) {
        const int32_t row = d * map->q_points;
        good = good && map->psi_q_lsb[row] == 0;
    }
    return good;
}

/* Either flux rises with the current of its axis. */
static bool rises(const config_flux_map_t *map)
{
    const int32_t points = map->d_points * map->q_points;
    bool good = true;
    for (int32_t k = 0; k < points; k++) {
        const bool last_d = k + map->q_points >= points;
        const bool last_q = (k + 1) % map->q_points == 0;
        good = good && (last_d || map->psi_d_lsb[k + map->q_points] > map->psi_d_lsb[k]) &&
               (last_q || map->psi_q_lsb[k + 1] > map->psi_q_lsb[k]);
    }
    return good;
}

/* The d axis is that of the magnets. */
static bool magnets_positive(const config_flux_map_t *map)
{
    const int32_t row = map->d_negative_points * map->q_points;
    return map->psi_d_lsb[row] > 0;
}

const char *flux_map_broken(const config_t *config)
{
    const config_flux_map_t *map = &config->flux_map;
    const char *broken = NULL;
    if (map->d_points == 0) {
        return NULL;
    }
    if (!points_fit(map)) {
        broken =
            "flux_map.d_points at least 3, q_points at least 2, their product within the table";
    } else if (!zero_is_inside(map)) {
        broken = "flux_map.d_negative_points above 0 and below d_points - 1";
    } else if (!holds_current(map, config->motor.max_phase_current_mA)) {
        broken = "flux_map covers motor.max_phase_current_mA along -i_d and i_q";
    } else if (!odd(map)) {
        broken = "flux_map.psi_q_lsb zero at i_q = 0";
    } else if (!rises(map)) {
        broken = "flux_map.psi_d_lsb rises with i_d, psi_q_lsb with i_q";
    } else if (!magnets_positive(map)) {
        broken = "flux_map.psi_d_lsb above zero without current";
    }
    return broken;
}

static int32_t slope_nH(const config_flux_map_t *map, int32_t rise_lsb, int32_t step_mA)
{
    const int64_t rise_nWb = (int64_t)rise_lsb * (int32_t)(UINT32_C(1) << map->lsb_log2);
    return q_saturate64(rise_nWb * 1000 / q_divisor(step_mA));
}

int32_t config_flux_map_largest_nH(const config_t *config)
{
    const config_flux_map_t *map = &config->flux_map;
    const int32_t points = map->d_points * map->q_points;
    int32_t d_lsb = 0;
    int32_t q_lsb = 0;
    for (int32_t k = 0; k < points; k++) {
        if (k + map->q_points < points) {
            d_lsb = q_max(d_lsb, map->psi_d_lsb[k + map->q_points] - map->psi_d_lsb[k]);
        }
        if ((k + 1) % map->q_points != 0) {
            q_lsb = q_max(q_lsb, map->psi_q_lsb[k + 1] - map->psi_q_lsb[k]);
        }
    }
    return q_max(slope_nH(map, d_lsb, map->d_step_mA), slope_nH(map, q_lsb, map->q_step_mA));
}

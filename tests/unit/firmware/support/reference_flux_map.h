/* SPDX-License-Identifier: Apache-2.0 */
/*
 * reference_flux_map.h: a flux map in double precision: bilinear over its points, straight for half
 * a step beyond its ends, and the changes of flux over one step around the currents.
 */
#ifndef REFERENCE_FLUX_MAP_H
#define REFERENCE_FLUX_MAP_H

#include <math.h>

#include "config/config.h"

/* The unclamped quantities of flux_map_point_t. */
typedef struct {
    double d_nWb, q_nWb, d_nH, q_nH, cross_nH;
} reference_flux_t;

static inline double reference_clamp(double x, double low, double high)
{
    return fmin(fmax(x, low), high);
}

/* Entries at a place in steps from the first point; beyond two points along their line. */
static inline double reference_entries(const config_flux_map_t *map, const int16_t *psi_lsb,
                                       double at_d, double at_q)
{
    const int d = (int)reference_clamp(floor(at_d), 0.0, map->d_points - 2.0);
    const int q = (int)reference_clamp(floor(at_q), 0.0, map->q_points - 2.0);
    const double x = at_d - d;
    const double y = at_q - q;
    const int16_t *row = &psi_lsb[d * map->q_points + q];
    const int16_t *next = row + map->q_points;
    return (1.0 - x) * ((1.0 - y) * row[0] + y * row[1]) + x * ((1.0 - y) * next[0] + y * next[1]);
}

static inline double reference_steps_d(const config_flux_map_t *map, double i_d_mA)
{
    return reference_clamp(i_d_mA / map->d_step_mA + map->d_negative_points, -0.5,
                           map->d_points - 0.5);
}

static inline double reference_steps_q(const config_flux_map_t *map, double i_q_mA)
{
    return reference_clamp(fabs(i_q_mA) / map->q_step_mA, -0.5, map->q_points - 0.5);
}

/* i_q of zero counts as positive. In nH: nWb over a step in mA is uH. */
static inline reference_flux_t reference_flux(const config_flux_map_t *map, double i_d_mA,
                                              double i_q_mA)
{
    const double lsb = ldexp(1.0, map->lsb_log2);
    const double sign = i_q_mA < 0.0 ? -1.0 : 1.0;
    const double d = reference_steps_d(map, i_d_mA);
    const double q = reference_steps_q(map, i_q_mA);
    const double mid_d = reference_clamp(d, 0.5, map->d_points - 1.5);
    const double mid_q = reference_clamp(q, 0.5, map->q_points - 1.5);
    const int16_t *psi_d = map->psi_d_lsb;
    const int16_t *psi_q = map->psi_q_lsb;
    const double by_d = reference_entries(map, psi_d, mid_d + 0.5, q) -
                        reference_entries(map, psi_d, mid_d - 0.5, q);
    const double by_q = reference_entries(map, psi_q, d, mid_q + 0.5) -
                        reference_entries(map, psi_q, d, mid_q - 0.5);
    const double across = reference_entries(map, psi_d, d, mid_q + 0.5) -
                          reference_entries(map, psi_d, d, mid_q - 0.5);
    const reference_flux_t out = {
        .d_nWb = lsb * reference_entries(map, psi_d, d, q),
        .q_nWb = sign * lsb * reference_entries(map, psi_q, d, q),
        .d_nH = lsb * 1000.0 / map->d_step_mA * by_d,
        .q_nH = lsb * 1000.0 / map->q_step_mA * by_q,
        .cross_nH = sign * lsb * 1000.0 / map->q_step_mA * across,
    };
    return out;
}

#endif

/* SPDX-License-Identifier: Apache-2.0 */
/*
 * saturated_vehicle.h: the salient vehicle with iron that saturates: an L_q that falls to half at
 * 430 A, and axes that take flux from each other. The law is the gradient of one co-energy.
 */
#ifndef SATURATED_VEHICLE_H
#define SATURATED_VEHICLE_H

#include <math.h>

#include "paper_vehicle.h"

enum {
    SATURATED_D_POINTS = 14,
    SATURATED_D_NEGATIVE_POINTS = 11,
    SATURATED_Q_POINTS = 17,
    SATURATED_D_STEP_mA = 50000,
    SATURATED_Q_STEP_mA = 26000
};

static const double SATURATED_LSB_Wb = 8192e-9;
static const double SATURATED_CROSS =
    3e-7; /* H/A: psi_d loses half of it a squared ampere of i_q */

/* Flux linkage of the currents, without the magnets'; A, any sign. */
static inline double saturated_d_Wb(double i_d_a, double i_q_a)
{
    return 0.25e-3 * i_d_a - 0.5 * SATURATED_CROSS * i_q_a * i_q_a / (1.0 + i_q_a * i_q_a / 9e4);
}

static inline double saturated_q_Wb(double i_d_a, double i_q_a)
{
    const double bend = 1.0 + i_q_a * i_q_a / 9e4;
    return 0.65e-3 * i_q_a / hypot(1.0, i_q_a / 250.0) -
           SATURATED_CROSS * i_d_a * i_q_a / (bend * bend);
}

/* Map of up to 400 A, and 150 A more as which hot magnets act. */
static inline config_t saturated_vehicle(void)
{
    config_t config = salient_vehicle();
    config_flux_map_t *map = &config.flux_map;
    map->d_points = SATURATED_D_POINTS;
    map->d_negative_points = SATURATED_D_NEGATIVE_POINTS;
    map->d_step_mA = SATURATED_D_STEP_mA;
    map->q_points = SATURATED_Q_POINTS;
    map->q_step_mA = SATURATED_Q_STEP_mA;
    map->lsb_log2 = 13;
    for (int k = 0; k < SATURATED_D_POINTS * SATURATED_Q_POINTS; k++) {
        const int d = k / SATURATED_Q_POINTS - SATURATED_D_NEGATIVE_POINTS;
        const double i_d_a = d * SATURATED_D_STEP_mA * 1e-3;
        const double i_q_a = k % SATURATED_Q_POINTS * (SATURATED_Q_STEP_mA * 1e-3);
        const double psi_d = 1e-9 * config.motor.flux_linkage_nWb + saturated_d_Wb(i_d_a, i_q_a);
        map->psi_d_lsb[k] = (int16_t)lround(psi_d / SATURATED_LSB_Wb);
        map->psi_q_lsb[k] = (int16_t)lround(saturated_q_Wb(i_d_a, i_q_a) / SATURATED_LSB_Wb);
    }
    return config;
}

#endif

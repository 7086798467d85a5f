/* SPDX-License-Identifier: Apache-2.0 */
/*
 * paper_vehicle.h: the configuration the firmware is flashed with, as a value that a test may
 * change.
 *
 * Changed copies are not validated again: a test that steps outside config_validate() says so.
 */
#ifndef PAPER_VEHICLE_H
#define PAPER_VEHICLE_H

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#include "config/config.h"

extern const config_t CONFIG_LU2013;

/* With the 40 A of field weakening that the tests' figures are derived for. */
static inline config_t paper_vehicle(void)
{
    config_t config = CONFIG_LU2013;
    config.current_loop.field_weakening_current_pu_q15 = 7944; /* 40 A of 165 A */
    return config;
}

/* The same with i_d = 0, as the paper controls it: what torque takes can then be worked out on a
 * line. */
static inline config_t paper_vehicle_without_i_d(void)
{
    config_t config = paper_vehicle();
    memset(config.current_map.current_d_lsb, 0, sizeof config.current_map.current_d_lsb);
    return config;
}

/* i_d of the best angle, A, for a torque of either sign at standstill; by bisection on i_q. */
static inline double best_angle_d_a(const config_motor_t *m, double torque_nm)
{
    const double psi = m->flux_linkage_nWb * 1e-9;
    const double saliency = (m->q_inductance_nH - (double)m->d_inductance_nH) * 1e-9;
    double low_a = 0.0;
    double high_a = 10e3;
    double i_d_a = 0.0;
    for (int n = 0; n < 100; n++) {
        const double i_q_a = 0.5 * (low_a + high_a);
        i_d_a =
            (psi - sqrt(psi * psi + 4.0 * saliency * saliency * i_q_a * i_q_a)) / (2.0 * saliency);
        const bool enough =
            1.5 * m->pole_pairs * (psi - saliency * i_d_a) * i_q_a >= fabs(torque_nm);
        high_a = enough ? i_q_a : high_a;
        low_a = enough ? low_a : i_q_a;
    }
    return i_d_a;
}

static inline void fill_with_best_angle(config_t *config)
{
    config_current_map_t *map = &config->current_map;
    memset(map, 0, sizeof *map);
    map->torque_points = 17;
    map->torque_step_log2 = 15;
    map->speed_points = 5;
    map->speed_step_log2 = 18;
    map->temperature_points = 1;
    map->temperature_step_log2 = 6;
    map->lsb_log2 = 4; /* 16 mA: up to 524 A */
    for (int t = 0; t < 17; t++) {
        const double i_d_a = best_angle_d_a(&config->motor, (t - 8) * 32.768);
        for (int s = 0; s < 5; s++) {
            map->current_d_lsb[s * 17 + t] = (int16_t)lround(i_d_a * 1e3 / 16.0);
        }
    }
}

/* A salient 400 V traction motor in the same vehicle, of the size of a small passenger car's: what
 * surface magnets cannot show. Only the motor differs, the range of currents, and the map of i_d,
 * which is that of least current: i_d = (psi - sqrt(psi^2 + 4 s^2 i_q^2)) / (2 s), s = L_q - L_d,
 * on points of 32.768 Nm and of 262 rad/s. */
static inline config_t salient_vehicle(void)
{
    config_t config = paper_vehicle();
    config.motor.type = CONFIG_MOTOR_IPMSM;
    config.motor.pole_pairs = 4;
    config.motor.phase_resistance_uOhm = 20000;
    config.motor.d_inductance_nH = 250000;
    config.motor.q_inductance_nH = 650000;
    config.motor.flux_linkage_nWb = 90000000;
    config.motor.iron_loss_resistance_mOhm = 20000;
    config.motor.iron_loss_resistance_slope_nOhm_s = 15000000;
    config.motor.friction_torque_mNm = 400;
    config.motor.viscous_friction_uNm_s = 2000;
    config.motor.rated_torque_mNm = 120000;
    config.motor.max_torque_mNm = 220000;
    config.motor.max_power_mW = 80000000;
    config.motor.max_phase_current_mA = 400000;
    config.motor.max_speed_mrad_s = 1200000;
    config.drive.current_full_scale_mA = 500000;
    fill_with_best_angle(&config);
    /* The optimum of such a motor is beyond its largest torque at any speed worth braking from. */
    config.regen_map.lsb_log2 = 10;
    for (int k = 0; k < CONFIG_REGEN_POINTS_MAX; k++) {
        config.regen_map.torque_lsb[k] = INT16_MAX;
    }
    return config;
}

static inline int32_t mrad_s_of_rpm(double rpm)
{
    return (int32_t)lround(rpm * 2.0 * 3.14159265358979323846 / 60.0 * 1000.0);
}

#endif

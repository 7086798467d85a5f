/* SPDX-License-Identifier: Apache-2.0 */
/*
 * reference_motor.h: the motor in double precision and SI units, from circuit laws, to compare the
 * firmware's integers with. Steady state, peak phase quantities. Written forwards from the torque
 * current i_t, so that nothing is solved that the firmware solves:
 *
 *     v_d = -w L_q i_qt     v_q = w (L_d i_dt + psi)     i = i_t + v / R_i     u = R i + v
 *     T_e = 3/2 p (psi i_qt + (L_d - L_q) i_dt i_qt)     P = 3/2 (u_d i_d + u_q i_q)
 */
#ifndef REFERENCE_MOTOR_H
#define REFERENCE_MOTOR_H

#include <math.h>

#include "config/config.h"

typedef struct {
    double pole_pairs, resistance_ohm, l_d_h, l_q_h, psi_wb, w_rad_s, iron_siemens;
} reference_motor_t;

typedef struct {
    double i_d_a, i_q_a, torque_nm, power_w, copper_w, iron_w;
} reference_point_t;

static inline reference_motor_t reference_motor(const config_t *config, double speed_mrad_s,
                                                double temperature_cC)
{
    const config_motor_t *m = &config->motor;
    const double w = speed_mrad_s * 1e-3 * m->pole_pairs;
    const double iron_ohm =
        m->iron_loss_resistance_mOhm * 1e-3 + m->iron_loss_resistance_slope_nOhm_s * 1e-9 * fabs(w);
    const double rise_k = (temperature_cC - m->reference_temperature_cC) * 0.01;
    const reference_motor_t out = {
        .pole_pairs = m->pole_pairs,
        .resistance_ohm = m->phase_resistance_uOhm * 1e-6 *
                          (1.0 + m->resistance_coefficient_ppm_K * 1e-6 * rise_k),
        .l_d_h = m->d_inductance_nH * 1e-9,
        .l_q_h = m->q_inductance_nH * 1e-9,
        .psi_wb = m->flux_linkage_nWb * 1e-9 * (1.0 + m->flux_coefficient_ppm_K * 1e-6 * rise_k),
        .w_rad_s = w,
        .iron_siemens = iron_ohm > 0.0 ? 1.0 / iron_ohm : 0.0,
    };
    return out;
}

static inline reference_point_t reference_point(const reference_motor_t *m, double i_dt_a,
                                                double i_qt_a)
{
    const double v_d = -m->w_rad_s * m->l_q_h * i_qt_a;
    const double v_q = m->w_rad_s * (m->l_d_h * i_dt_a + m->psi_wb);
    reference_point_t out;
    out.i_d_a = i_dt_a + v_d * m->iron_siemens;
    out.i_q_a = i_qt_a + v_q * m->iron_siemens;
    out.torque_nm =
        1.5 * m->pole_pairs * (m->psi_wb * i_qt_a + (m->l_d_h - m->l_q_h) * i_dt_a * i_qt_a);
    const double u_d = m->resistance_ohm * out.i_d_a + v_d;
    const double u_q = m->resistance_ohm * out.i_q_a + v_q;
    out.power_w = 1.5 * (u_d * out.i_d_a + u_q * out.i_q_a);
    out.copper_w = 1.5 * m->resistance_ohm * (out.i_d_a * out.i_d_a + out.i_q_a * out.i_q_a);
    out.iron_w = 1.5 * (v_d * v_d + v_q * v_q) * m->iron_siemens;
    return out;
}

/* Loss of the bridge at a point: an ampere's, and the conducting switches'. */
static inline double reference_bridge_w(const config_t *config, reference_point_t at)
{
    const double current_a = hypot(at.i_d_a, at.i_q_a);
    return 1e-6 * config->drive.loss_per_ampere_uW_A * current_a +
           1.5e-6 * config->drive.loss_resistance_uOhm * current_a * current_a;
}

/* The point with terminal i_d = 0: there i_dt = w L_q / R_i * i_qt. */
static inline reference_point_t reference_point_without_i_d(const reference_motor_t *m,
                                                            double i_qt_a)
{
    return reference_point(m, m->w_rad_s * m->l_q_h * m->iron_siemens * i_qt_a, i_qt_a);
}

#endif

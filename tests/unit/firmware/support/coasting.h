/* SPDX-License-Identifier: Apache-2.0 */
/*
 * coasting.h: what a wheel brakes with at zero current, in double precision, from circuit laws.
 * With i = i_t + v / R_i = 0 the iron's current is the torque current: v_d = -w L_q i_qt and v_q =
 * w (L_d i_dt + psi) leave i_qt (1 + w^2 L_d L_q / R_i^2) = -w psi / R_i.
 */
#ifndef COASTING_H
#define COASTING_H

#include "reference_motor.h"

static inline double coasting_nm(const config_t *config, double speed_mrad_s, double temperature_cC)
{
    const reference_motor_t m = reference_motor(config, fabs(speed_mrad_s), temperature_cC);
    const double g = m.iron_siemens;
    const double w = m.w_rad_s;
    const double i_qt_a = -w * m.psi_wb * g / (1.0 + w * w * m.l_d_h * m.l_q_h * g * g);
    const double v_d = -w * m.l_q_h * i_qt_a;
    const reference_point_t open = reference_point(&m, -v_d * g, i_qt_a);
    const double bearings_nm = config->motor.friction_torque_mNm * 1e-3 +
                               config->motor.viscous_friction_uNm_s * 1e-9 * fabs(speed_mrad_s);
    return bearings_nm - open.torque_nm;
}

/* Rounded up, mN m; of any input. */
static inline int32_t coasting_most_mNm(const config_t *config, double speed_mrad_s,
                                        double temperature_cC)
{
    const double known_cC = fmin(fmax(temperature_cC, -30000.0), 30000.0);
    return (int32_t)fmin(1e3 * coasting_nm(config, speed_mrad_s, known_cC), 1e9) + 2;
}

#endif

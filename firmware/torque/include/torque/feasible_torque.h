/* SPDX-License-Identifier: Apache-2.0 */
/*
 * feasible_torque.h: the torques between which the voltage suffices, with field weakening at its
 * end.
 *
 * At a terminal i_d the terminal voltage is a straight line over the torque current x = i_qt
 * (motor_model.h):
 *
 *     u_d = A - X_q x        A = R i_d
 *     u_q = B + C x          B = e + X_d i_d + R (w psi/R_i + g_d i_d)      C = R (1 + g_d g_q) +
 * X_d g_q
 *
 * with X = w L, e = w psi, g = w L/R_i. It passes the origin at the distance D = (A C + B X_q)/Z,
 * Z^2 = X_q^2 + C^2, and is inside the circle |u| <= U between
 *
 *     x = (A X_q - B C)/Z^2 -+ sqrt(U^2 - D^2)/Z
 *
 * A longer |x| needs more voltage than there is. There the current loop gives u_d what it wants and
 * u_q the rest, and i_q is no longer regulated: driving, it falls back; braking, u_q is short of w
 * (L_d i_d + psi), i_q grows, w L_q i_q takes still more of the circle for u_d, and the current
 * runs to the far end of what the circle holds, at L_d i_d = -psi and |i_q| = U/(w L_q): more
 * braking torque than anybody asked for. So no torque beyond these two is ever commanded.
 *
 * i_d is the least that field weakening reaches, and no further than where the flux is gone, L_d
 * i_d = -psi: between there and the map's i_d the voltage falls all the way, so that field
 * weakening finds its point. Without D <= U no torque is safe: both ends are 0.
 */
#ifndef TORQUE_FEASIBLE_TORQUE_H
#define TORQUE_FEASIBLE_TORQUE_H

#include <stdint.h>

#include "config/config.h"
#include "torque/motor_model.h"

typedef struct {
    int32_t lowest_mNm, highest_mNm; /* shaft torque, signed; lowest <= highest */
} feasible_torque_t;

/* phase_voltage_mV: U, peak phase, magnitude. Divides and takes two roots. */
feasible_torque_t feasible_torque_at(const config_t *config, const motor_model_t *model,
                                     int32_t phase_voltage_mV);

#endif

/* SPDX-License-Identifier: Apache-2.0 */
/*
 * motor_model.h: torque, current and power of a PMSM with an iron-loss resistance across its EMF,
 * steady state, integers.
 *
 * Peak phase (amplitude-invariant) quantities; the terminal current i splits into the torque
 * current i_t and v/R_i:
 *
 *     i_d = i_dt - (w L_q / R_i) i_qt            i_q = i_qt + (w / R_i)(L_d i_dt + psi)
 *     v_d = -w L_q i_qt       v_q = w (L_d i_dt + psi)       u = R_a i + v
 *     T_e = 3/2 p [psi i_qt + (L_d - L_q) i_dt i_qt],
 *     shaft torque = T_e - friction in the direction of rotation
 *     P   = 3/2 (u_d i_d + u_q i_q),   inverter loss not included
 *
 * Sources: Urasaki et al. 2000; Lu et al. 2013 eqs (1) to (7), in peak quantities. Magnitude of
 * rounding: below 0.1 % of rated torque, 20 mA and 3 mV of either voltage. For the slow reach: it
 * divides.
 */
#ifndef TORQUE_MOTOR_MODEL_H
#define TORQUE_MOTOR_MODEL_H

#include <stdint.h>

#include "config/config.h"

/* The motor at one speed and temperature. */
typedef struct {
    int32_t speed_mrad_s; /* mechanical, signed */
    int32_t winding_temperature_cC;
    int32_t flux_nWb;         /* psi at the winding temperature, peak phase */
    int32_t emf_mV;           /* w psi, peak phase, sign of speed */
    int32_t iron_current_mA;  /* w psi / R_i, sign of speed; 0 without iron loss */
    int32_t cross_d_ppm;      /* w L_d / R_i, sign of speed */
    int32_t cross_q_ppm;      /* w L_q / R_i, sign of speed */
    int32_t one_plus_a2_ppm;  /* 1 + w^2 L_d L_q / R_i^2 */
    int32_t reactance_d_uOhm; /* w L_d, sign of speed */
    int32_t reactance_q_uOhm; /* w L_q, sign of speed */
    int32_t resistance_uOhm;  /* R_a at the winding temperature */
    int32_t friction_mNm;     /* opposes rotation: sign of speed */
} motor_model_t;

/* Terminal currents, peak phase. */
typedef struct {
    int32_t d_mA, q_mA;
} motor_current_t;

/* Terminal voltages, peak phase. */
typedef struct {
    int32_t d_mV, q_mV;
} motor_voltage_t;

motor_model_t motor_model_at(const config_t *config, int32_t speed_mrad_s,
                             int32_t winding_temperature_cC);

/* Shaft torque of terminal currents; within 1 MNm either way, so its negative is a torque, too. */
int32_t motor_model_torque_mNm(const motor_model_t *model, const config_t *config,
                               motor_current_t i);

/* The same of a terminal i_d and the torque current i_qt. */
int32_t motor_model_torque_of_i_qt_mNm(const motor_model_t *model, const config_t *config,
                                       int32_t i_d_mA, int32_t i_qt_mA);

/*
 * Terminal i_q that makes a shaft torque together with a terminal i_d. Saturates.
 *
 * i_qt = T / (3/2 p flux), and a salient motor's flux, psi + (L_d - L_q) i_dt, depends on i_d and,
 * through the iron branch, a little on i_qt. A quarter of the magnets' flux is counted on at least:
 * less is left only by an i_d against the saliency, where a torque would take current without bound
 * (and its sign beyond the zero). What is asked for then is finite, of the right sign, and more
 * than any current limit lets through: the torque falls short, it never flips.
 */
int32_t motor_model_current_q_mA(const motor_model_t *model, const config_t *config,
                                 int32_t torque_mNm, int32_t i_d_mA);

/* Terminal voltage of terminal currents. Saturates. */
motor_voltage_t motor_model_voltage(const motor_model_t *model, motor_current_t i);

/* Power at the terminals, positive into the motor. Saturates. Without the inverter's loss: what is
 * returned to the battery is a little less, which is the safe side of a charge limit. */
int32_t motor_model_power_mW(const motor_model_t *model, motor_current_t i);

#endif

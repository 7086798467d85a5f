/* SPDX-License-Identifier: Apache-2.0 */
/*
 * motor_model.h: torque, current, voltage and power of a PMSM with an iron-loss resistance across
 * its EMF, in the steady state. Equations, sources and binary scales: DERIVATIONS.md, Motor model.
 *
 * Peak phase (amplitude-invariant) quantities, means over the PWM period. The terminal current i
 * splits into the torque current i_t and the iron current v / R_i.
 *
 * Between modules currents are mA, voltages mV, torques mN m. Inside this module and
 * feasible_torque they are in binary scales ("_b"), and the direction of rotation is positive:
 * i_q and torque count along the rotation, i_d does not depend on it.
 */
#ifndef MOTOR_MOTOR_MODEL_H
#define MOTOR_MOTOR_MODEL_H

#include <stdint.h>

#include "config/config.h"
#include "core/scaled.h"

enum {
    MOTOR_MODEL_MOST_CURRENT_b = 1 << 25,
    MOTOR_MODEL_FRICTION_FULL_MRAD_S = 500 /* full Coulomb friction from here on */
};

/* Made once from the configuration: 1 unit_b = 2^-shift of the milli-unit. Values only: as part of
 * the controller's state they may be copied, saved and restored elsewhere. */
typedef struct {
    int32_t current_shift, voltage_shift, speed_shift, torque_shift;
    int32_t resistance_b, resistance_rise_b; /* at the reference; a hundredth of a kelvin, 2^16 */
    int32_t inductance_d_b, inductance_q_b;
    int32_t flux_unit_shift, inductance_unit_shift; /* of a nWb and a nH: motor_model.c */
    int32_t flux_b, flux_fall_b;          /* at the reference; a hundredth of a kelvin, 2^16 */
    int32_t iron_q16_b, iron_slope_q16_b; /* R_i at standstill, and a unit of speed's part */
    int32_t coulomb_step_q8_b,
        viscous_b;                     /* friction a mrad/s of the first half; of a unit of speed */
    int32_t torque_factor_q24;         /* torque_b = flux_b i_qt_b torque_factor */
    int32_t torque_inverse_q24;        /* 1 / torque_factor */
    int32_t current_most_b;            /* motor.max_phase_current */
    int32_t weakening_most_b;          /* current_loop.field_weakening_current */
    int32_t negligible_power_b;        /* a thousandth of motor.max_power, two thirds of it */
    int32_t loss_b, loss_resistance_b; /* two thirds of the bridge's loss, an ampere; switches */
    int32_t hall_angle_b;              /* half a period's turn for a unit of speed; 0: no halls */
} motor_constants_t;

/* The motor at one speed and temperature. Ratios, reactances and the iron conductance carry 24
 * fraction bits. With a flux map flux and inductances are those that are exact at one point of
 * currents: DERIVATIONS.md, Saturated iron. */
typedef struct {
    const motor_constants_t *constants;
    const config_t *config;
    int32_t speed_mrad_s; /* mechanical, signed */
    int32_t winding_temperature_cC;
    int32_t speed_b; /* electrical, magnitude */
    int32_t inductance_d_b, inductance_q_b;
    int32_t flux_b, saliency_b;             /* psi; L_d - L_q */
    int32_t slope_flux_b, slope_saliency_b; /* the same for the slope of the torque along the
                                               current circle */
    int32_t x_per_airgap_q23;               /* i_qt of a torque, without saliency */
    int32_t emf_b;                          /* w psi */
    int32_t reactance_d_b, reactance_q_b;   /* w L */
    int32_t resistance_b;                   /* R_a */
    int32_t cross_d, cross_q;               /* w L / R_i */
    int32_t one_plus_a2, inverse_one_plus_a2;
    int32_t flux_per_x;     /* (L_d - L_q) w L_q / R_i: flux that i_qt adds through i_dt */
    int32_t iron_current_b; /* w psi / R_i */
    int32_t friction_b;     /* >= 0, against the rotation */
    /* u_q = voltage_q + per_x i_qt + per_d i_d */
    int32_t voltage_q_b, voltage_q_per_x, voltage_q_per_d;
} motor_model_t;

/* Terminal currents, peak phase. */
typedef struct {
    int32_t d_mA, q_mA;
} motor_current_t;

/* Terminal i_d and torque current i_qt, along the rotation. */
typedef struct {
    int32_t d_b, x_b;
} motor_point_t;

/* Divides; once at start. */
void motor_constants_init(motor_constants_t *constants, const config_t *config);

/* config: that of motor_constants_init(). With a flux map exact without current. */
motor_model_t motor_model_at(const motor_constants_t *constants, const config_t *config,
                             int32_t speed_mrad_s, int32_t winding_temperature_cC);

/* Exact at terminal currents, i_q along the rotation; with constants the same everywhere. */
motor_model_t motor_model_around(const motor_constants_t *constants, const config_t *config,
                                 int32_t speed_mrad_s, int32_t winding_temperature_cC,
                                 motor_current_t around);

/* Makes a model exact at other currents. */
void motor_model_move(motor_model_t *model, motor_current_t around);

/* Terminal currents of a point, i_q along the rotation. */
motor_current_t motor_model_current(const motor_model_t *model, motor_point_t at);

/* The point of terminal currents. */
motor_point_t motor_model_point(const motor_model_t *model, motor_current_t i);

/* Shaft torque of a point. */
int32_t motor_model_torque_mNm(const motor_model_t *model, motor_point_t at);

/* Direct current of a point at a bus voltage, positive out of the battery: of motor and resistance
 * of the switches, which the applied voltage shows, and of what switching loses. */
int32_t motor_model_bus_current_mA(const motor_model_t *model, motor_point_t at, int32_t bus_mV);

int32_t motor_model_switching_current_mA(const motor_model_t *model, motor_point_t at,
                                         int32_t bus_mV);

/* ---- in binary scales ---- */

/* Clamped to a limit of at least four times the phase current limit. current_shift > 0. */
static inline int32_t motor_model_current_b(const motor_constants_t *constants, int32_t current_mA)
{
    const int32_t shift = constants->current_shift;
    return q_limit(current_mA, MOTOR_MODEL_MOST_CURRENT_b >> shift) * (int32_t)(1U << shift);
}

static inline int32_t motor_model_current_mA(const motor_constants_t *constants, int32_t current_b)
{
    return current_b >> constants->current_shift;
}

/* Magnitude of a current, within 3 %. */
static inline int32_t motor_model_magnitude_b(int32_t i_d_b, int32_t i_q_b)
{
    const int32_t large_b = q_max(q_abs(i_d_b), q_abs(i_q_b));
    const int32_t small_b = q_min(q_abs(i_d_b), q_abs(i_q_b));
    return q_max(large_b, large_b - (large_b >> 3) + (small_b >> 1));
}

/* Two thirds of the bridge's loss at a current >= 0, in the scale of u_d i_d + u_q i_q. */
static inline int32_t motor_model_bridge_loss_b(const motor_constants_t *constants,
                                                int32_t current_b)
{
    const int32_t volts_b = scaled_multiply(constants->loss_resistance_b, current_b);
    return scaled_multiply(current_b, constants->loss_b + volts_b);
}

/* Airgap torque of a point, along the rotation. */
int32_t motor_model_airgap_b(const motor_model_t *model, motor_point_t at);

/* i_qt that makes an airgap torque with a terminal i_d, both along the rotation. The effective flux
 * is taken as at least a quarter of the magnet flux and at least half of the flux at this i_d. It
 * is lower only where i_d or i_q acts against the saliency; there no current gives the torque, and
 * the result is finite, has the correct sign and gives less torque. */
int32_t motor_model_x_of_airgap_b(const motor_model_t *model, int32_t airgap_b, int32_t d_b);

/* Derivative of the airgap torque with respect to i_qt, 24 fraction bits. */
int32_t motor_model_airgap_per_x(const motor_model_t *model, motor_point_t at);
/* Derivative of the airgap torque with respect to i_d, 24 fraction bits. */
int32_t motor_model_airgap_per_d(const motor_model_t *model, motor_point_t at);

/* Derivative of i_qt with respect to i_d at constant torque; zero without saliency. */
int32_t motor_model_x_per_d(const motor_model_t *model, motor_point_t at);

/* Terminal i_q of a point, and i_qt of terminal currents. */
static inline int32_t motor_model_i_q_b(const motor_model_t *model, motor_point_t at)
{
    return scaled_dot(model->one_plus_a2, at.x_b, model->cross_d, at.d_b) + model->iron_current_b;
}

/* i_qt of terminal currents. */
static inline int32_t motor_model_x_of_i_q_b(const motor_model_t *model, int32_t i_q_b, int32_t d_b)
{
    return scaled_multiply(model->inverse_one_plus_a2,
                           i_q_b - model->iron_current_b - scaled_multiply(model->cross_d, d_b));
}

/* Terminal voltages. */
static inline int32_t motor_model_u_d_b(const motor_model_t *model, motor_point_t at)
{
    return scaled_dot(model->resistance_b, at.d_b, -model->reactance_q_b, at.x_b);
}

static inline int32_t motor_model_u_q_b(const motor_model_t *model, motor_point_t at)
{
    return model->voltage_q_b +
           scaled_dot(model->voltage_q_per_x, at.x_b, model->voltage_q_per_d, at.d_b);
}

/* Shaft torque, signed, of an airgap torque along the rotation; and back. */
int32_t motor_model_shaft_mNm(const motor_model_t *model, int32_t airgap_b);

int32_t motor_model_airgap_of_shaft_b(const motor_model_t *model, int32_t shaft_mNm);

#endif

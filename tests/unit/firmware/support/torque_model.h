/* SPDX-License-Identifier: Apache-2.0 */
/*
 * torque_model.h: motor model and d-current map of a configuration for tests, and the binary scales
 * in SI units.
 */
#ifndef TORQUE_MODEL_H
#define TORQUE_MODEL_H

#include <math.h>

#include "core/q15.h"
#include "motor/loss_maps.h"
#include "motor/motor_model.h"

/* Each model keeps its own constants; the latest eight of them stay valid. */
static inline motor_model_t model_at(const config_t *config, int32_t speed_mrad_s,
                                     int32_t winding_temperature_cC)
{
    static motor_constants_t constants[8];
    static int next;
    next = (next + 1) % 8;
    motor_constants_init(&constants[next], config);
    return motor_model_at(&constants[next], config, speed_mrad_s, winding_temperature_cC);
}

/* Terminal i_q that makes a shaft torque together with a terminal i_d; signed, positive forward. */
static inline int32_t model_q_mA(const motor_model_t *model, int32_t torque_mNm, int32_t d_mA)
{
    const int32_t airgap_b = motor_model_airgap_of_shaft_b(model, torque_mNm);
    motor_point_t at = {.d_b = motor_model_current_b(model->constants, d_mA), .x_b = 0};
    at.x_b = motor_model_x_of_airgap_b(model, airgap_b, at.d_b);
    const int32_t along_mA = motor_model_current_mA(model->constants, motor_model_i_q_b(model, at));
    return model->speed_mrad_s >= 0 ? along_mA : -along_mA;
}

/* i_d of the map for an airgap torque, signed, positive forward. */
static inline int32_t map_d_mA(const config_t *config, int32_t speed_mrad_s, int32_t winding_cC,
                               int32_t airgap_mNm)
{
    const loss_maps_row_t row = loss_maps_row_at(config, speed_mrad_s, winding_cC);
    return loss_maps_row_d_mA(&row,
                              speed_mrad_s >= 0 ? airgap_mNm : -q_max(airgap_mNm, -INT32_MAX));
}

static inline double model_current_mA(const motor_model_t *model, int32_t current_b)
{
    return ldexp(current_b, -model->constants->current_shift);
}

static inline double model_voltage_mV(const motor_model_t *model, int32_t voltage_b)
{
    return ldexp(voltage_b, -model->constants->voltage_shift);
}

static inline double model_friction_mNm(const motor_model_t *model)
{
    const double along_mNm = ldexp(model->friction_b, -model->constants->torque_shift);
    return model->speed_mrad_s >= 0 ? along_mNm : -along_mNm;
}

static inline double model_resistance_uOhm(const motor_model_t *model)
{
    const motor_constants_t *k = model->constants;
    return 1e6 * ldexp(model->resistance_b, k->current_shift - k->voltage_shift - 24);
}

static inline double model_flux_nWb(const motor_model_t *model)
{
    const motor_constants_t *k = model->constants;
    return 1e9 * ldexp(model->flux_b, k->speed_shift - k->voltage_shift - 24);
}

/* A point of terminal currents in milliamperes, i_q signed forward. */
static inline motor_point_t model_point(const motor_model_t *model, double d_mA, double q_mA)
{
    const motor_constants_t *k = model->constants;
    const double along_mA = model->speed_mrad_s >= 0 ? q_mA : -q_mA;
    const int32_t d_b = (int32_t)lround(ldexp(d_mA, k->current_shift));
    const int32_t q_b = (int32_t)lround(ldexp(along_mA, k->current_shift));
    const motor_point_t out = {.d_b = d_b, .x_b = motor_model_x_of_i_q_b(model, q_b, d_b)};
    return out;
}

#endif

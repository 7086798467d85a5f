/* SPDX-License-Identifier: Apache-2.0 */
#include "torque/current_setpoint.h"

#include "config/bases.h"
#include "core/q15.h"
#include "torque/feasible_torque.h"
#include "torque/loss_maps.h"

/* The map's i_d; on the current circle the one that still makes the torque. */
static int32_t least_loss_d_b(const motor_model_t *model, int32_t airgap_b)
{
    const motor_constants_t *k = model->constants;
    const loss_maps_row_t row =
        loss_maps_row_at(model->config, model->speed_mrad_s, model->winding_temperature_cC);
    const int32_t map_b = motor_model_current_b(
        k, loss_maps_row_d_mA(&row, scaled_shift(airgap_b, -k->torque_shift)));
    const motor_point_t at = {.d_b = map_b,
                              .x_b = motor_model_x_of_airgap_b(model, airgap_b, map_b)};
    const int64_t i_q_b = motor_model_i_q_b(model, at);
    const int64_t most_b = k->current_most_b;
    return (int64_t)map_b * map_b + i_q_b * i_q_b > most_b * most_b
               ? feasible_circle_d_b(model, airgap_b, map_b)
               : map_b;
}

current_setpoint_t current_setpoint_step(const motor_model_t *model, int32_t torque_mNm,
                                         int32_t i_d_weakening_mA)
{
    const config_t *config = model->config;
    const int32_t most_mA = config->motor.max_phase_current_mA;
    const int32_t weakest_mA =
        bases_current_mA(config, config->current_loop.field_weakening_current_pu_q15);
    const int32_t weakening_mA = q_clamp(i_d_weakening_mA, -weakest_mA, 0);
    const int32_t airgap_b = motor_model_airgap_of_shaft_b(model, torque_mNm);
    const int32_t map_mA =
        motor_model_current_mA(model->constants, least_loss_d_b(model, airgap_b));
    const int32_t d_mA = q_limit(q_max(map_mA + weakening_mA, q_min(map_mA, -weakest_mA)), most_mA);
    const int32_t q_mA = motor_model_current_q_mA(model, torque_mNm, d_mA);
    const int32_t left_mA = scaled_root((int64_t)most_mA * most_mA - (int64_t)d_mA * d_mA);
    const current_setpoint_t out = {
        .i_d_mA = q_limit(d_mA - weakening_mA, most_mA),
        .i_q_mA = q_limit(q_mA, left_mA),
        .limited = q_abs(q_mA) > left_mA + most_mA / 256,
    };
    return out;
}

/* SPDX-License-Identifier: Apache-2.0 */
#include "tables.h"

#include "config/bases.h"
#include "motor/feasible_torque.h"
#include "motor/loss_maps.h"
#include "motor/motor_model.h"

int32_t tables_best_braking_mNm(const config_t *config, int32_t speed_mrad_s,
                                int32_t winding_temperature_cC)
{
    return loss_maps_torque_mNm(config, speed_mrad_s, winding_temperature_cC);
}

tables_current_t tables_currents(const config_t *config, int32_t speed_mrad_s,
                                 int32_t winding_temperature_cC, int32_t airgap_torque_mNm)
{
    motor_constants_t constants;
    motor_constants_init(&constants, config);
    const motor_model_t model =
        motor_model_at(&constants, config, speed_mrad_s, winding_temperature_cC);
    const int32_t forward = speed_mrad_s >= 0 ? 1 : -1;
    const int32_t along_mNm = forward * airgap_torque_mNm;
    const loss_maps_row_t row = loss_maps_row_at(config, speed_mrad_s, winding_temperature_cC);
    const int32_t d_mA = loss_maps_row_d_mA(&row, along_mNm);
    motor_point_t at = {.d_b = motor_model_current_b(&constants, d_mA), .x_b = 0};
    at.x_b =
        motor_model_x_of_airgap_b(&model, scaled_shift(along_mNm, constants.torque_shift), at.d_b);
    const int32_t q_mA = motor_model_current_mA(&constants, motor_model_i_q_b(&model, at));
    const tables_current_t out = {.d_mA = d_mA, .q_mA = forward * q_mA};
    return out;
}

tables_voltage_t tables_voltage_limit(const config_t *config, int32_t speed_mrad_s,
                                      int32_t winding_temperature_cC, int32_t phase_voltage_mV)
{
    motor_constants_t constants;
    motor_constants_init(&constants, config);
    const motor_model_t model =
        motor_model_at(&constants, config, speed_mrad_s, winding_temperature_cC);
    const feasible_set_t set = feasible_set_at(&model, phase_voltage_mV);
    const int32_t cap_mNm = 3 * config->motor.max_torque_mNm;
    feasible_side_t driving = feasible_side_at(&set, SIDE_DRIVING, cap_mNm);
    feasible_side_t braking = feasible_side_at(&set, SIDE_BRAKING, cap_mNm);
    /* Unbounded stands for three times the largest torque. */
    const int32_t driving_mNm = q_min(feasible_by_voltage_mNm(&driving), cap_mNm);
    const int32_t braking_mNm = q_min(feasible_by_voltage_mNm(&braking), cap_mNm);
    const int32_t friction_mNm = scaled_shift(model.friction_b, -constants.torque_shift);
    const bool forward = speed_mrad_s >= 0;
    const int32_t along_mNm = forward ? friction_mNm : -friction_mNm;
    const tables_voltage_t out = {
        .lowest_mNm = (forward ? -braking_mNm : -driving_mNm) + along_mNm,
        .highest_mNm = (forward ? driving_mNm : braking_mNm) + along_mNm,
        .weakest_d_mA = motor_model_current_mA(&constants, set.weakest_d_b),
    };
    return out;
}

/* SPDX-License-Identifier: Apache-2.0 */
#include "tables.h"

#include "config/bases.h"
#include "torque/current_setpoint.h"
#include "torque/feasible_torque.h"
#include "torque/loss_maps.h"
#include "torque/motor_model.h"

int32_t tables_best_braking_mNm(const config_t *config, int32_t speed_mrad_s,
                                int32_t winding_temperature_cC)
{
    return loss_maps_torque_mNm(config, speed_mrad_s, winding_temperature_cC);
}

tables_current_t tables_currents(const config_t *config, int32_t speed_mrad_s,
                                 int32_t winding_temperature_cC, int32_t airgap_torque_mNm)
{
    const motor_model_t model = motor_model_at(config, speed_mrad_s, winding_temperature_cC);
    const int32_t shaft_mNm = airgap_torque_mNm - model.friction_mNm;
    const motor_current_t i = current_setpoint_unlimited(config, &model, shaft_mNm, 0);
    const tables_current_t out = {.d_mA = i.d_mA, .q_mA = i.q_mA};
    return out;
}

tables_voltage_t tables_voltage_limit(const config_t *config, int32_t speed_mrad_s,
                                      int32_t winding_temperature_cC, int32_t phase_voltage_mV)
{
    const motor_model_t model = motor_model_at(config, speed_mrad_s, winding_temperature_cC);
    const feasible_torque_t limit = feasible_torque_at(config, &model, phase_voltage_mV);
    const tables_voltage_t out = {
        .lowest_mNm = limit.lowest_mNm + model.friction_mNm,
        .highest_mNm = limit.highest_mNm + model.friction_mNm,
        .weakest_d_mA =
            -bases_current_mA(config, config->current_loop.field_weakening_current_pu_q15),
    };
    return out;
}

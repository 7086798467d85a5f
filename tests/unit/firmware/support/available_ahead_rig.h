/* SPDX-License-Identifier: Apache-2.0 */
/*
 * available_ahead_rig.h: a step of available_ahead from flat inputs.
 */
#ifndef AVAILABLE_AHEAD_RIG_H
#define AVAILABLE_AHEAD_RIG_H

#include "torque/available_ahead.h"

static inline void ahead_step(available_ahead_state_t *state, const motor_constants_t *motor,
                              const config_t *config, const torque_limits_t *limits,
                              const available_inputs_t *in, int32_t brake_torque_mNm)
{
    const measured_t now = {.speed_mrad_s = in->speed_mrad_s,
                            .winding_temperature_cC = in->winding_temperature_cC,
                            .switch_temperature_cC = in->switch_temperature_cC,
                            .sensed = {.winding_cC = in->winding_temperature_cC,
                                       .switch_cC = in->switch_temperature_cC}};
    available_ahead_step(state, motor, config, limits, &now, in->phase_voltage_mV,
                         brake_torque_mNm);
}

#endif

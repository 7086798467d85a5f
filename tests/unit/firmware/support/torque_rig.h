/* SPDX-License-Identifier: Apache-2.0 */
/* The slow loop of the paper's vehicle with an ideal motor: the measured current of the next step
 * is this step's setpoint. */
#ifndef SUPPORT_TORQUE_RIG_H
#define SUPPORT_TORQUE_RIG_H

#include "paper_vehicle.h"
#include "reference_motor.h"
#include "torque/torque.h"

static config_t config;
static torque_state_t state;
static torque_input_t in;

static const torque_enable_t FULL_ENABLE = {
    .drive_q15 = Q15_ONE, .brake_q15 = Q15_ONE, .reason = REASON_NONE};

/* 150 r/min, no limit within reach, everything enabled, no demand. */
static inline void torque_rig_reset(void)
{
    const torque_input_t rolling = {
        .speed_mrad_s = mrad_s_of_rpm(150.0),
        .bus_voltage_mV = 53000,
        .phase_voltage_mV = 1000000,
        .bms_charge_current_mA = 1000000,
        .bms_discharge_current_mA = 1000000,
        .winding_temperature_cC = 2500,
        .switch_temperature_cC = 2500,
        .rotor_valid = true,
        .torque_enable = FULL_ENABLE,
    };
    config = paper_vehicle();
    config.brake.loss_braking = 0;
    torque_init(&state, &config);
    in = rolling;
}

static inline torque_output_t step(void)
{
    const torque_output_t out = torque_step(&state, &config, &in);
    in.current.d_mA = out.current.i_d_mA + in.i_d_weakening_mA;
    in.current.q_mA = out.current.i_q_mA;
    return out;
}

#endif

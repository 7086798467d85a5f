/* SPDX-License-Identifier: Apache-2.0 */
/* Machines the plant's tests use: round numbers, every parameter different, nothing taken from the
 * code under test. */
#ifndef TEST_MACHINES_H
#define TEST_MACHINES_H

#include "plant/pmsm.h"

/* A salient machine with iron loss. */
static inline pmsm_params_t salient_machine(void)
{
    const pmsm_params_t out = {
        .pole_pairs = 7.0,
        .phase_resistance_ohm = 0.05,
        .reference_temperature_c = 25.0,
        .resistance_temperature_coefficient_per_k = 0.00393,
        .d_inductance_h = 150e-6,
        .q_inductance_h = 230e-6,
        .flux_linkage_wb = 0.02,
        .iron_loss_resistance_ohm = 2.0,
        .iron_loss_resistance_slope_ohm_s = 0.005,
    };
    return out;
}

/* A round rotor without iron loss: the textbook machine. */
static inline pmsm_params_t plain_machine(void)
{
    pmsm_params_t out = salient_machine();
    out.q_inductance_h = out.d_inductance_h;
    out.iron_loss_resistance_ohm = 0.0;
    out.iron_loss_resistance_slope_ohm_s = 0.0;
    return out;
}

/* The salient one with iron that saturates, of both axes together and filled by the magnets, and
 * with cogging. */
static inline pmsm_params_t saturating_machine(void)
{
    pmsm_params_t out = salient_machine();
    out.d_saturation_current_a = 90.0;
    out.q_saturation_current_a = 70.0;
    out.cross_saturation = 0.7;
    out.magnet_bias_current_a = 18.0;
    out.cogging_torque_nm = 0.6;
    out.cogging_per_turn = 84.0;
    out.cogging_deg = 30.0;
    return out;
}

#endif

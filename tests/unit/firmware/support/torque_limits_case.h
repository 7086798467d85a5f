/* SPDX-License-Identifier: Apache-2.0 */
/*
 * torque_limits_case.h: one step of the table of torque limits from a flat input.
 */
#ifndef TORQUE_LIMITS_CASE_H
#define TORQUE_LIMITS_CASE_H

#include "torque/torque_limits.h"

/* What torque_limits_step() reads of its records. */
typedef struct {
    int32_t brake_torque_mNm; /* demanded, magnitude */
    int32_t bus_voltage_mV;
    int32_t battery_voltage_mV; /* where it contradicts the bus voltage; 0: it does not */
    int32_t bus_current_mA;
    int32_t charge_beyond_mA;
    int32_t current_missing_q15;
    int32_t bms_charge_current_mA, bms_discharge_current_mA, bms_charge_peak_mA;
    int32_t switch_temperature_cC;
    bool only_modelled; /* no sensor shows the temperatures */
    int32_t lasting_mA;
    bool angle_valid;
    bool abs_active;
    uint8_t abs_share_percent;
    torque_enable_t torque_enable;
} torque_limits_case_t;

static inline slow_input_t torque_limits_case_input(const torque_limits_case_t *at)
{
    const slow_input_t out = {
        .demand = {.brake_torque_mNm = at->brake_torque_mNm,
                   .abs_active = at->abs_active,
                   .abs_motor_share_percent = at->abs_share_percent},
        .bms = {.charge_current_mA = at->bms_charge_current_mA,
                .discharge_current_mA = at->bms_discharge_current_mA,
                .charge_peak_current_mA = at->bms_charge_peak_mA},
    };
    return out;
}

static inline void torque_limits_case_step(torque_limits_state_t *state, const feasible_set_t *set,
                                           const torque_limits_case_t *at, torque_limits_t *table)
{
    const slow_input_t sent = torque_limits_case_input(at);
    const wheel_temperatures_t sensed = {
        .winding_cC = at->only_modelled ? TEMPERATURE_NONE_cC : set->model->winding_temperature_cC,
        .switch_cC = at->only_modelled ? TEMPERATURE_NONE_cC : at->switch_temperature_cC};
    const measured_t now = {.in = &sent,
                            .battery = &sent.bms,
                            .angle_valid = at->angle_valid,
                            .bus_voltage_mV = at->bus_voltage_mV,
                            .bus_current_mA = at->bus_current_mA,
                            .switch_temperature_cC = at->switch_temperature_cC,
                            .sensed = sensed,
                            .winding_lasting_mA = at->lasting_mA,
                            .switch_lasting_mA = at->lasting_mA};
    const torque_limits_input_t in = {.brake_torque_mNm = at->brake_torque_mNm,
                                      .battery_voltage_mV = at->battery_voltage_mV,
                                      .charge_beyond_mA = at->charge_beyond_mA,
                                      .current_missing_q15 = at->current_missing_q15};
    motor_model_t model = *set->model;
    feasible_set_t own = *set;
    own.model = &model;
    torque_limits_step(state, &model, &own, &now, &at->torque_enable, &in, table);
}

#endif

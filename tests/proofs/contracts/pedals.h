/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Needs (PRE) and guarantees (POST) of the functions of pedals, one clause a line: a C expression
 * of the parameters; `result` is what is returned, old(expression) a value before the call.
 * contracts.py reads them together with the prototypes of the headers.
 */
/* clang-format off */

/* pedals/pedals.h */
POST(pedals_init, state->must_release && state->no_brake_ms == INT32_MAX && !state->was_received)
POST(pedals_init, !state->accelerator_fault && !state->brake_fault &&
     state->accelerator_fault_halves == 0 && state->brake_fault_halves == 0 &&
     state->brake_travel_q15 == 0)

PRE(pedals_step, every(i, CONFIG_PEDAL_CHANNELS, is_within(config->pedals.released_q15[i], 0, 32768)
     && is_within(config->pedals.pressed_q15[i], 0, 32768) && config->pedals.pressed_q15[i] !=
     config->pedals.released_q15[i]))
PRE(pedals_step, every(i, CONFIG_PEDAL_CHANNELS, config->pedals.lowest_q15[i] >= 0 &&
     config->pedals.highest_q15[i] <= 32768))
PRE(pedals_step, config->pedals.free_travel_torque_mNm <= config->pedals.brake_torque_mNm)
PRE(pedals_step, is_within(state->accelerator_fault_halves, 0, 2 * config->pedals.fault_time_ms) &&
     is_within(state->brake_fault_halves, 0, 2 * config->pedals.fault_time_ms) &&
     state->no_brake_ms >= 0 && is_within(state->brake_travel_q15, 0, 32768))
POST(pedals_step, is_within(state->accelerator_fault_halves, 0, 2 * config->pedals.fault_time_ms) &&
     is_within(state->brake_fault_halves, 0, 2 * config->pedals.fault_time_ms) &&
     state->no_brake_ms >= 0 && is_within(state->brake_travel_q15, 0, 32768))
POST(pedals_step, config->pedals.brake_channels == 0 || is_within(result.demand.brake_torque_mNm, 0,
     config->pedals.brake_torque_mNm))
POST(pedals_step, config->pedals.accelerator_channels == 0 || q_abs(result.demand.drive_torque_mNm)
     <= q_max(config->pedals.drive_torque_mNm, config->pedals.lift_off_torque_mNm))
POST(pedals_step, config->pedals.accelerator_channels == 0 || !(state->must_release ||
     state->accelerator_fault) || result.demand.drive_torque_mNm *
     drive_direction_sign(result.demand.direction) <= 0)
POST(pedals_step, !state->brake_fault || result.demand.reason == REASON_BRAKE_PEDAL_SENSOR)
POST(pedals_step, config->pedals.brake_channels == 0 || state->no_brake_ms <
     config->pedals.fault_time_ms || result.age_ms == UINT32_MAX)

PRE(pedals_wheel_demand, is_within(wheel, 0, CONFIG_WHEELS - 1) &&
     is_within(config->pedals.drive_share_q15[wheel], 0, 32768) &&
     is_within(config->pedals.brake_share_q15[wheel], 0, 32768))
POST(pedals_wheel_demand, q_abs(result.drive_torque_mNm) <= q_abs(demand->drive_torque_mNm) &&
     q_abs(result.brake_torque_mNm) <= q_abs(demand->brake_torque_mNm))
POST(pedals_wheel_demand, result.direction == demand->direction && result.enable == demand->enable
     && result.abs_active == demand->abs_active && result.reason == demand->reason)
POST(pedals_wheel_demand, demand->brake_torque_mNm < 0 || result.brake_torque_mNm >= 0)

PRE(pedals_brake_torque_mNm, is_within(travel_q15, 0, 32768) && is_within(pedals->free_travel_q15,
     328, 32440))
PRE(pedals_brake_torque_mNm, is_within(pedals->free_travel_torque_mNm, 0, pedals->brake_torque_mNm))
POST(pedals_brake_torque_mNm, is_within(result, 0, pedals->brake_torque_mNm))
POST(pedals_brake_torque_mNm, travel_q15 != 32768 || result == pedals->brake_torque_mNm)

POST(pedals_wired, result || (config->pedals.accelerator_channels == 0 &&
     config->pedals.brake_channels == 0))
POST(pedals_wired, !result || config->pedals.accelerator_channels + config->pedals.brake_channels >
     0)

/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Needs (PRE) and guarantees (POST) of the functions of motor, one clause a line: a C expression
 * of the parameters; `result` is what is returned, old(expression) a value before the call.
 * contracts.py reads them together with the prototypes of the headers.
 */
/* clang-format off */

/* motor/current_setpoint.h */
PRE(current_setpoint_step, model_shifts_hold(set->model->constants) &&
     is_within(set->model->friction_b, 0, 1 << 26))
PRE(current_setpoint_step, is_within(set->model->constants->weakening_most_b, 0,
     MOTOR_MODEL_MOST_CURRENT_b))
PRE(current_setpoint_step, is_within(set->model->flux_b, 0, 1 << 26) &&
     is_within(set->model->constants->torque_factor_q24, 0, 2 * SCALED_ONE))
POST(current_setpoint_step, is_within(result.i_d_mA,
     -set->model->config->motor.max_phase_current_mA,
     set->model->config->motor.max_phase_current_mA))
POST(current_setpoint_step, result.forced_mNm >= 0)

/* motor/feasible_ellipse.h */
POST(feasible_ellipse_root, is_within(*t_b, -(1 << 25), (1 << 25) - 1))

POST(feasible_weaken_cap, side->sign == old(side->sign) && side->cap_mNm == old(side->cap_mNm))

POST(feasible_circle_d_b, set->model->slope_saliency_b != 0 ||
     !is_within(set->model->constants->current_most_b, 0, MOTOR_MODEL_MOST_CURRENT_b) ||
     is_within(result, -MOTOR_MODEL_MOST_CURRENT_b, MOTOR_MODEL_MOST_CURRENT_b))

/* motor/feasible_torque.h */
PRE(feasible_set_at, model_shifts_hold(model->constants))
PRE(feasible_set_at, is_within(model->constants->current_most_b, 0, MOTOR_MODEL_MOST_CURRENT_b) &&
     model->constants->weakening_most_b >= 0)
POST(feasible_set_at, result.model == model && result.weakest_d_b <= 0 && result.voltage_squared >=
     0)
POST(feasible_set_at, phase_voltage_mV > 0 || result.voltage_squared == 0)

PRE(feasible_set_around, set->model == model && motor_constants_hold(model->constants) &&
     motor_model_holds(model))
PRE(feasible_set_around, set->weakest_d_b <= 0 && set->voltage_squared >= 0)
POST(feasible_set_around, set->model == model && model->config == old(model->config) &&
     model->constants == old(model->constants) && model->speed_mrad_s == old(model->speed_mrad_s) &&
     model->winding_temperature_cC == old(model->winding_temperature_cC))
POST(feasible_set_around, model->friction_b == old(model->friction_b) && motor_model_holds(model))
POST(feasible_set_around, set->weakest_d_b <= 0 && set->voltage_squared ==
     old(set->voltage_squared))

PRE(feasible_side_at, model_shifts_hold(set->model->constants))
POST(feasible_side_at, result.set == set && result.sign == (int32_t)sign && result.cap_mNm ==
     cap_mNm)

PRE(feasible_by_voltage_mNm, model_shifts_hold(side->set->model->constants))
PRE(feasible_by_voltage_mNm, is_a_sign(side->sign))
PRE(feasible_by_voltage_mNm, side->cap_mNm >= 0)
POST(feasible_by_voltage_mNm, result >= 0 && side->cap_has_voltage && side->sign == old(side->sign))
POST(feasible_by_voltage_mNm, is_within(side->cap_mNm, 0, old(side->cap_mNm)) && (result >=
     old(side->cap_mNm) || side->cap_mNm == result))
POST(feasible_by_voltage_mNm, !old(side->cap_has_voltage) || result == FEASIBLE_UNBOUNDED)

PRE(feasible_by_current_mNm, model_shifts_hold(side->set->model->constants))
PRE(feasible_by_current_mNm, is_a_sign(side->sign))
PRE(feasible_by_current_mNm, side->cap_mNm >= 0)
POST(feasible_by_current_mNm, result >= 0 && side->sign == old(side->sign) &&
     is_within(side->cap_mNm, 0, old(side->cap_mNm)))

PRE(feasible_by_voltage_and_current, model_shifts_hold(side->set->model->constants))
PRE(feasible_by_voltage_and_current, is_a_sign(side->sign))
PRE(feasible_by_voltage_and_current, side->cap_mNm >= 0)
POST(feasible_by_voltage_and_current, result.voltage_mNm >= 0 && result.current_mNm >= 0 &&
     side->sign == old(side->sign) && is_within(side->cap_mNm, 0, old(side->cap_mNm)))

POST(feasible_excess_b, at.d_b != 0 || at.x_b != 0 || set->model->iron_current_b != 0 ||
     returned.power_b < 0 || is_within(result, set->power.c, q_saturate64((int64_t)set->power.c +
     returned.power_b)))
POST(feasible_excess_b, at.d_b != 0 || at.x_b != 0 || set->model->iron_current_b != 0 ||
     set->model->constants->hall_angle_b != 0 || result == q_saturate64((int64_t)set->power.c +
     returned.power_b))

PRE(feasible_magnitude_mNm, model_shifts_hold(side->set->model->constants))
PRE(feasible_magnitude_mNm, is_a_sign(side->sign))
POST(feasible_magnitude_mNm, result >= 0 && (side->sign * (airgap_b - side->set->model->friction_b)
     > 0 || result == 0))

PRE(feasible_power_b, model_shifts_hold(model->constants))
POST(feasible_power_b, result >= 0 && ((current_mA > 0 && bus_mV > 0) || result == 0))

PRE(feasible_by_drawn_at, model_shifts_hold(side->set->model->constants))
PRE(feasible_by_drawn_at, is_a_sign(side->sign))
POST(feasible_by_drawn_at, result >= 0)

PRE(feasible_by_returned_at, model_shifts_hold(side->set->model->constants))
PRE(feasible_by_returned_at, is_a_sign(side->sign))
POST(feasible_by_returned_at, result >= 0)

POST(feasible_holds, at.d_b != 0 || at.x_b != 0 || set->model->voltage_q_b != 0 ||
     !is_within(set->voltage_squared, 0, INT64_MAX / 2) || result)
POST(feasible_holds, at.d_b != 0 || at.x_b != 0 || set->model->voltage_q_b == 0 ||
     set->voltage_squared != 0 || !result)

POST(feasible_forced, result || (at->d_b == old(at->d_b) && at->x_b == old(at->x_b)))
POST(feasible_forced, !result || (at->d_b <= 0 && is_within(at->x_b, -MOTOR_MODEL_MOST_CURRENT_b,
     MOTOR_MODEL_MOST_CURRENT_b)))

POST(feasible_point, is_within(result.x_b, -MOTOR_MODEL_MOST_CURRENT_b, MOTOR_MODEL_MOST_CURRENT_b))
POST(feasible_point, set->model->flux_b < 4 || set->model->constants->torque_inverse_q24 < 0 ||
     set->model->x_per_airgap_q23 < 0 || (airgap_b >= 0 ? result.x_b >= 0 : result.x_b <= 0))

/* motor/observer_error.h */
PRE(observer_error_explains, is_within(angle_turn, 0, 30600))
POST(observer_error_explains, angle_turn <= 16400 || !result)
PRE(observer_error_torque_mNm, model_shifts_hold(side->set->model->constants))
PRE(observer_error_torque_mNm, is_a_sign(side->sign))
POST(observer_error_torque_mNm, result >= 0)

/* motor/torque_uncertainty.h */
PRE(torque_uncertainty_mNm, is_within(model->flux_b, 0, 1 << 26) && is_within(model->friction_b, 0,
     1 << 26) && is_within(model->constants->torque_factor_q24, 0, 2 * SCALED_ONE) &&
     is_within(model->constants->torque_shift, -30, 30))
PRE(torque_uncertainty_mNm, point_holds(at))
POST(torque_uncertainty_mNm, result >= 0)

/* motor/loss_braking.h */
POST(loss_braking_at, model->config->brake.loss_braking != 0 || result.current_b == 0)
POST(loss_braking_at, result.by_map_mNm == FEASIBLE_UNBOUNDED && result.torque_mNm == 0 &&
     result.returned.power_b == returned.power_b && result.returned.margin_b == returned.margin_b)

PRE(loss_braking_torque_mNm, model_shifts_hold(side->set->model->constants))
PRE(loss_braking_torque_mNm, is_a_sign(side->sign))
POST(loss_braking_torque_mNm, result >= by_map_mNm && losses->by_map_mNm == by_map_mNm)
POST(loss_braking_torque_mNm, result == by_map_mNm || result == losses->torque_mNm)
POST(loss_braking_torque_mNm, losses->current_b == old(losses->current_b) &&
     losses->returned.power_b == old(losses->returned.power_b) && losses->returned.margin_b ==
     old(losses->returned.margin_b))

PRE(loss_braking_setpoint, model_shifts_hold(set->model->constants) &&
     is_within(set->model->friction_b, 0, 1 << 26))
PRE(loss_braking_setpoint, is_within(current.i_d_mA,
     -set->model->config->motor.max_phase_current_mA,
     set->model->config->motor.max_phase_current_mA))
POST(loss_braking_setpoint, is_within(result.i_d_mA,
     -set->model->config->motor.max_phase_current_mA,
     set->model->config->motor.max_phase_current_mA))
POST(loss_braking_setpoint, result.limited == current.limited && result.feasible == current.feasible
     && result.forced_mNm == current.forced_mNm)
POST(loss_braking_setpoint, (losses->current_b != 0 && q_abs(torque_mNm) > losses->by_map_mNm) ||
     (result.i_d_mA == current.i_d_mA && result.i_q_mA == current.i_q_mA))

/* motor/loss_maps.h */
POST(loss_maps_torque_mNm, result >= 0)

POST(loss_maps_row_at, result.points == config->current_map.torque_points && result.step_log2 ==
     config->current_map.torque_step_log2)
POST(loss_maps_row_at, config->current_map.temperature_points > 1 || result.hot_lsb ==
     result.cold_lsb)
POST(loss_maps_row_at, grid_weights_hold(result.weights) && result.weights.shift == 15 -
     config->current_map.lsb_log2)

POST(loss_maps_row_d_mA, !grid_weights_hold(row->weights) || is_within(result, -CURRENT_MAP_MOST_lsb
     * grid_lsb(row->weights), CURRENT_MAP_MOST_lsb * grid_lsb(row->weights)))

POST(loss_maps_row_rise_mA, is_within(along_mNm, -row->zero_mNm, row->zero_mNm) || result == 0)

/* motor/motor_model.h */
POST(motor_constants_init, model_shifts_hold(constants))
POST(motor_constants_init, is_within(constants->current_most_b, 1 << 22, 1 << 23) &&
     is_within(constants->weakening_most_b, 0, MOTOR_MODEL_MOST_CURRENT_b))
POST(motor_constants_init, constants->coulomb_step_q8_b >= 0 && constants->viscous_b >= 0 &&
     constants->flux_b >= 0 && constants->resistance_b >= 0)
POST(motor_constants_init, is_within(constants->torque_factor_q24, SCALED_ONE, 2 * SCALED_ONE) &&
     constants->torque_inverse_q24 >= 0)
POST(motor_constants_init, config->rotor.sensor == CONFIG_ROTOR_HALL || constants->hall_angle_b ==
     0)

PRE(motor_model_at, model_shifts_hold(constants))
PRE(motor_model_at, constants->coulomb_step_q8_b >= 0 && constants->viscous_b >= 0)
POST(motor_model_at, result.constants == constants && result.config == config)
POST(motor_model_at, result.speed_mrad_s == speed_mrad_s && result.winding_temperature_cC ==
     winding_temperature_cC)
POST(motor_model_at, motor_model_holds(&result))

PRE(motor_model_around, model_shifts_hold(constants))
PRE(motor_model_around, constants->coulomb_step_q8_b >= 0 && constants->viscous_b >= 0)
POST(motor_model_around, result.constants == constants && result.config == config)
POST(motor_model_around, result.speed_mrad_s == speed_mrad_s && result.winding_temperature_cC ==
     winding_temperature_cC)
POST(motor_model_around, motor_model_holds(&result))

PRE(motor_model_move, model_shifts_hold(model->constants) && motor_model_holds(model))
POST(motor_model_move, model->config == old(model->config) &&
     model->constants == old(model->constants) && model->speed_mrad_s == old(model->speed_mrad_s) &&
     model->winding_temperature_cC == old(model->winding_temperature_cC))
POST(motor_model_move, model->speed_b == old(model->speed_b) && model->resistance_b ==
     old(model->resistance_b) && model->friction_b == old(model->friction_b))
POST(motor_model_move, motor_model_holds(model))

PRE(motor_model_point, current_shift_holds(model->constants))
POST(motor_model_point, is_within(result.d_b, -MOTOR_MODEL_MOST_CURRENT_b,
     MOTOR_MODEL_MOST_CURRENT_b) && is_within(result.x_b, -MOTOR_MODEL_MOST_CURRENT_b,
     MOTOR_MODEL_MOST_CURRENT_b))

PRE(motor_model_torque_mNm, is_within(model->flux_b, 0, 1 << 26) && is_within(model->friction_b, 0,
     1 << 26) && is_within(model->constants->torque_factor_q24, 0, 2 * SCALED_ONE) &&
     is_within(model->constants->torque_shift, -30, 30))
PRE(motor_model_torque_mNm, is_within(at.x_b, -MOTOR_MODEL_MOST_CURRENT_b,
     MOTOR_MODEL_MOST_CURRENT_b))
POST(motor_model_torque_mNm, at.x_b > 0 || (at.x_b < 0 && model->saliency_b != 0) ||
     (model->speed_mrad_s >= 0 ? result <= 0 : result >= 0))

PRE(motor_model_bus_current_mA, current_shift_holds(model->constants))
POST(motor_model_bus_current_mA, is_within(result, -(1 << 30), 1 << 29))
PRE(motor_model_switching_current_mA, current_shift_holds(model->constants))
POST(motor_model_switching_current_mA, is_within(result, -(1 << 30), 1 << 29))

POST(motor_model_bus_current_mA, at.d_b != 0 || at.x_b != 0 || model->iron_current_b != 0 || result
     == 0)

PRE(motor_model_current_b, current_shift_holds(constants))
POST(motor_model_current_b, is_within(result, -MOTOR_MODEL_MOST_CURRENT_b,
     MOTOR_MODEL_MOST_CURRENT_b))
POST(motor_model_current_b, (current_mA < 0 || result >= 0) && (current_mA > 0 || result <= 0))
POST(motor_model_current_b, q_abs(current_mA) > MOTOR_MODEL_MOST_CURRENT_b >> 16 || q_abs(result) >=
     2 * q_abs(current_mA))

PRE(motor_model_current_mA, current_shift_holds(constants))
POST(motor_model_current_mA, current_b >= 0 ? is_within(result, 0, current_b / 2) :
     is_within(result, current_b, -1))

PRE(motor_model_magnitude_b, is_within(i_d_b, -(1 << 29), 1 << 29) && is_within(i_q_b, -(1 << 29), 1
     << 29))
POST(motor_model_magnitude_b, result >= q_max(q_abs(i_d_b), q_abs(i_q_b)) && result <= q_abs(i_d_b)
     + q_abs(i_q_b))

PRE(motor_model_bridge_loss_b, is_within(constants->loss_b, 0, 1 << 26) &&
     is_within(constants->loss_resistance_b, 0, 1 << 26))
PRE(motor_model_bridge_loss_b, is_within(current_b, 0, 1 << 26))
POST(motor_model_bridge_loss_b, result >= 0)

POST(motor_model_airgap_b, at.x_b != 0 || result == 0)
POST(motor_model_airgap_b, model->saliency_b != 0 || model->flux_b < 0 ||
     model->constants->torque_factor_q24 < 0 || (at.x_b >= 0 ? result >= 0 : result <= 0))
POST(motor_model_airgap_b, !is_within(model->flux_b, 0, 1 << 26) ||
     !is_within(model->constants->torque_factor_q24, 0, 2 * SCALED_ONE) || !is_within(at.x_b,
     -MOTOR_MODEL_MOST_CURRENT_b, MOTOR_MODEL_MOST_CURRENT_b) || is_within(result, -(1 << 30), 1 <<
     30))

POST(motor_model_x_of_airgap_b, is_within(result, -MOTOR_MODEL_MOST_CURRENT_b,
     MOTOR_MODEL_MOST_CURRENT_b))
POST(motor_model_x_of_airgap_b, model->flux_b < 4 || model->constants->torque_inverse_q24 < 0 ||
     model->x_per_airgap_q23 < 0 || (airgap_b >= 0 ? result >= 0 : result <= 0))

POST(motor_model_airgap_per_x, model->flux_b < 0 || model->constants->torque_factor_q24 < 0 ||
     result >= 0)

POST(motor_model_airgap_per_d, model->saliency_b != 0 || result == 0)
POST(motor_model_airgap_per_d, model->saliency_b > 0 || model->constants->torque_factor_q24 < 0 ||
     (at.x_b >= 0 ? result <= 0 : result >= 0))

POST(motor_model_x_per_d, is_within(result, -(1 << 26), 1 << 26) && (model->saliency_b != 0 ||
     result == 0))

PRE(motor_model_i_q_b, is_within(model->one_plus_a2, SCALED_ONE, 1 << 26) &&
     is_within(model->cross_d, 0, 1 << 26) && is_within(model->iron_current_b, 0,
     MOTOR_MODEL_MOST_CURRENT_b))
PRE(motor_model_i_q_b, point_holds(at))
POST(motor_model_i_q_b, is_within(result, -(1 << 28), (1 << 28) + MOTOR_MODEL_MOST_CURRENT_b))

PRE(motor_model_x_of_i_q_b, is_within(model->inverse_one_plus_a2, 0, SCALED_ONE) &&
     is_within(model->cross_d, 0, 1 << 26) && is_within(model->iron_current_b, 0,
     MOTOR_MODEL_MOST_CURRENT_b))
PRE(motor_model_x_of_i_q_b, is_within(i_q_b, -(1 << 28), 1 << 28) && is_within(d_b,
     -MOTOR_MODEL_MOST_CURRENT_b, MOTOR_MODEL_MOST_CURRENT_b))
POST(motor_model_x_of_i_q_b, q_abs(result) <= q_abs(i_q_b) + model->iron_current_b + 4 * q_abs(d_b))

PRE(motor_model_u_d_b, is_within(model->resistance_b, 0, 1 << 26) && is_within(model->reactance_q_b,
     0, 1 << 26))
PRE(motor_model_u_d_b, point_holds(at))
POST(motor_model_u_d_b, is_within(result, -(1 << 28), 1 << 28))

PRE(motor_model_u_q_b, is_within(model->voltage_q_b, 0, 1 << 26) &&
     is_within(model->voltage_q_per_x, 0, 1 << 26) && is_within(model->voltage_q_per_d, 0, 1 << 26))
PRE(motor_model_u_q_b, point_holds(at))
POST(motor_model_u_q_b, is_within(result, -(1 << 28), (1 << 28) + (1 << 26)))

PRE(motor_model_shaft_mNm, is_within(airgap_b, -(1 << 30), 1 << 30) && is_within(model->friction_b,
     0, 1 << 26))
PRE(motor_model_shaft_mNm, is_within(model->constants->torque_shift, -30, 62))
POST(motor_model_shaft_mNm, airgap_b > model->friction_b || (model->speed_mrad_s >= 0 ? result <= 0
     : result >= 0))
POST(motor_model_shaft_mNm, airgap_b < model->friction_b || (model->speed_mrad_s >= 0 ? result >= 0
     : result <= 0))

PRE(motor_model_airgap_of_shaft_b, is_within(model->friction_b, 0, 1 << 26) &&
     is_within(model->constants->torque_shift, -62, 30))
POST(motor_model_airgap_of_shaft_b, is_within(result, model->friction_b - (1 << 29),
     model->friction_b + (1 << 29)))
POST(motor_model_airgap_of_shaft_b, shaft_mNm == 0 || (shaft_mNm > 0) == (model->speed_mrad_s >= 0)
     ? result >= model->friction_b : result <= model->friction_b)

/* motor/thermal_model.h */
POST(thermal_model_init, !state->started && state->steps == 0 && state->square_sum == 0 &&
     state->length_sum == 0)
POST(thermal_model_init, state->winding.known == (config->thermal.winding_heat_capacity_mJ_K > 0))
POST(thermal_model_init, is_within(state->winding.inner_share_q30, 0, 1 << 30) &&
     is_within(state->winding.ambient_share_q30, 0, 1 << 30) &&
     is_within(state->switches.inner_share_q30, 0, 1 << 30))
POST(thermal_model_init, thermal_model_holds(state))

POST(thermal_model_start, state->started)
POST(thermal_model_start, is_within(state->winding.inner_q16, -32700 * 65536, 32700 * 65536) &&
     is_within(state->winding.outer_q16, -32700 * 65536, 32700 * 65536))
POST(thermal_model_start, is_within(state->switches.inner_q16, -32700 * 65536, 32700 * 65536) &&
     is_within(state->switches.outer_q16, -32700 * 65536, 32700 * 65536))
POST(thermal_model_start, is_within(state->winding.ambient_q16, -32700 * 65536,
     config->monitor.warmest_ambient_cC * 65536))
POST(thermal_model_start, state->switches.ambient_q16 == state->winding.ambient_q16)
POST(thermal_model_start, state->steps == old(state->steps))
POST(thermal_model_start, !state->winding.known == !old(state->winding.known) &&
     !state->switches.known == !old(state->switches.known))

PRE(thermal_model_start, thermal_model_holds(state))
POST(thermal_model_start, thermal_model_holds(state))

PRE(thermal_model_step, thermal_model_holds(state))
POST(thermal_model_step, thermal_model_holds(state))
POST(thermal_model_step, !state->started == !old(state->started) && !state->winding.known ==
     !old(state->winding.known) && !state->switches.known == !old(state->switches.known))
POST(thermal_model_step, state->winding.known || state->winding.inner_q16 ==
     old(state->winding.inner_q16))
POST(thermal_model_step, !state->heat_due == !(state->steps == 0 || (old(state->heat_due) &&
     old(state->steps) < 3)))
POST(thermal_model_step, state->winding.ambient_q16 == old(state->winding.ambient_q16))

PRE(thermal_model_inner_cC, is_within(row->inner_q16, -32700 * 65536, 32700 * 65536))
POST(thermal_model_inner_cC, is_within(result, -32700, 32700))

PRE(thermal_model_outer_cC, is_within(row->outer_q16, -32700 * 65536, 32700 * 65536))
POST(thermal_model_outer_cC, is_within(result, -32700, 32700))

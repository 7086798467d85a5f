/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Needs (PRE) and guarantees (POST) of the functions of controller, one clause a line: a C
 * expression of the parameters; `result` is what is returned, old(expression) a value before the
 * call.
 * contracts.py reads them together with the prototypes of the headers.
 */
/* clang-format off */

/* controller/angle_choice.h */
POST(angle_choice_init, !state->confirmed && !state->sensor_wrong && !state->observer_used &&
     state->agreed_steps == 0)

PRE(angle_choice_step, is_within(in->flux_q14, -32768, 32767) && is_within(in->across_q14, -32768,
     32767) && is_within(in->expected_q14, -32768, 32767))
PRE(angle_choice_step, config->rotor.observer_speed_mrad_s >= 0 && in->observer_mrad_s > INT32_MIN)
PRE(angle_choice_step, config->motor.flux_linkage_nWb > 0 && config->motor.d_inductance_nH > 0 &&
     config->motor.q_inductance_nH > 0)
PRE(angle_choice_step, config->monitor.rotor_warning_time_ms > 0 &&
     config->monitor.rotor_warning_time_ms <= 60000)
PRE(angle_choice_step, state->agreed_steps >= 0 && state->agreed_steps <=
     config->monitor.rotor_warning_time_ms)
POST(angle_choice_step, state->agreed_steps >= 0 && state->agreed_steps <=
     config->monitor.rotor_warning_time_ms)
POST(angle_choice_step, config->rotor.observer_takeover != 0 || result.valid == in->sensor_valid)
POST(angle_choice_step, config->rotor.observer_takeover != 0 || (result.by == ANGLE_BY_SENSOR &&
     !result.sensor_wrong))
POST(angle_choice_step, config->rotor.observer_takeover == 0 || in->switching || !state->confirmed)
POST(angle_choice_step, !result.valid || in->sensor_valid || (result.by == ANGLE_BY_OBSERVER &&
     state->confirmed))
POST(angle_choice_step, !result.valid || !result.sensor_wrong || result.by == ANGLE_BY_OBSERVER)
POST(angle_choice_step, !result.sensor_wrong || !cleared || in->switching)

/* controller/bridge_choice.h */
POST(bridge_choice_init, state->idle_steps == 0 && state->infeasible_steps == 0 &&
     state->return_steps == 0)

PRE(bridge_choice_step, findings_hold(findings))
POST(bridge_choice_step, findings_hold(findings))
POST(bridge_choice_step, result == BRIDGE_PWM || result == watch->safe.bridge || (result ==
     BRIDGE_SHORT && torque->kept_mNm > 0))
POST(bridge_choice_step, torque_enable_any(*enable) || result == watch->safe.bridge)

/* controller/controller.h */
POST(controller_init, controller_slow_holds(&controller->slow, config))
POST(controller_init, controller->fast.output.bridge == BRIDGE_OFF && controller->fast.monitor.trip
     == REASON_NONE)
POST(controller_init, controller->slow.modes.mode == MODE_BOOT && controller->slow.step_count == 0
     && controller->slow.last.torque_command_mNm == 0)

POST(controller_initial_setpoint, !result.torque_enabled && result.safe_bridge == BRIDGE_OFF &&
     !result.clear_trip && !result.release_break && !result.calibrate_offsets)
POST(controller_initial_setpoint, vector_holds(result.i_reference_pu) && result.sequence == 0)

POST(controller_fast_step, result == &fast->output)
POST(controller_fast_step, result->bridge == (setpoint->torque_enabled && fast->monitor.trip ==
     REASON_NONE ? BRIDGE_PWM : setpoint->safe_bridge))
POST(controller_fast_step, !in->power_stage_fault || fast->monitor.trip != REASON_NONE)
POST(controller_fast_step, old(fast->monitor.trip) == REASON_NONE || setpoint->clear_trip ||
     fast->monitor.trip == old(fast->monitor.trip))

POST(controller_fast_report, report->trip == fast->monitor.trip && report->bridge ==
     fast->output.bridge)

POST(controller_fast_report_copy, report->trip == fast->monitor.trip && report->bridge ==
     fast->output.bridge)

POST(controller_fast_report_complete, report->trip == old(report->trip) && report->bridge ==
     old(report->bridge) && report->sensor_valid == old(report->sensor_valid) && report->sequence ==
     old(report->sequence))

POST(controller_fast_view, view->i_q_reference_pu == fast->foc.prefilter.reference_pu.q &&
     view->theta_turn == fast->foc.period.theta_turn)

POST(controller_limits, result == &slow->torque.table)

POST(controller_start_warm, slow->measure.temperatures.kept_cC == warmest_cC)

POST(controller_warmest_cC, result >= slow->last.temperature.winding_cC && result >=
     slow->last.temperature.switch_cC)

POST(controller_start_hold, slow->torque.demand.engaged == kept.direction)

POST(controller_hold, result.direction == DRIVE_DIRECTION_NEUTRAL || result.direction ==
     slow->torque.demand.engaged)

POST(controller_temperatures, result.winding_cC == slow->last.temperature.winding_cC)

PRE(controller_slow_step, battery_relations_hold(config) && derating_relations_hold(config))
PRE(controller_slow_step, controller_slow_holds(slow, config))
PRE(controller_slow_step, is_within(in->temperature.winding_cC, -100000, 100000) &&
     is_within(in->temperature.switch_cC, -100000, 100000))
PRE(controller_slow_step, is_within(report->i_d_weakening_pu, -32768, 0) &&
     vector_holds(dq_of(report->i_pu)) && vector_holds(dq_of(report->observer.flux_q14)))
POST(controller_slow_step, controller_slow_holds(slow, config))
POST(controller_slow_step, slow->step_count == (uint16_t)(old(slow->step_count) + 1) &&
     setpoint->sequence == slow->step_count && result.motor_torque_command_mNm ==
     slow->last.torque_command_mNm)
POST(controller_slow_step, setpoint->safe_bridge != BRIDGE_PWM &&
     vector_holds(setpoint->i_reference_pu))
POST(controller_slow_step, result.mode == MODE_RUN || result.mode == MODE_LIMP ||
     (!setpoint->torque_enabled && result.motor_torque_command_mNm == 0))
POST(controller_slow_step, in->bms.contactor != CONTACTOR_OPEN || (!setpoint->torque_enabled &&
     result.motor_torque_command_mNm == 0))
POST(controller_slow_step, in->demand.brake_torque_mNm <= 0 || result.speed_mrad_s == 0 ||
     (result.speed_mrad_s > 0 ? result.motor_torque_command_mNm <= 0 :
     result.motor_torque_command_mNm >= 0))
POST(controller_slow_step, !demand_is_lost(config, in->demand_age_ms) || result.speed_mrad_s == 0 ||
     (result.speed_mrad_s > 0 ? result.motor_torque_command_mNm <= 0 :
     result.motor_torque_command_mNm >= 0))
POST(controller_slow_step, report->bridge == BRIDGE_PWM || q_abs(result.motor_torque_command_mNm) <=
     q_max(config->brake.torque_rate_mNm_s / 1000, 1))
POST(controller_slow_step, report->trip != REASON_HARDWARE_BREAK || old(slow->modes.mode) ==
     MODE_BOOT || result.mode == MODE_FAULT)
POST(controller_slow_step, result.hydraulic_torque_mNm <= config->brake.max_hydraulic_torque_mNm)
POST(controller_slow_step, result.drive_available_mNm >= 0 && result.drive_ahead_mNm >= 0 &&
     result.electric_brake_ahead_mNm >= 0 && result.motor_torque_uncertainty_mNm >= 0)

/* controller/current_expectation.h */
PRE(current_expectation, vector_holds(reference_pu) && vector_holds(before_pu))
POST(current_expectation, result <= (1U << 26))
POST(current_expectation, switching || result == 0)
POST(current_expectation, result == 0 || result >= 4 * MONITOR_DEAD_SQUARE || result ==
     (uint32_t)(config->current_loop.max_current_pu_q15 * config->current_loop.max_current_pu_q15 /
     16))

/* controller/measure.h */
POST(measure_init, measure_holds(state, config))

PRE(measure_step, measure_holds(state, config) && findings_hold(findings))
PRE(measure_step, vector_holds(dq_of(report->observer.flux_q14)))
PRE(measure_step, is_within(last->current_missing_q15, 0, 16384) &&
     is_within(last->temperature.winding_cC, -34700, 34700))
PRE(measure_step, is_within(in->temperature.winding_cC, -100000, 100000) &&
     is_within(in->temperature.switch_cC, -100000, 100000))
POST(measure_step, measure_holds(state, config) && findings_hold(findings))
POST(measure_step, result.winding_lasting_mA >= 0 && result.switch_lasting_mA >= 0 &&
     is_within(result.winding_hotter_cC, -69400, 69400) && is_within(result.winding_temperature_cC,
     -34700, 34700))
POST(measure_step, result.report == report && result.in == in && result.battery == &in->bms)
POST(measure_step, result.trip == REASON_NONE || result.trip == report->trip || result.trip ==
     REASON_MEMORY)
POST(measure_step, report->trip != REASON_HARDWARE_BREAK || result.trip == REASON_HARDWARE_BREAK)

POST(measure_setpoint, vector_holds(setpoint->i_reference_pu))

/* controller/operating_point.h */
POST(operating_point_init, state->i_pu.d == 0 && state->i_pu.q == 0 && state->power_pu == 0 &&
     state->speed_q32 == 0 && state->sequence == 0)
POST(operating_point_init, state->v_dc_pu >= 0 && state->observer_leak.leak_q24 ==
     state->observer.start.leak_q24)

POST(operating_point_rotor, result.flux_q14 == dq_of(report->observer.flux_q14).d &&
     result.across_q14 == dq_of(report->observer.flux_q14).q)
POST(operating_point_rotor, result.observer_mrad_s > INT32_MIN && is_within(result.expected_q14,
     -32768, 32767))
POST(operating_point_rotor, report->speed_q32 >= 0 ? result.sensor_mrad_s >= 0 :
     result.sensor_mrad_s <= 0)
POST(operating_point_rotor, result.sensor_valid == report->sensor_valid && result.switching ==
     (report->bridge == BRIDGE_PWM))
POST(operating_point_rotor, (report->observer.acquired && state->observer.follows_speed) ||
     state->observer_speed_q32 == report->observer.speed_q32)
POST(operating_point_rotor, state->i_pu.d == old(state->i_pu.d) && state->i_pu.q ==
     old(state->i_pu.q) && state->v_dc_pu == old(state->v_dc_pu) && state->sequence ==
     old(state->sequence))

POST(operating_point_of, out->speed_mrad_s == speed.wheel_mrad_s && state->speed_q32 ==
     speed.turn_q32 && state->winding_temperature_cC == winding_temperature_cC)
POST(operating_point_of, out->sampled_pu.d == state->i_pu.d && out->sampled_pu.q == state->i_pu.q &&
     state->sequence == out->report->sequence)
POST(operating_point_of, out->report->sequence != old(state->sequence) || (state->i_pu.d ==
     old(state->i_pu.d) && state->i_pu.q == old(state->i_pu.q) && state->power_pu ==
     old(state->power_pu) && state->v_dc_pu == old(state->v_dc_pu)))
POST(operating_point_of, out->trip == old(out->trip) && out->angle_valid == old(out->angle_valid) &&
     out->angle_by == old(out->angle_by) && out->sensor_wrong == old(out->sensor_wrong))

POST(operating_point_setpoint, vector_holds(setpoint->i_reference_pu))
POST(operating_point_setpoint, setpoint->torque_enabled == old(setpoint->torque_enabled) &&
     setpoint->safe_bridge == old(setpoint->safe_bridge) && setpoint->clear_trip ==
     old(setpoint->clear_trip) && setpoint->calibrate_offsets == old(setpoint->calibrate_offsets) &&
     setpoint->release_break == old(setpoint->release_break) && setpoint->sequence ==
     old(setpoint->sequence))

POST(operating_point_initial_setpoint, vector_holds(setpoint->i_reference_pu))
POST(operating_point_initial_setpoint, setpoint->torque_enabled == old(setpoint->torque_enabled) &&
     setpoint->safe_bridge == old(setpoint->safe_bridge) && setpoint->clear_trip ==
     old(setpoint->clear_trip) && setpoint->calibrate_offsets == old(setpoint->calibrate_offsets) &&
     setpoint->release_break == old(setpoint->release_break) && setpoint->sequence ==
     old(setpoint->sequence))

/* controller/temperatures.h */
POST(temperatures_init, !state->model.started)
POST(temperatures_init, state->winding_offset_q16 == 0 && state->switch_offset_q16 == 0 &&
     state->kept_cC == TEMPERATURE_NONE_cC)
POST(temperatures_init, temperatures_hold(state))

PRE(temperatures_step, is_within(now->in->temperature.winding_cC, -100000, 100000) &&
     is_within(now->in->temperature.switch_cC, -100000, 100000))
PRE(temperatures_step, temperatures_hold(state) && findings_hold(findings) &&
     is_within(last->current_missing_q15, 0, 16384) &&
     is_within(last->temperature.winding_cC, -34700, 34700))
POST(temperatures_step, temperatures_hold(state) && state->model.started)
POST(temperatures_step, config->monitor.winding_sensor_fitted == 0 ||
     !is_within(now->in->temperature.winding_cC, config->monitor.lowest_temperature_cC,
     config->monitor.highest_temperature_cC) || (now->winding_temperature_cC +
     now->winding_hotter_cC >= now->in->temperature.winding_cC && now->sensed.winding_cC ==
     now->in->temperature.winding_cC))
POST(temperatures_step, config->monitor.switch_sensor_fitted == 0 ||
     !is_within(now->in->temperature.switch_cC, config->monitor.lowest_temperature_cC,
     config->monitor.highest_temperature_cC) || (now->switch_temperature_cC >=
     now->in->temperature.switch_cC && now->sensed.switch_cC == now->in->temperature.switch_cC))
POST(temperatures_step, is_within(now->winding_hotter_cC, -69400, 69400))
POST(temperatures_step, is_within(now->winding_temperature_cC, -34700, 34700) &&
     is_within(now->switch_temperature_cC, -34700, 34700))
POST(temperatures_step, now->winding_lasting_mA >= 0 && now->switch_lasting_mA >= 0)
POST(temperatures_step, findings_hold(findings))
POST(temperatures_step, now->speed_mrad_s == old(now->speed_mrad_s) && now->trip == old(now->trip)
     && now->angle_valid == old(now->angle_valid))


/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Needs (PRE) and guarantees (POST) of the functions of torque, one clause a line: a C expression
 * of the parameters; `result` is what is returned, old(expression) a value before the call.
 * contracts.py reads them together with the prototypes of the headers.
 */
/* clang-format off */

/* torque/available_ahead.h */
POST(available_ahead_init, state->now.driving.torque_mNm == 0 && state->now.braking.torque_mNm == 0
     && state->ahead.driving.torque_mNm == 0 && state->ahead.braking.torque_mNm == 0)
POST(available_ahead_init, table_holds(&state->table))
POST(available_ahead_init, every(i, TORQUE_LINE_COUNT, state->table.driving[i].torque_mNm ==
     FEASIBLE_UNBOUNDED && state->table.braking[i].torque_mNm == FEASIBLE_UNBOUNDED))
POST(available_ahead_init, state->step == 0 && !state->speed.known && !state->voltage.known &&
     !state->returned.known && !state->drawn.known)

PRE(available_ahead_step, motor_constants_hold(motor) && derating_relations_hold(config))
PRE(available_ahead_step, table_holds(limits) && ahead_holds(state))
POST(available_ahead_step, ahead_holds(state))
POST(available_ahead_step, state->step == (old(state->step) + 1U) % AVAILABLE_AHEAD_ROUND_steps)
POST(available_ahead_step, old(state->step) / 2 >= 7 || (state->now.driving.torque_mNm ==
     old(state->now.driving.torque_mNm) && state->now.braking.torque_mNm ==
     old(state->now.braking.torque_mNm) && state->ahead.driving.torque_mNm ==
     old(state->ahead.driving.torque_mNm) && state->ahead.braking.torque_mNm ==
     old(state->ahead.braking.torque_mNm)))

/* torque/brake_blending.h */
POST(brake_blending_init, state->hydraulic.next == 0 && state->hydraulic.torque_q6_mNm == 0 &&
     !state->feedback.seen && state->feedback.gain_q15 == 32768)
POST(brake_blending_init, state->covered_mNm == 0 && state->bridged_q6_mNm == 0 &&
     state->bridging_ms == 0)
POST(brake_blending_init, state->feedback.between_ms == 1)

PRE(brake_blending_report, findings_hold(findings))
POST(brake_blending_report, findings_hold(findings))
POST(brake_blending_report, result == REASON_NONE || result == REASON_HYDRAULIC_FEEDBACK ||
     is_within(result, REASON_HYDRAULIC_WEAK, REASON_HYDRAULIC_LATE))

PRE(brake_blending_step, is_within(state->hydraulic.next, 0, HYDRAULIC_MODEL_COMMANDS - 1) &&
     is_within(state->feedback.between_ms, 1, HYDRAULIC_FEEDBACK_PAST_ms))
PRE(brake_blending_step, table_holds(limits) && last->hydraulic_added_mNm >= 0 &&
     last->hydraulic_apart_mNm >= 0)
PRE(brake_blending_step, is_within(motor->missing_q15, 0, 16384))
POST(brake_blending_step, is_within(state->hydraulic.next, 0, HYDRAULIC_MODEL_COMMANDS - 1) &&
     is_within(state->feedback.between_ms, 1, HYDRAULIC_FEEDBACK_PAST_ms))
POST(brake_blending_step, is_within(result.electric_mNm, 0, q_max(demand->brake_torque_mNm, 0)))
POST(brake_blending_step, is_within(result.hydraulic_mNm, INT32_MIN,
     config->brake.max_hydraulic_torque_mNm))
POST(brake_blending_step, result.uncovered_mNm >= 0 && result.rise_mNm >= 0)
POST(brake_blending_step, result.electric_mNm <= limits->braking[TORQUE_LINE_ENABLE].torque_mNm &&
     result.electric_mNm <= limits->braking[TORQUE_LINE_ABS].torque_mNm && result.electric_mNm <=
     limits->braking[TORQUE_LINE_VOLTAGE].torque_mNm && result.electric_mNm <=
     limits->braking[TORQUE_LINE_PHASE_CURRENT].torque_mNm)

/* torque/closing_voltage.h */
PRE(closing_voltage_mV, charging_mA >= 0)
POST(closing_voltage_mV, phase_mV < 0 || is_within(result, 0, phase_mV))

/* torque/charge_trim.h */
PRE(charge_trim_init, config->battery.max_voltage_mV >= 1 &&
     is_within(config->motor.max_phase_current_mA, 0, 3000000) &&
     is_within(config->motor.phase_resistance_uOhm, 0, 100000000))
POST(charge_trim_init, charge_trim_holds(state) && !state->braking && state->terminals_q8_mA == 0)

PRE(charge_trim_step, charge_trim_holds(state) && motor_constants_hold(model->constants) &&
     is_within(model->config->drive.current_full_scale_mA, 1000, 4000000))
POST(charge_trim_step, charge_trim_holds(state) && is_within(result, -(1 << 22), 1 << 23))
POST(charge_trim_step, now->battery->current_given || state->pack.accumulator == 0)

PRE(charge_trim_commanded, charge_trim_holds(state) && motor_constants_hold(model->constants))
POST(charge_trim_commanded, charge_trim_holds(state) && state->braking == braking)

/* torque/demand.h */
POST(demand_init, state->lost_ms == INT32_MAX && state->engaged == DRIVE_DIRECTION_NEUTRAL)
POST(demand_init, state->lift_off_mNm == 0 && state->brake_torque_mNm == 0 &&
     state->received_brake_torque_mNm == 0)

PRE(demand_step, is_within(state->lift_off_mNm, 0, 100000000) && is_within(state->brake_torque_mNm,
     0, 100000000))
PRE(demand_step, is_within(state->received_brake_torque_mNm, 0, 100000000) && state->lost_ms >= 0)
POST(demand_step, is_within(state->received_brake_torque_mNm, 0, 100000000))
POST(demand_step, is_within(state->lift_off_mNm, 0, 100000000) && is_within(state->brake_torque_mNm,
     0, 100000000))
POST(demand_step, state->lost_ms >= 0 && result.engaged == state->engaged)
POST(demand_step, result.lift_off_mNm >= 0 && result.brake_torque_mNm >= 0 && result.lift_off_mNm <=
     state->lift_off_mNm)
POST(demand_step, !demand_is_lost(config, in->demand_age_ms) || result.brake_torque_mNm <=
     old(state->brake_torque_mNm))
POST(demand_step, !demand_is_lost(config, in->demand_age_ms) || result.drive_withdrawn)
POST(demand_step, result.drive_torque_mNm == 0 || (!result.drive_withdrawn &&
     result.brake_torque_mNm == 0))
POST(demand_step, result.drive_torque_mNm == 0 || result.engaged == (result.drive_torque_mNm > 0 ?
     DRIVE_DIRECTION_FORWARD : DRIVE_DIRECTION_REVERSE))
POST(demand_step, result.drive_torque_mNm >= 0 ? result.drive_torque_mNm <=
     q_max(in->demand.drive_torque_mNm, 0) : result.drive_torque_mNm >= in->demand.drive_torque_mNm)
POST(demand_step, result.hydraulic_valid || (demand_is_lost(config, in->demand_age_ms) &&
     config->driver.no_other_brake == 0))
POST(demand_step, !in->demand.abs_active || result.lift_off_mNm == 0)
POST(demand_step, result.brake_torque_mNm == state->brake_torque_mNm)
POST(demand_step, in->demand.brake_torque_mNm <= 0 || (result.drive_withdrawn &&
     result.drive_torque_mNm == 0))
POST(demand_step, is_within(result.drive_torque_mNm, -100000000, 100000000))

POST(demand_rate_mNm_per_step, result >= 1 && (result == 1 || result <=
     config->brake.torque_rate_mNm_s / 1000))

PRE(demand_handed_over_mNm, left_mNm >= 0)
POST(demand_handed_over_mNm, result >= 1 && result - 1 <= left_mNm)

/* torque/foldback.h */
PRE(foldback_step, is_within(state->allowed_q24, 0, SCALED_ONE) && is_within(foldback->most_mA, 0,
     2000000))
PRE(foldback_step, is_within(foldback->span_mV, 1, 2000000) && is_within(foldback->width_mV, 0,
     foldback->span_mV))
PRE(foldback_step, is_within(foldback->rise_mV, 0, 4 * foldback->span_mV))
POST(foldback_step, is_within(state->allowed_q24, 0, SCALED_ONE))
POST(foldback_step, result >= 0 && result <= foldback->most_mA)
POST(foldback_step, inside_mV > -foldback->width_mV || result == 0)

/* torque/hill_hold.h */
POST(hill_hold_init, state->torque_mNm == 0 && !state->holds && !state->caught &&
     state->begun_mrad_s == 0)
POST(hill_hold_init, state->release_ms == 0)

PRE(hill_hold_step, is_within(state->torque_mNm, 0, config->driver.hold_torque_mNm))
PRE(hill_hold_step, is_within(state->release_ms, 0, config->driver.hold_release_ms) &&
     state->begun_mrad_s >= 0)
PRE(hill_hold_step, is_within(demand->brake_torque_mNm, 0, 100000000) &&
     is_within(demand->lift_off_mNm, 0, 100000000))
POST(hill_hold_step, is_within(state->torque_mNm, 0, config->driver.hold_torque_mNm))
POST(hill_hold_step, is_within(state->release_ms, 0, config->driver.hold_release_ms) &&
     state->begun_mrad_s >= 0)
POST(hill_hold_step, result == state->torque_mNm)
POST(hill_hold_step, demand->engaged != DRIVE_DIRECTION_NEUTRAL || (!state->holds && result <=
     old(state->torque_mNm)))
POST(hill_hold_init, !state->resumed && !state->leaves && !state->lost && state->rolls_ms == 0)
PRE(hill_hold_step, is_within(state->rolls_ms, 0, HILL_HOLD_CAUGHT_ms))
POST(hill_hold_step, is_within(state->rolls_ms, 0, HILL_HOLD_CAUGHT_ms))
POST(hill_hold_step, old(state->holds) || demand->brake_torque_mNm + demand->lift_off_mNm > 0 ||
     (old(state->leaves) && !wheel->may_drive) || result <= old(state->torque_mNm))
POST(hill_hold_step, !old(state->holds) || old(state->resumed) || demand->engaged ==
     DRIVE_DIRECTION_NEUTRAL || (demand->drive_torque_mNm != 0 && wheel->may_drive) || result ==
     config->driver.hold_torque_mNm)
POST(hill_hold_works, !result || (state->holds && state->torque_mNm > 0 && state->rolls_ms <
     HILL_HOLD_CAUGHT_ms))
POST(hill_hold_fails, result || !state->lost)
POST(hill_hold_keep, result.direction == (state->holds || state->leaves ? engaged :
     DRIVE_DIRECTION_NEUTRAL) && result.leaves == state->leaves)
POST(hill_hold_resume, !(state->holds && state->leaves) && state->resumed == (kept->direction !=
     DRIVE_DIRECTION_NEUTRAL))
POST(hill_hold_resume, state->torque_mNm == old(state->torque_mNm) && state->rolls_ms ==
     old(state->rolls_ms) && state->release_ms == old(state->release_ms) && state->begun_mrad_s ==
     old(state->begun_mrad_s))

/* torque/hydraulic_feedback.h */
POST(hydraulic_feedback_init, state->gain_q15 == 32768 && is_within(state->least_q15, 16384, 32768)
     && is_within(state->most_q15, 32768, 49152))
POST(hydraulic_feedback_init, !state->seen && state->shows == REASON_NONE && state->heal_ms == 0 &&
     state->between_ms == 1)

POST(hydraulic_feedback_used, !result || (state->seen && state->heal_ms == 0))

PRE(hydraulic_feedback_step, is_within(state->between_ms, 1, HYDRAULIC_FEEDBACK_PAST_ms))
POST(hydraulic_feedback_step, is_within(state->between_ms, 1, HYDRAULIC_FEEDBACK_PAST_ms) &&
     state->now <= HYDRAULIC_FEEDBACK_PAST_ms)
POST(hydraulic_feedback_step, result.used == (state->seen && state->heal_ms == 0) && result.lost ==
     (state->seen && !result.used))
POST(hydraulic_feedback_step, !result.used || result.torque_mNm >= 0)
POST(hydraulic_feedback_step, config->brake.hydraulic_timeout_ms > 0 || state->seen ==
     old(state->seen))
POST(hydraulic_feedback_step, state->seen == old(state->seen) || report->valid)
POST(hydraulic_feedback_step, commanded || state->shows == old(state->shows) || state->shows ==
     REASON_NONE)
POST(hydraulic_feedback_step, state->shows == old(state->shows) || state->shows == REASON_NONE ||
     is_within(state->shows, REASON_HYDRAULIC_WEAK, REASON_HYDRAULIC_STUCK))
POST(hydraulic_feedback_step, state->heal_ms == 0 || state->heal_ms == HYDRAULIC_FEEDBACK_HEAL_ms ||
     state->heal_ms == old(state->heal_ms) - 1)

POST(hydraulic_feedback_is_short, result == (state->shows == REASON_HYDRAULIC_WEAK || state->shows
     == REASON_HYDRAULIC_DEAD))

/* torque/hydraulic_model.h */
POST(hydraulic_model_init, model->next == 0 && model->torque_q6_mNm == 0 && model->early_q6_mNm == 0
     && model->late_q6_mNm == 0)

PRE(hydraulic_model_step, is_within(model->next, 0, HYDRAULIC_MODEL_COMMANDS - 1))
POST(hydraulic_model_step, is_within(model->next, 0, HYDRAULIC_MODEL_COMMANDS - 1) &&
     is_within(model->commands_mNm[model->next], 0, q_min(q_max(command_mNm, 0),
     config->brake.max_hydraulic_torque_mNm)))
POST(hydraulic_model_step, is_within(model->torque_q6_mNm - old(model->torque_q6_mNm),
     -(config->brake.hydraulic_rate_mNm_s / 1000 * 64 + 64), config->brake.hydraulic_rate_mNm_s /
     1000 * 64 + 64))

POST(hydraulic_model_commanded, result.least_mNm <= model->recent.least_mNm && result.least_mNm <=
     model->before.least_mNm)
POST(hydraulic_model_commanded, result.most_mNm >= model->recent.most_mNm && result.most_mNm >=
     model->before.most_mNm)

PRE(hydraulic_model_torque_mNm, is_within(model->torque_q6_mNm, 0, 64 * 20000000))
POST(hydraulic_model_torque_mNm, is_within(result, 0, 20000000))

PRE(hydraulic_model_early_mNm, is_within(model->early_q6_mNm, 0, 64 * 20000000))
POST(hydraulic_model_early_mNm, is_within(result, 0, 20000000))

PRE(hydraulic_model_late_mNm, is_within(model->late_q6_mNm, 0, 64 * 20000000))
POST(hydraulic_model_late_mNm, is_within(result, 0, 20000000))

/* torque/lift_off.h */
PRE(lift_off_split, electric_mNm >= 0 && every(i, TORQUE_LINE_COUNT, limits->braking[i].torque_mNm
     >= 0))
POST(lift_off_split, result.motor_mNm >= 0 && result.hydraulic_mNm >= 0)
POST(lift_off_split, result.motor_mNm <= q_max(demand_mNm, 0) - result.hydraulic_mNm)
POST(lift_off_split, result.motor_mNm == 0 || every(i, TORQUE_LINE_LOSS_OPTIMUM, result.motor_mNm <=
     limits->braking[i].torque_mNm - electric_mNm))
POST(lift_off_split, result.motor_mNm == 0 || result.motor_mNm <=
     limits->braking[TORQUE_LINE_ABS].torque_mNm - electric_mNm)
POST(lift_off_split, result.motor_mNm == 0 || result.motor_mNm <=
     limits->braking[TORQUE_LINE_BLEND_OUT].torque_mNm - electric_mNm)
POST(lift_off_split, result.motor_mNm < demand_mNm || result.reason == REASON_NONE)

/* torque/limit.h */
POST(limit_init, result.torque_mNm >= 0 && result.reason == reason)
POST(limit_init, torque_mNm < 0 ? result.torque_mNm == 0 : result.torque_mNm == torque_mNm)

PRE(limit_tighten, limit->torque_mNm >= 0)
POST(limit_tighten, limit->torque_mNm >= 0 && limit->torque_mNm <= old(limit->torque_mNm))
POST(limit_tighten, limit->torque_mNm <= q_max(torque_mNm, 0))
POST(limit_tighten, limit->torque_mNm == old(limit->torque_mNm) ? limit->reason ==
     old(limit->reason) : limit->reason == reason)

/* torque/road.h */
POST(road_init, road_holds(state) && state->torque_mNm == 0 && !state->rolls)

PRE(road_step, road_holds(state))
POST(road_step, road_holds(state) && result == q_max(-state->torque_mNm, 0))
POST(road_step, trusted || !state->rolls)
POST(road_step, state->rolls || state->torque_mNm == old(state->torque_mNm))

/* torque/stop_lamp.h */
POST(stop_lamp_init, !state->lit && !state->started)
POST(stop_lamp_init, state->speed_lp_q8_mrad_s == 0 && state->decel_lp_mm_s2.accumulator == 0)

PRE(stop_lamp_step, state->speed_lp_q8_mrad_s >= 0)
PRE(stop_lamp_step, is_within(state->decel_lp_mm_s2.accumulator, -(1 << 30), 1 << 30))
POST(stop_lamp_step, state->speed_lp_q8_mrad_s >= 0 && result == state->lit)
POST(stop_lamp_step, is_within(state->decel_lp_mm_s2.accumulator, -(1 << 30), 1 << 30))
POST(stop_lamp_step, brake_demand_mNm <= 0 || result)

/* torque/torque.h */
POST(torque_init, torque_state_holds(state, config))
POST(torque_init, state->demand.engaged == DRIVE_DIRECTION_NEUTRAL)

POST(torque_hold, result.direction == DRIVE_DIRECTION_NEUTRAL || result.direction ==
     state->demand.engaged)

POST(torque_start_hold, state->demand.engaged == kept.direction && state->hold.torque_mNm ==
     old(state->hold.torque_mNm) && state->hold.resumed == (kept.direction !=
     DRIVE_DIRECTION_NEUTRAL))

PRE(torque_step, battery_relations_hold(config) && derating_relations_hold(config) &&
     torque_state_holds(state, config) && findings_hold(findings))
PRE(torque_step, is_within(last->torque_command_mNm, -400000000, 400000000) &&
     last->hydraulic_added_mNm >= 0 && last->hydraulic_apart_mNm >= 0)
PRE(torque_step, is_within(watch->current_missing_q15, 0, 16384))
PRE(torque_step, now->winding_lasting_mA >= 0 && now->switch_lasting_mA >= 0 &&
     is_within(now->winding_hotter_cC, -69400, 69400))
POST(torque_step, torque_state_holds(state, config) && findings_hold(findings))
POST(torque_step, is_within(result.command_mNm, -400000000, 400000000) && result.hydraulic_added_mNm
     >= 0 && is_within(result.hydraulic_apart_mNm, 0, result.hydraulic_added_mNm))
POST(torque_step, torque_enable_any(*enable) || result.command_mNm == 0)
POST(torque_step, in->demand.brake_torque_mNm <= 0 || now->speed_mrad_s == 0 || (now->speed_mrad_s >
     0 ? result.command_mNm <= 0 : result.command_mNm >= 0))
POST(torque_step, !demand_is_lost(config, in->demand_age_ms) || now->speed_mrad_s == 0 ||
     (now->speed_mrad_s > 0 ? result.command_mNm <= 0 : result.command_mNm >= 0))
POST(torque_step, measured_switching(now) || q_abs(result.command_mNm) <=
     q_max(config->brake.torque_rate_mNm_s / 1000, 1))
POST(torque_step, result.hydraulic_mNm <= config->brake.max_hydraulic_torque_mNm)
POST(torque_step, state->ahead.step == (old(state->ahead.step) + 1U) % AVAILABLE_AHEAD_ROUND_steps)
POST(torque_step, result.available_now.driving.torque_mNm >= 0 &&
     result.available_ahead.driving.torque_mNm >= 0 && result.available_ahead.braking.torque_mNm >=
     0)
POST(torque_step, result.uncertainty_mNm >= 0)

POST(torque_limits_of, result == &state->table)

/* torque/torque_command.h */
POST(torque_command_is_against, result == ((speed_mrad_s > 0 && torque_mNm < 0) || (speed_mrad_s < 0
     && torque_mNm > 0)))

POST(torque_command_growth_mNm, q_abs(result) <= q_max(config->brake.torque_rate_mNm_s / 1000, 1))
POST(torque_command_growth_mNm, voltage_use_q15 < config->brake.torque_growth_end_q15 || result <=
     0)
POST(torque_command_growth_mNm, voltage_use_q15 > config->brake.torque_growth_end_q15 || result >=
     0)

POST(torque_command_init, !state->braked)

PRE(torque_command_step, table_holds(limits))
PRE(torque_command_step, is_within(demand->drive_torque_mNm, -100000000, 100000000) &&
     is_within(braking->electric_mNm, 0, 300000000))
PRE(torque_command_step, is_within(last_command_mNm, -400000000, 400000000))
PRE(torque_command_step, braking->uncovered_mNm >= 0 && braking->rise_mNm >= 0)
POST(torque_command_step, is_within(result.command_mNm, -400000000, 400000000))
POST(torque_command_step, torque_enable_any(*enable) || (result.command_mNm == 0 && !state->braked))
POST(torque_command_step, demand->drive_torque_mNm != 0 || q_abs(result.command_mNm) <=
     q_max(q_abs(last_command_mNm), braking->electric_mNm))
POST(torque_command_step, demand->drive_torque_mNm != 0 || !demand->drive_withdrawn ||
     now->speed_mrad_s == 0 || (now->speed_mrad_s > 0 ? result.command_mNm <= 0 : result.command_mNm
     >= 0))
POST(torque_command_step, !torque_enable_any(*enable) || !bridge_open || q_abs(result.command_mNm)
     <= q_max(config->brake.torque_rate_mNm_s / 1000, 1))
POST(torque_command_step, result.reason != REASON_NONE || !torque_enable_any(*enable) || some(i,
     TORQUE_LINE_COUNT, limits->driving[i].reason == REASON_NONE || limits->braking[i].reason ==
     REASON_NONE) || result.command_mNm == demand->drive_torque_mNm + (now->speed_mrad_s >= 0 ?
     -braking->electric_mNm : braking->electric_mNm))

/* torque/torque_limits.h */
POST(torque_limits_init, every(i, TORQUE_LINE_COUNT, table->driving[i].torque_mNm ==
     FEASIBLE_UNBOUNDED && table->braking[i].torque_mNm == FEASIBLE_UNBOUNDED))
POST(torque_limits_init, state->charge.allowed_q24 == SCALED_ONE && state->discharge.allowed_q24 ==
     SCALED_ONE)
POST(torque_limits_init, battery_rises_hold(state) && table_holds(table))
POST(torque_limits_init, state->abs_hold_steps == 0 && state->abs_share_percent == 0 &&
     table->drawn_b == 0)

PRE(torque_limits_step, set->model == model)
PRE(torque_limits_step, is_within(set->model->config->battery.max_voltage_mV -
     set->model->config->battery.min_voltage_mV, 1, 2000000))
PRE(torque_limits_step, is_within(set->model->config->battery.foldback_voltage_mV,
     set->model->config->battery.min_voltage_mV, set->model->config->battery.max_voltage_mV) &&
     is_within(set->model->config->battery.discharge_foldback_voltage_mV,
     set->model->config->battery.min_voltage_mV, set->model->config->battery.max_voltage_mV))
PRE(torque_limits_step, anti_lock_holds(state) && battery_rises_hold(state))
PRE(torque_limits_step, is_within(state->charge.allowed_q24, 0, SCALED_ONE) &&
     is_within(state->discharge.allowed_q24, 0, SCALED_ONE))
PRE(torque_limits_step, motor_constants_hold(set->model->constants) &&
     motor_model_holds(set->model) && derating_relations_hold(set->model->config))
PRE(torque_limits_step, set->weakest_d_b <= 0 && set->voltage_squared >= 0)
PRE(torque_limits_step, now->winding_lasting_mA >= 0 && now->switch_lasting_mA >= 0 &&
     is_within(now->winding_hotter_cC, -69400, 69400))
PRE(torque_limits_step, table_holds(table) && is_within(in->current_missing_q15, 0, 16384))
POST(torque_limits_step, set->model == model && model->config == old(model->config) &&
     model->constants == old(model->constants) && model->speed_mrad_s == old(model->speed_mrad_s) &&
     model->winding_temperature_cC == old(model->winding_temperature_cC))
POST(torque_limits_step, model->friction_b == old(model->friction_b) && motor_model_holds(model))
POST(torque_limits_step, set->weakest_d_b <= 0 && set->voltage_squared ==
     old(set->voltage_squared))
POST(torque_limits_step, is_within(state->charge.allowed_q24, 0, SCALED_ONE) &&
     is_within(state->discharge.allowed_q24, 0, SCALED_ONE))
POST(torque_limits_step, anti_lock_holds(state) && battery_rises_hold(state))
POST(torque_limits_step, table_holds(table))
POST(torque_limits_step, table->driving[TORQUE_LINE_MAX_TORQUE].torque_mNm ==
     set->model->config->motor.max_torque_mNm && table->braking[TORQUE_LINE_MAX_TORQUE].torque_mNm
     == set->model->config->motor.max_torque_mNm)
POST(torque_limits_step, now->angle_valid || (table->driving[TORQUE_LINE_ROTOR].torque_mNm == 0 &&
     table->braking[TORQUE_LINE_ROTOR].torque_mNm == 0))
POST(torque_limits_step, enable->drive_q15 > 0 || table->driving[TORQUE_LINE_ENABLE].torque_mNm ==
     0)
POST(torque_limits_step, enable->brake_q15 > 0 || table->braking[TORQUE_LINE_ENABLE].torque_mNm ==
     0)
POST(torque_limits_step, in->current_missing_q15 > 0 ||
     (table->driving[TORQUE_LINE_CURRENT_GAIN].torque_mNm == FEASIBLE_UNBOUNDED &&
     table->braking[TORQUE_LINE_CURRENT_GAIN].torque_mNm == FEASIBLE_UNBOUNDED))
POST(torque_limits_step, !now->in->demand.abs_active ||
     table->braking[TORQUE_LINE_ABS].torque_mNm <= q_max(in->brake_torque_mNm, 0))
POST(torque_limits_step, q_abs(set->model->speed_mrad_s) >
     set->model->config->brake.blend_out_end_mrad_s ||
     table->braking[TORQUE_LINE_BLEND_OUT].torque_mNm == 0)

POST(torque_limits_clear, every(i, TORQUE_LINE_COUNT, table->driving[i].torque_mNm ==
     FEASIBLE_UNBOUNDED && table->braking[i].torque_mNm == FEASIBLE_UNBOUNDED))
POST(torque_limits_clear, table->drawn_b == 0 && table_holds(table))

PRE(torque_limits_plain, motor_constants_hold(model->constants) && motor_model_holds(model) &&
     derating_relations_hold(model->config))
PRE(torque_limits_plain, table_holds(table))
POST(torque_limits_plain, table_holds(table) && table->driving[TORQUE_LINE_MAX_TORQUE].torque_mNm ==
     old(table->driving[TORQUE_LINE_MAX_TORQUE].torque_mNm) &&
     table->braking[TORQUE_LINE_MAX_TORQUE].torque_mNm ==
     old(table->braking[TORQUE_LINE_MAX_TORQUE].torque_mNm))
POST(torque_limits_plain, q_abs(model->speed_mrad_s) > model->config->brake.blend_out_end_mrad_s ||
     table->braking[TORQUE_LINE_BLEND_OUT].torque_mNm == 0)

PRE(torque_limits_ends, set->model == model && motor_constants_hold(model->constants) &&
     motor_model_holds(model))
PRE(torque_limits_ends, set->weakest_d_b <= 0 && set->voltage_squared >= 0)
PRE(torque_limits_ends, is_a_sign((int32_t)sign) && table_holds(table))
POST(torque_limits_ends, set->model == model && model->config == old(model->config) &&
     model->constants == old(model->constants) && model->speed_mrad_s == old(model->speed_mrad_s) &&
     model->winding_temperature_cC == old(model->winding_temperature_cC))
POST(torque_limits_ends, model->friction_b == old(model->friction_b) && motor_model_holds(model))
POST(torque_limits_ends, set->weakest_d_b <= 0 && set->voltage_squared ==
     old(set->voltage_squared))
POST(torque_limits_ends, result.set == set && result.sign == (int32_t)sign)
POST(torque_limits_ends, table_holds(table) && table->driving[TORQUE_LINE_MAX_TORQUE].torque_mNm ==
     old(table->driving[TORQUE_LINE_MAX_TORQUE].torque_mNm) &&
     table->braking[TORQUE_LINE_MAX_TORQUE].torque_mNm ==
     old(table->braking[TORQUE_LINE_MAX_TORQUE].torque_mNm))
POST(torque_limits_ends, table->braking[TORQUE_LINE_BLEND_OUT].torque_mNm ==
     old(table->braking[TORQUE_LINE_BLEND_OUT].torque_mNm))

PRE(torque_limits_drawn, side->set == set && set->model == model &&
     motor_constants_hold(model->constants) && motor_model_holds(model))
PRE(torque_limits_drawn, set->weakest_d_b <= 0 && set->voltage_squared >= 0)
PRE(torque_limits_drawn, is_a_sign(side->sign) && table_holds(table))
POST(torque_limits_drawn, set->model == model && model->config == old(model->config) &&
     model->constants == old(model->constants) && model->speed_mrad_s == old(model->speed_mrad_s) &&
     model->winding_temperature_cC == old(model->winding_temperature_cC))
POST(torque_limits_drawn, model->friction_b == old(model->friction_b) && motor_model_holds(model))
POST(torque_limits_drawn, set->weakest_d_b <= 0 && set->voltage_squared ==
     old(set->voltage_squared))
POST(torque_limits_drawn, table_holds(table) && table->driving[TORQUE_LINE_MAX_TORQUE].torque_mNm ==
     old(table->driving[TORQUE_LINE_MAX_TORQUE].torque_mNm) &&
     table->braking[TORQUE_LINE_MAX_TORQUE].torque_mNm ==
     old(table->braking[TORQUE_LINE_MAX_TORQUE].torque_mNm))
POST(torque_limits_drawn, table->braking[TORQUE_LINE_BLEND_OUT].torque_mNm ==
     old(table->braking[TORQUE_LINE_BLEND_OUT].torque_mNm))

PRE(torque_limits_returned, side->set == set && set->model == model &&
     motor_constants_hold(model->constants) && motor_model_holds(model))
PRE(torque_limits_returned, set->weakest_d_b <= 0 && set->voltage_squared >= 0)
PRE(torque_limits_returned, is_a_sign(side->sign) && table_holds(table))
POST(torque_limits_returned, set->model == model && model->config == old(model->config) &&
     model->constants == old(model->constants) && model->speed_mrad_s == old(model->speed_mrad_s) &&
     model->winding_temperature_cC == old(model->winding_temperature_cC))
POST(torque_limits_returned, model->friction_b == old(model->friction_b) &&
     motor_model_holds(model))
POST(torque_limits_returned, set->weakest_d_b <= 0 && set->voltage_squared ==
     old(set->voltage_squared))
POST(torque_limits_returned, table_holds(table) &&
     table->driving[TORQUE_LINE_MAX_TORQUE].torque_mNm ==
     old(table->driving[TORQUE_LINE_MAX_TORQUE].torque_mNm) &&
     table->braking[TORQUE_LINE_MAX_TORQUE].torque_mNm ==
     old(table->braking[TORQUE_LINE_MAX_TORQUE].torque_mNm))
POST(torque_limits_returned, table->braking[TORQUE_LINE_BLEND_OUT].torque_mNm ==
     old(table->braking[TORQUE_LINE_BLEND_OUT].torque_mNm))
POST(torque_limits_returned, table->braking[TORQUE_LINE_RETURNED_PEAK].torque_mNm ==
     table->braking[TORQUE_LINE_RETURNED].torque_mNm)

PRE(torque_limits_strategy, brake_torque_mNm >= 0 && lines_hold(line))
POST(torque_limits_strategy, lines_hold(line))
POST(torque_limits_strategy, line[TORQUE_LINE_ABS].torque_mNm ==
     old(line[TORQUE_LINE_ABS].torque_mNm) && line[TORQUE_LINE_ENABLE].torque_mNm ==
     old(line[TORQUE_LINE_ENABLE].torque_mNm))
POST(torque_limits_strategy, line[TORQUE_LINE_CURRENT_GAIN].torque_mNm ==
     old(line[TORQUE_LINE_CURRENT_GAIN].torque_mNm))
POST(torque_limits_strategy, line[TORQUE_LINE_MAX_TORQUE].torque_mNm ==
     old(line[TORQUE_LINE_MAX_TORQUE].torque_mNm) && line[TORQUE_LINE_ROTOR].torque_mNm ==
     old(line[TORQUE_LINE_ROTOR].torque_mNm))
POST(torque_limits_strategy, config->brake.strategy == CONFIG_STRATEGY_SERIES_OPTIMAL ?
     line[TORQUE_LINE_LOSS_OPTIMUM].torque_mNm == q_max(optimum_mNm, 0) :
     line[TORQUE_LINE_LOSS_OPTIMUM].torque_mNm == FEASIBLE_UNBOUNDED)
POST(torque_limits_strategy, config->brake.strategy == CONFIG_STRATEGY_PARALLEL_RATIO ?
     line[TORQUE_LINE_ELECTRIC_SHARE].torque_mNm <= brake_torque_mNm :
     line[TORQUE_LINE_ELECTRIC_SHARE].torque_mNm == FEASIBLE_UNBOUNDED)
POST(torque_limits_strategy, q_abs(speed_mrad_s) > config->brake.blend_out_end_mrad_s ||
     line[TORQUE_LINE_BLEND_OUT].torque_mNm == 0)

POST(torque_limits_blend_out, result.torque_mNm >= 0 && result.reason == REASON_BLEND_OUT)
POST(torque_limits_blend_out, result.torque_mNm <= 20000000 || result.torque_mNm ==
     FEASIBLE_UNBOUNDED)
POST(torque_limits_blend_out, q_abs(speed_mrad_s) > config->brake.blend_out_end_mrad_s ||
     result.torque_mNm == 0)
POST(torque_limits_blend_out, q_abs(speed_mrad_s) < q_max(config->brake.blend_out_start_mrad_s,
     config->brake.blend_out_end_mrad_s + 1) || result.torque_mNm == FEASIBLE_UNBOUNDED)

PRE(torque_limits_winding, config->motor.derate_winding_temperature_cC <
     config->motor.max_winding_temperature_cC)
POST(torque_limits_winding, is_unbounded_or_permitted(result, config))
POST(torque_limits_winding, temperature_cC < config->motor.max_winding_temperature_cC ||
     result.torque_mNm == 0)
POST(torque_limits_winding, temperature_cC > config->motor.derate_winding_temperature_cC ||
     result.torque_mNm == FEASIBLE_UNBOUNDED)
POST(torque_limits_winding, result.reason == REASON_WINDING_TEMPERATURE)

PRE(torque_limits_switch, config->drive.derate_switch_temperature_cC <=
     config->drive.max_switch_temperature_cC)
POST(torque_limits_switch, is_unbounded_or_permitted(result, config))
POST(torque_limits_switch, temperature_cC <= config->drive.max_switch_temperature_cC ||
     result.torque_mNm == 0)
POST(torque_limits_switch, temperature_cC > config->drive.derate_switch_temperature_cC ||
     result.torque_mNm == FEASIBLE_UNBOUNDED)
POST(torque_limits_switch, result.reason == REASON_SWITCH_TEMPERATURE)

POST(torque_limits_braking_hot, result.torque_mNm >= driving.torque_mNm && result.torque_mNm >=
     least_mNm && result.reason == driving.reason)

POST(torque_limits_max_speed, is_unbounded_or_permitted(result, config))
POST(torque_limits_max_speed, q_abs(speed_mrad_s) <= config->motor.max_speed_mrad_s ||
     result.torque_mNm == 0)
POST(torque_limits_max_speed, result.reason == REASON_MAX_SPEED)

PRE(torque_limits_anti_lock, anti_lock_holds(state))
POST(torque_limits_anti_lock, anti_lock_holds(state))
POST(torque_limits_anti_lock, state->charge.allowed_q24 == old(state->charge.allowed_q24) &&
     state->discharge.allowed_q24 == old(state->discharge.allowed_q24))
POST(torque_limits_anti_lock, state->charge_rise.value == old(state->charge_rise.value) &&
     state->charge_rise.time_log2 == old(state->charge_rise.time_log2) &&
     state->discharge_rise.value == old(state->discharge_rise.value) &&
     state->discharge_rise.time_log2 == old(state->discharge_rise.time_log2))
POST(torque_limits_anti_lock, result.torque_mNm >= 0 && result.reason == REASON_ABS)
POST(torque_limits_anti_lock, !wheel->abs_active || result.torque_mNm <= q_max(brake_torque_mNm, 0))
POST(torque_limits_anti_lock, wheel->abs_active || state->abs_hold_steps > 0 || result.torque_mNm ==
     FEASIBLE_UNBOUNDED)
POST(torque_limits_anti_lock, wheel->abs_active ? state->abs_hold_steps == config->brake.abs_hold_ms
     : state->abs_hold_steps <= old(state->abs_hold_steps))

PRE(torque_limits_tightest, begin == 0 && (end == TORQUE_LINE_CURRENT_GAIN || end ==
     TORQUE_LINE_LOSS_OPTIMUM || end == TORQUE_LINE_COUNT))
POST(torque_limits_tightest, every(i, TORQUE_LINE_COUNT, i >= (int)end || result.torque_mNm <=
     lines[i].torque_mNm))
POST(torque_limits_tightest, some(i, TORQUE_LINE_COUNT, i < (int)end && result.torque_mNm ==
     lines[i].torque_mNm && result.reason == lines[i].reason))

PRE(torque_limits_at_most, some(i, TORQUE_LINE_COUNT, lines[i].torque_mNm <= torque_mNm))
POST(torque_limits_at_most, result.torque_mNm <= torque_mNm)
POST(torque_limits_at_most, each(i, TORQUE_LINE_COUNT, !is_first_at_most(lines, i, torque_mNm) ||
     (result.torque_mNm == lines[i].torque_mNm && result.reason == lines[i].reason)))

POST(torque_limits_classes, every(i, TORQUE_LINE_LOSS_OPTIMUM, result.hard_mNm <=
     braking[i].torque_mNm || result.deferrable_mNm <= braking[i].torque_mNm))
POST(torque_limits_classes, result.hard_mNm <= braking[TORQUE_LINE_ENABLE].torque_mNm &&
     result.hard_mNm <= braking[TORQUE_LINE_ABS].torque_mNm && result.hard_mNm <=
     braking[TORQUE_LINE_PHASE_CURRENT].torque_mNm && result.hard_mNm <=
     braking[TORQUE_LINE_VOLTAGE].torque_mNm)
POST(torque_limits_classes, result.deferrable_mNm <= braking[TORQUE_LINE_LOSS_OPTIMUM].torque_mNm &&
     result.deferrable_mNm <= braking[TORQUE_LINE_RETURNED].torque_mNm && result.deferrable_mNm <=
     braking[TORQUE_LINE_BLEND_OUT].torque_mNm)
POST(torque_limits_classes, some(i, TORQUE_LINE_COUNT, i != TORQUE_LINE_ELECTRIC_SHARE &&
     braking[i].torque_mNm <= q_min(result.hard_mNm, result.deferrable_mNm)))
POST(torque_limits_classes, !lines_hold(braking) || (result.hard_mNm >= 0 && result.deferrable_mNm
     >= 0))

POST(torque_limits_tightest_line, is_within((int)result, 0, TORQUE_LINE_COUNT - 1))
POST(torque_limits_tightest_line, is_first_of_the_tightest(lines, TORQUE_LINE_COUNT, result))

PRE(torque_limits_line_text, (int)line >= 0)
POST(torque_limits_line_text, result != 0 && (line < TORQUE_LINE_COUNT) == (result[0] != 'u'))

PRE(torque_limits_deferrable, (int)line >= 0)
POST(torque_limits_deferrable, line < TORQUE_LINE_COUNT || !result)
POST(torque_limits_deferrable, !result || (line != TORQUE_LINE_PHASE_CURRENT && line !=
     TORQUE_LINE_VOLTAGE && line != TORQUE_LINE_ENABLE && line != TORQUE_LINE_ABS))

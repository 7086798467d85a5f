/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Needs (PRE) and guarantees (POST) of the functions of monitor, one clause a line: a C expression
 * of the parameters; `result` is what is returned, old(expression) a value before the call.
 * contracts.py reads them together with the prototypes of the headers.
 */
/* clang-format off */

/* monitor/monitor.h */
POST(monitor_fast_init, state->trip == REASON_NONE && state->inverted_trip ==
     ~(uint32_t)REASON_NONE)
POST(monitor_fast_init, fast_times_hold(state))
POST(monitor_fast_init, state->current_periods == 0 && state->periods_left >= 0 &&
     state->periods_left == state->stale_limit_periods)
POST(monitor_fast_init, is_within(state->last_v_dc_pu, 0, 65536) && state->overcurrent_square <=
     (uint32_t)((Q15_ONE - 1) * (Q15_ONE - 1)))
POST(monitor_fast_init, is_within(state->jump_pu, MONITOR_BUS_LEAST_JUMP_PU, MONITOR_BUS_JUMP_PU))

POST(monitor_fast_intact, !result || state->inverted_trip == ~(uint32_t)state->trip)
POST(monitor_fast_intact, !result || (state->trip_periods == config->monitor.overcurrent_periods &&
     state->overcurrent_square <= (uint32_t)((Q15_ONE - 1) * (Q15_ONE - 1))))

POST(monitor_init, !state->started && !state->release_trip && state->steps == 0 &&
     state->return_steps == 0)
POST(monitor_init, state->flow_level == 0 && state->bus.count == 0)
POST(monitor_init, state->emf.level == 0 && state->emf.flux_level == 0 && state->emf.missing_q20 ==
     0 && state->current.missing_pu == 0 && state->swing.swing_mV == 0)
POST(monitor_init, monitor_window_holds(&state->contradiction) && monitor_gain_holds(&state->gain)
     && monitor_stuck_holds(&state->stuck) && monitor_open_holds(&state->open))
POST(monitor_init, state->speed.windows == 0 && state->speed.diode_steps == 0 &&
     state->speed.bound_urad_s == 0 && state->speed.rest_urad_s == 0)

PRE(monitor_step, monitor_state_holds(state, config) && findings_hold(findings))
PRE(monitor_step, vector_holds(dq_of(now->report->i_pu)) && vector_holds(last->reference_pu))
PRE(monitor_step, is_within(now->report->i_d_weakening_pu, -32768, 0))
POST(monitor_step, monitor_state_holds(state, config) && state->steps ==
     (uint16_t)(old(state->steps) + 1))
POST(monitor_step, findings_hold(findings))
POST(monitor_step, result.safe.bridge != BRIDGE_PWM)
POST(monitor_step, now->trip == REASON_NONE || now->trip == REASON_BUS_OVERVOLTAGE || now->trip ==
     REASON_BUS_SENSOR || now->trip == REASON_OVERCURRENT || (findings_bit_set(findings,
     FINDING_TRIP) && findings->trip == now->trip))
POST(monitor_step, now->trip != REASON_OVERCURRENT || (findings_bit_set(findings, FINDING_TRIP) &&
     findings->trip == REASON_OVERCURRENT) || findings_bit_set(findings, FINDING_TRIP_PHASE_OPEN) ||
     battery_is_lost(findings))
POST(monitor_step, now->battery->contactor != CONTACTOR_OPEN || battery_is_lost(findings))
POST(monitor_step, !result.at_rest || result.standstill)
POST(monitor_step, result.standstill == (result.bound_mrad_s < config->monitor.standstill_mrad_s) &&
     result.bound_mrad_s >= 0)
POST(monitor_step, result.safe.bridge == BRIDGE_OFF || (result.emf_conducts &&
     safe_state_charging_mA(&result.safe) == 0))
POST(monitor_step, is_within(result.flux_missing_q15, 0, 16384) && (result.flux_missing_q15 == 0 ||
     findings_bit_set(findings, FINDING_FLUX_LOW)))
POST(monitor_step, is_within(result.current_missing_q15, 0, MONITOR_GAIN_MOST_MISSING_Q15) &&
     (result.current_missing_q15 == 0 || findings_bit_set(findings, FINDING_GAIN)))

POST(monitor_forced_torque_mNm, result == 0 || result == config->motor.max_torque_mNm)

/* monitor/monitor_bus.h */
PRE(monitor_bus_step, window_bounds_hold(window))
PRE(monitor_bus_step, window_counts_hold(window))
POST(monitor_bus_step, window_bounds_hold(window))
POST(monitor_bus_step, window_counts_hold(window))
POST(monitor_bus_step, battery_mV > 0 || !result)
POST(monitor_bus_step, !result || window->wrong)
POST(monitor_bus_step, !result || old(window->wrong) || window->level ==
     MONITOR_WINDOW_QUALIFY_STEPS)
POST(monitor_bus_step, window->level <= old(window->level) + 1)

PRE(monitor_bus_swings, state->swing_mV >= 0 && is_within(battery->max_voltage_mV, 1000, 2000000) &&
     is_within(battery->resistance_uOhm, 0, 100000000))
PRE(monitor_bus_swings, is_within(battery->max_charge_current_mA, 0, 2000000) &&
     is_within(battery->max_discharge_current_mA, 100, 2000000))
POST(monitor_bus_swings, state->swing_mV >= 0 && is_within(state->last_mV, 0, MONITOR_BUS_MOST_mV))
POST(monitor_bus_swings, watched || (!result && state->swing_mV == 0))
POST(monitor_bus_swings, battery->resistance_uOhm > 0 || !result)
POST(monitor_bus_swings, old(state->watching) || state->swing_mV == 0)

/* monitor/monitor_current.h */
PRE(monitor_current_step, is_within(state->missing_pu, 0, config->monitor.current_missing_pu_q15))
POST(monitor_current_step, is_within(state->missing_pu, 0, config->monitor.current_missing_pu_q15))
POST(monitor_current_step, measured_switching(now) || (!result && state->missing_pu == 0))
POST(monitor_current_step, !now->report->voltage_limited || state->missing_pu <=
     old(state->missing_pu))
POST(monitor_current_step, result == (state->missing_pu == config->monitor.current_missing_pu_q15))

/* monitor/monitor_emf.h */
PRE(monitor_emf_step, monitor_emf_holds(state, config))
POST(monitor_emf_step, monitor_emf_holds(state, config))
POST(monitor_emf_step, result == (state->level == MONITOR_EMF_SEEN *
     config->monitor.angle_fault_time_ms))
POST(monitor_emf_step, (measured_switching(now) && now->angle_valid) || (state->level == 0 &&
     state->flux == old(state->flux)))
POST(monitor_emf_step, state->level <= old(state->level) || (!now->report->voltage_limited &&
     state->level <= old(state->level) + MONITOR_EMF_SEEN))
POST(monitor_emf_step, state->flux == old(state->flux) || state->flux_level == (state->flux ==
     MONITOR_EMF_FLUX_WEAK ? -MONITOR_EMF_FLUX_STEPS : state->flux == MONITOR_EMF_FLUX_STRONG ?
     MONITOR_EMF_FLUX_STEPS : 0))
POST(monitor_emf_step, state->missing_q20 == 0 || state->missing_q20 == old(state->missing_q20) ||
     old(state->flux) == MONITOR_EMF_FLUX_WEAK)

/* monitor/monitor_fast.h */
PRE(monitor_fast_current, fast_times_hold(state))
PRE(monitor_fast_current, state->current_periods > -MONITOR_DEAD_SMALL_TIMES * state->dead_periods
     || state->current_periods == INT16_MIN)
PRE(monitor_fast_current, state->current_periods < state->trip_periods)
POST(monitor_fast_current, state->current_periods <= state->trip_periods && (state->current_periods
     >= -MONITOR_DEAD_SMALL_TIMES * state->dead_periods || state->current_periods == INT16_MIN))
POST(monitor_fast_current, square < in->least_square || result == REASON_NONE || result ==
     REASON_OVERCURRENT)
POST(monitor_fast_current, square >= in->least_square || square <= MONITOR_DEAD_SQUARE || result ==
     REASON_NONE)
POST(monitor_fast_current, (result == REASON_OVERCURRENT) == (state->current_periods ==
     state->trip_periods))

PRE(monitor_fast_look, fast_times_hold(state))
PRE(monitor_fast_look, state->current_periods > -MONITOR_DEAD_SMALL_TIMES * state->dead_periods ||
     state->current_periods == INT16_MIN)
PRE(monitor_fast_look, state->current_periods < state->trip_periods)
PRE(monitor_fast_look, in->least_square <= state->overcurrent_square)
PRE(monitor_fast_look, q_abs(in->i_pu.v.x) <= Q15_ONE && q_abs(in->i_pu.v.y) <= Q15_ONE)
PRE(monitor_fast_look, in->v_dc_pu >= 0 && in->v_dc_pu <= 65536)
PRE(monitor_fast_look, state->last_v_dc_pu >= 0 && state->last_v_dc_pu <= 65536)
PRE(monitor_fast_look, periods_left_hold(state))
POST(monitor_fast_look, !in->power_stage_fault || result == REASON_HARDWARE_BREAK)
POST(monitor_fast_look, in->v_dc_pu <= state->overvoltage_pu || result != REASON_NONE)
POST(monitor_fast_look, state->current_periods >= -MONITOR_DEAD_SMALL_TIMES * state->dead_periods ||
     state->current_periods == INT16_MIN)
POST(monitor_fast_look, state->current_periods <= state->trip_periods)
POST(monitor_fast_look, result != REASON_NONE || state->current_periods < state->trip_periods)
POST(monitor_fast_look, result != REASON_NONE || state->current_periods >
     -MONITOR_DEAD_SMALL_TIMES * state->dead_periods || state->current_periods == INT16_MIN)
POST(monitor_fast_look, periods_left_hold(state))

PRE(monitor_fast_trip, reason != REASON_NONE)
POST(monitor_fast_trip, state->trip == reason && state->inverted_trip == ~(uint32_t)reason)

PRE(monitor_fast_step, fast_times_hold(state))
PRE(monitor_fast_step, state->current_periods >= -MONITOR_DEAD_SMALL_TIMES * state->dead_periods ||
     state->current_periods == INT16_MIN)
PRE(monitor_fast_step, in->least_square <= state->overcurrent_square)
PRE(monitor_fast_step, state->trip != REASON_NONE || state->current_periods < state->trip_periods)
PRE(monitor_fast_step, state->trip != REASON_NONE || state->current_periods >
     -MONITOR_DEAD_SMALL_TIMES * state->dead_periods || state->current_periods == INT16_MIN)
PRE(monitor_fast_step, q_abs(in->i_pu.v.x) <= Q15_ONE && q_abs(in->i_pu.v.y) <= Q15_ONE)
PRE(monitor_fast_step, in->v_dc_pu >= 0 && in->v_dc_pu <= 65536)
PRE(monitor_fast_step, state->last_v_dc_pu >= 0 && state->last_v_dc_pu <= 65536)
PRE(monitor_fast_step, periods_left_hold(state))
POST(monitor_fast_step, result == state->trip && (!in->power_stage_fault || result != REASON_NONE))
POST(monitor_fast_step, old(state->trip) == REASON_NONE || in->clear_trip || result ==
     old(state->trip))
POST(monitor_fast_step, in->v_dc_pu <= state->overvoltage_pu || result != REASON_NONE)
POST(monitor_fast_step, state->trip != REASON_NONE || state->current_periods < state->trip_periods)
POST(monitor_fast_step, periods_left_hold(state))

/* monitor/monitor_gain.h */
POST(monitor_gain_restart, monitor_gain_holds(state) && !state->wrong && state->steps == 0)

PRE(monitor_gain_step, monitor_gain_holds(state))
POST(monitor_gain_step, monitor_gain_holds(state))
POST(monitor_gain_step, result == state->wrong)
POST(monitor_gain_step, !result || (config->battery.driven_wheels == 1 &&
     now->battery->current_given && !measured_battery_open(now)))
POST(monitor_gain_step, !result || old(state->wrong) || (known && state->follows && state->steps ==
     0))

/* monitor/monitor_open.h */
PRE(monitor_open_edge_pu, true)
POST(monitor_open_edge_pu, is_within(result, 0, MONITOR_OPEN_MOST_EDGE_PU))
PRE(monitor_open_step, monitor_open_holds(state) && vectors_hold(dq_of(now->report->i_pu),
     reference_pu) && is_within(edge_pu, 0, MONITOR_OPEN_MOST_EDGE_PU))
POST(monitor_open_step, monitor_open_holds(state))
POST(monitor_open_step, measured_switching(now) || result == REASON_NONE)
POST(monitor_open_step, result == REASON_NONE || some(i, 3, state->missing[i][0] ==
     MONITOR_OPEN_STEPS || state->missing[i][1] == MONITOR_OPEN_STEPS || state->zeros[i] ==
     MONITOR_OPEN_STEPS))
POST(monitor_open_step, state->steps_known <= 2 && state->theta_turn ==
     now->report->sample.theta_turn && is_within(state->step_turn, -32768, 32767))

POST(monitor_open_step, result == REASON_NONE || result == REASON_PHASE_OPEN || result ==
     REASON_CURRENT_SUM)
POST(monitor_open_step, now->report->current_sum_pu != 0 || result != REASON_CURRENT_SUM)

/* monitor/monitor_speed.h */
PRE(monitor_speed_step, monitor_speed_holds(state, config))
POST(monitor_speed_step, monitor_speed_holds(state, config))
POST(monitor_speed_step, result >= 0 && (int64_t)result * 1000 <= state->bound_urad_s)
POST(monitor_speed_step, !bridge_is_short(now->report->bridge) || state->windows == 2 ||
     state->bound_urad_s >= old(state->bound_urad_s))

/* monitor/monitor_stuck.h */
PRE(monitor_stuck_step, state->side == BRIDGE_OFF || bridge_is_short(state->side))
PRE(monitor_stuck_step, is_within(state->steps, 0, MONITOR_STUCK_STEPS - 1) &&
     is_within(state->good_steps, 0, state->steps))
PRE(monitor_stuck_step, is_within(state->same_steps, 0, MONITOR_STUCK_LONGEST_STEPS) &&
     is_within(state->turned_mrad, -6283, 6283))
PRE(monitor_stuck_step, state->windows >= 0 && is_within(state->release_steps, 0,
     MONITOR_STUCK_RELEASE_STEPS))
POST(monitor_stuck_step, state->side == BRIDGE_OFF || bridge_is_short(state->side))
POST(monitor_stuck_step, is_within(state->steps, 0, MONITOR_STUCK_STEPS - 1) &&
     is_within(state->good_steps, 0, state->steps))
POST(monitor_stuck_step, is_within(state->release_steps, 0, MONITOR_STUCK_RELEASE_STEPS) &&
     result.side == state->side && state->windows >= 0)
POST(monitor_stuck_step, is_within(state->same_steps, 0, MONITOR_STUCK_LONGEST_STEPS) &&
     is_within(state->turned_mrad, -6283, 6283))
POST(monitor_stuck_step, now->trip != REASON_NONE || turning || result.side == BRIDGE_OFF)
POST(monitor_stuck_step, now->trip != REASON_NONE || !result.release_break)
POST(monitor_stuck_step, result.side == BRIDGE_OFF || old(state->side) != BRIDGE_OFF ||
     (!measured_switching(now) && now->report->offsets_done && now->trip != REASON_CURRENT_SENSOR &&
     now->angle_valid))
POST(monitor_stuck_step, !(now->trip != REASON_NONE || turning) || old(state->side) == BRIDGE_OFF ||
     result.side == old(state->side))

/* monitor/monitor_window.h */
POST(monitor_window_restart, every(i, 2, window->lowest[i] == 0 && window->highest[i] == 0))
POST(monitor_window_restart, window->steps == 0 && window->windows == 0 && window->level == 0 &&
     !window->wrong)

PRE(monitor_window_add, is_within(value, -MONITOR_WINDOW_MOST, MONITOR_WINDOW_MOST))
PRE(monitor_window_add, window_bounds_hold(window))
PRE(monitor_window_add, window_counts_hold(window))
POST(monitor_window_add, window_bounds_hold(window))
POST(monitor_window_add, window_counts_hold(window))
POST(monitor_window_add, window->level == old(window->level) && window->wrong == old(window->wrong))
POST(monitor_window_add, window->steps >= 1 && result == (window->windows > 0))

POST(monitor_window_lowest, result <= window->lowest[0] && result <= window->lowest[1])
POST(monitor_window_lowest, result == window->lowest[0] || result == window->lowest[1])

POST(monitor_window_highest, result >= window->highest[0] && result >= window->highest[1])
POST(monitor_window_highest, result == window->highest[0] || result == window->highest[1])

PRE(monitor_window_judge, window_bounds_hold(window))
PRE(monitor_window_judge, window_counts_hold(window))
POST(monitor_window_judge, window_bounds_hold(window))
POST(monitor_window_judge, window_counts_hold(window))
POST(monitor_window_judge, !result || window->wrong)
POST(monitor_window_judge, !result || old(window->wrong) || window->level ==
     MONITOR_WINDOW_QUALIFY_STEPS)
POST(monitor_window_judge, window->level <= old(window->level) + 1)

/* monitor/safe_state.h */
POST(safe_state_short, result.charging_mA == 0 && result.bus_mV == now->bus_voltage_mV)

POST(safe_state_step, result.bridge == BRIDGE_OFF || result.bridge == BRIDGE_SHORT)
POST(safe_state_step, !battery_gone || (result.freewheel.current_mA == 0 &&
     result.freewheel.charging_mA == 0 && result.freewheel.torque_mNm == 0))
POST(safe_state_step, result.bridge != BRIDGE_OFF || result.freewheel.current_mA == 0 ||
     result.freewheel.bus_mV == now->bus_voltage_mV)

POST(safe_state_short_surges, !result || (freewheel->current_mA <=
     config->motor.max_phase_current_mA && freewheel->bus_mV < config->drive.device_voltage_mV))

POST(safe_state_shorted, result.bridge == side && result.freewheel.current_mA == 0 &&
     result.freewheel.charging_mA == 0 && result.freewheel.bus_mV == now->bus_voltage_mV)

/* monitor/short_exit.h */
POST(short_exit_fits, in->i_d_mA != 0 || in->i_q_mA != 0 || in->turning_mrad_s != 0 || in->bus_mV !=
     0 || result)

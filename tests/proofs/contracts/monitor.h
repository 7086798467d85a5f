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

POST(monitor_slow_init, !state->started && !state->release_trip && state->steps == 0 &&
     state->return_steps == 0)
POST(monitor_slow_init, state->flow_level == 0 && state->bus_steps == 0 && state->rotor_steps == 0)
POST(monitor_slow_init, state->emf.level == 0 && state->emf.flux_level == 0 &&
     state->emf.missing_q20 == 0 && state->current.missing_pu == 0 && state->swing.swing_mV == 0)
POST(monitor_slow_init, monitor_window_holds(&state->bus) && monitor_window_holds(&state->gain) &&
     monitor_stuck_holds(&state->stuck) && monitor_open_holds(&state->open))
POST(monitor_slow_init, state->speed.windows == 0 && state->speed.diode_steps == 0 &&
     state->speed.bound_urad_s == 0 && state->speed.rest_urad_s == 0)

PRE(monitor_slow_step, monitor_state_holds(state, config) && vectors_hold(in->latest_pu,
     in->reference_pu))
POST(monitor_slow_step, monitor_state_holds(state, config) && state->steps ==
     (uint16_t)(old(state->steps) + 1))
POST(monitor_slow_step, result.safe_bridge != BRIDGE_PWM && state->safe_bridge ==
     result.safe_bridge)
POST(monitor_slow_step, in->fast_trip == REASON_NONE || in->fast_trip == REASON_BUS_OVERVOLTAGE ||
     in->fast_trip == REASON_BUS_SENSOR || in->fast_trip == REASON_OVERCURRENT || result.fault ==
     in->fast_trip)
POST(monitor_slow_step, in->fast_trip != REASON_OVERCURRENT || result.fault == REASON_OVERCURRENT ||
     result.fault == REASON_PHASE_OPEN || result.battery_lost)
POST(monitor_slow_step, !in->battery_open || result.battery_lost)
POST(monitor_slow_step, !result.at_rest || result.standstill)
POST(monitor_slow_step, result.standstill == (result.speed_bound_mrad_s <
     config->monitor.standstill_mrad_s) && result.speed_bound_mrad_s >= 0)
POST(monitor_slow_step, result.safe_bridge == BRIDGE_OFF || (result.emf_conducts &&
     result.charging_mA == 0))
POST(monitor_slow_step, is_within(result.flux_missing_q15, 0, 16384) && (result.flux_missing_q15 ==
     0 || result.flux_warning == REASON_FLUX_WEAK))

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
POST(monitor_current_step, in->switching || (!result && state->missing_pu == 0))
POST(monitor_current_step, !in->voltage_limited || state->missing_pu <= old(state->missing_pu))
POST(monitor_current_step, result == (state->missing_pu == config->monitor.current_missing_pu_q15))

/* monitor/monitor_emf.h */
PRE(monitor_emf_step, monitor_emf_holds(state, config))
POST(monitor_emf_step, monitor_emf_holds(state, config))
POST(monitor_emf_step, result == (state->level == MONITOR_EMF_SEEN *
     config->monitor.angle_fault_time_ms))
POST(monitor_emf_step, (in->switching && in->rotor_valid) || (state->level == 0 && state->flux ==
     old(state->flux)))
POST(monitor_emf_step, state->level <= old(state->level) || (!in->voltage_limited && state->level <=
     old(state->level) + MONITOR_EMF_SEEN))
POST(monitor_emf_step, state->flux == old(state->flux) || state->flux_level == (state->flux ==
     MONITOR_EMF_FLUX_WEAK ? -MONITOR_EMF_FLUX_STEPS : state->flux == MONITOR_EMF_FLUX_STRONG ?
     MONITOR_EMF_FLUX_STEPS : 0))
POST(monitor_emf_step, state->missing_q20 == 0 || state->missing_q20 == old(state->missing_q20) ||
     old(state->flux) == MONITOR_EMF_FLUX_WEAK)

/* monitor/monitor_fast.h */
PRE(monitor_fast_current, fast_times_hold(state))
PRE(monitor_fast_current, state->current_periods > -state->dead_periods || state->current_periods ==
     INT16_MIN)
PRE(monitor_fast_current, state->current_periods < state->trip_periods)
POST(monitor_fast_current, state->current_periods <= state->trip_periods && (state->current_periods
     >= -state->dead_periods || state->current_periods == INT16_MIN))
POST(monitor_fast_current, square < in->least_square || result == REASON_NONE || result ==
     REASON_OVERCURRENT)
POST(monitor_fast_current, square >= in->least_square || square <= MONITOR_DEAD_SQUARE || result ==
     REASON_NONE)
POST(monitor_fast_current, (result == REASON_OVERCURRENT) == (state->current_periods ==
     state->trip_periods))

PRE(monitor_fast_look, fast_times_hold(state))
PRE(monitor_fast_look, state->current_periods > -state->dead_periods || state->current_periods ==
     INT16_MIN)
PRE(monitor_fast_look, state->current_periods < state->trip_periods)
PRE(monitor_fast_look, in->least_square <= state->overcurrent_square)
PRE(monitor_fast_look, q_abs(in->i_pu.v.x) <= Q15_ONE && q_abs(in->i_pu.v.y) <= Q15_ONE)
PRE(monitor_fast_look, in->v_dc_pu >= 0 && in->v_dc_pu <= 65536)
PRE(monitor_fast_look, state->last_v_dc_pu >= 0 && state->last_v_dc_pu <= 65536)
PRE(monitor_fast_look, periods_left_hold(state))
POST(monitor_fast_look, !in->power_stage_fault || result == REASON_HARDWARE_BREAK)
POST(monitor_fast_look, in->v_dc_pu <= state->overvoltage_pu || result != REASON_NONE)
POST(monitor_fast_look, state->current_periods >= -state->dead_periods || state->current_periods ==
     INT16_MIN)
POST(monitor_fast_look, state->current_periods <= state->trip_periods)
POST(monitor_fast_look, result != REASON_NONE || state->current_periods < state->trip_periods)
POST(monitor_fast_look, result != REASON_NONE || state->current_periods != -state->dead_periods)
POST(monitor_fast_look, periods_left_hold(state))

PRE(monitor_fast_trip, reason != REASON_NONE)
POST(monitor_fast_trip, state->trip == reason && state->inverted_trip == ~(uint32_t)reason)

PRE(monitor_fast_step, fast_times_hold(state))
PRE(monitor_fast_step, state->current_periods >= -state->dead_periods || state->current_periods ==
     INT16_MIN)
PRE(monitor_fast_step, in->least_square <= state->overcurrent_square)
PRE(monitor_fast_step, state->trip != REASON_NONE || state->current_periods < state->trip_periods)
PRE(monitor_fast_step, state->trip != REASON_NONE || state->current_periods != -state->dead_periods)
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
PRE(monitor_gain_step, window_bounds_hold(window))
PRE(monitor_gain_step, window_counts_hold(window))
POST(monitor_gain_step, window_bounds_hold(window))
POST(monitor_gain_step, window_counts_hold(window))
POST(monitor_gain_step, !result || (in->switching && config->battery.driven_wheels == 1 &&
     in->battery_current_mA != MONITOR_GAIN_NOT_GIVEN))
POST(monitor_gain_step, !result || window->wrong)
POST(monitor_gain_step, !result || old(window->wrong) || window->level ==
     MONITOR_WINDOW_QUALIFY_STEPS)
POST(monitor_gain_step, window->level <= old(window->level) + 1)

/* monitor/monitor_open.h */
PRE(monitor_open_step, monitor_open_holds(state) && vectors_hold(in->sampled_pu, in->reference_pu))
POST(monitor_open_step, monitor_open_holds(state))
POST(monitor_open_step, in->switching || !result)
POST(monitor_open_step, !result || some(i, 3, state->missing[i][0] == MONITOR_OPEN_STEPS ||
     state->missing[i][1] == MONITOR_OPEN_STEPS || state->zeros[i] == MONITOR_OPEN_STEPS))
POST(monitor_open_step, state->steps_known <= 2 && state->theta_turn == in->theta_turn &&
     is_within(state->step_turn, -32768, 32767))

POST(monitor_open_reason, result == REASON_PHASE_OPEN || result == REASON_CURRENT_SUM)
POST(monitor_open_reason, current_sum_pu != 0 || result == REASON_PHASE_OPEN)

/* monitor/monitor_speed.h */
PRE(monitor_speed_step, monitor_speed_holds(state, config))
POST(monitor_speed_step, monitor_speed_holds(state, config))
POST(monitor_speed_step, result >= 0 && (int64_t)result * 1000 <= state->bound_urad_s)
POST(monitor_speed_step, !bridge_is_short(in->bridge) || state->windows == 2 || state->bound_urad_s
     >= old(state->bound_urad_s))

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
POST(monitor_stuck_step, in->tripped || in->turning || result.side == BRIDGE_OFF)
POST(monitor_stuck_step, in->tripped || !result.release_break)
POST(monitor_stuck_step, result.fault == (result.side == BRIDGE_OFF ? REASON_NONE :
     REASON_HARDWARE_BREAK))
POST(monitor_stuck_step, result.side == BRIDGE_OFF || old(state->side) != BRIDGE_OFF || (in->bridge
     != BRIDGE_PWM && in->currents_known && in->rotor_valid))
POST(monitor_stuck_step, !(in->tripped || in->turning) || old(state->side) == BRIDGE_OFF ||
     result.side == old(state->side))

/* monitor/monitor_temperature.h */
POST(monitor_temperature_init, !state->started && !state->stuck && state->heal_steps == 0 &&
     state->offset_q16 == 0)
POST(monitor_temperature_init, temperature_sensor_holds(state))

POST(monitor_temperature_outside, !result || measured_cC < 0 || measured_cC > 10000)
POST(monitor_temperature_outside, result || is_within(measured_cC, -20000, 29998))

PRE(monitor_temperature_step, is_within(in->measured_cC, -100000, 100000) &&
     is_within(in->estimate_cC, -32700, 32700) && is_within(in->slowest_cC, -32700, 32700))
PRE(monitor_temperature_step, is_within(state->kept_cC, -20000, 29998) &&
     is_within(state->kept_estimate_cC, -32700, 32700))
PRE(monitor_temperature_step, is_within(state->offset_q16, -MONITOR_TEMPERATURE_OFFSET_MOST_cC *
     65536, MONITOR_TEMPERATURE_OFFSET_MOST_cC * 65536) && state->heal_steps <=
     MONITOR_TEMPERATURE_HEAL_STEPS)
POST(monitor_temperature_step, is_within(state->kept_cC, -20000, 29998) &&
     is_within(state->kept_estimate_cC, -32700, 32700))
POST(monitor_temperature_step, is_within(state->offset_q16, -MONITOR_TEMPERATURE_OFFSET_MOST_cC *
     65536, MONITOR_TEMPERATURE_OFFSET_MOST_cC * 65536) && state->heal_steps <=
     MONITOR_TEMPERATURE_HEAL_STEPS)
POST(monitor_temperature_step, in->limit_cC < MONITOR_TEMPERATURE_OFF_cC || (!result.broken &&
     result.used_cC == in->measured_cC))
POST(monitor_temperature_step, in->limit_cC >= MONITOR_TEMPERATURE_OFF_cC ||
     is_within(in->measured_cC, config->monitor.lowest_temperature_cC,
     config->monitor.highest_temperature_cC) ? result.used_cC >= in->measured_cC : in->estimated ?
     is_within(result.used_cC, in->estimate_cC - 2000, in->estimate_cC + 2000) : result.used_cC ==
     MONITOR_TEMPERATURE_BROKEN_cC)
POST(monitor_temperature_step, in->limit_cC >= MONITOR_TEMPERATURE_OFF_cC || result.broken ==
     (state->heal_steps > 0))

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
POST(safe_state_short, result.charging_mA == 0 && result.bus_mV == in->bus_voltage_mV)

POST(safe_state_step, result.bridge == BRIDGE_OFF || result.bridge == BRIDGE_SHORT)
POST(safe_state_step, !in->battery_open || (result.freewheel.current_mA == 0 &&
     result.freewheel.charging_mA == 0 && result.freewheel.torque_mNm == 0))
POST(safe_state_step, result.bridge != BRIDGE_OFF || result.freewheel.current_mA == 0 ||
     result.freewheel.bus_mV == in->bus_voltage_mV)

POST(safe_state_short_surges, !result || (freewheel->current_mA <=
     config->motor.max_phase_current_mA && freewheel->bus_mV < config->drive.device_voltage_mV))

POST(safe_state_shorted, result.bridge == side && result.freewheel.current_mA == 0 &&
     result.freewheel.charging_mA == 0 && result.freewheel.bus_mV == in->bus_voltage_mV)

/* monitor/short_exit.h */
POST(short_exit_fits, in->i_d_mA != 0 || in->i_q_mA != 0 || in->turning_mrad_s != 0 || in->bus_mV !=
     0 || result)

/* SPDX-License-Identifier: Apache-2.0 */
/*
 * accessors.h: every value of the firmware that the oracle hashes, and nothing else knows how one
 * is read.
 *
 *     X(identifier, C expression)
 *
 * An identifier is for ever, and so is the order of the lines: the stored hashes depend on both
 * order and values. A rename in the firmware changes an expression here; a value that is computed
 * elsewhere, or is no longer given in one piece, gets the expression that still makes it. Each is
 * hashed as a signed integer of 64 bits.
 *
 * tests/oracle/test_accessors.py compares the lists with the firmware's headers. A field that is
 * given since the baseline was stored stands in ORACLE_NOT_HASHED, with the reason, until a
 * baseline has it.
 */
#ifndef ORACLE_ACCESSORS_H
#define ORACLE_ACCESSORS_H

/* clang-format off */

/* of a fast step; const fast_output_t *output */
#define ORACLE_FAST_OUTPUT(X) \
    X(compare_a_counts, output->compare_counts[0]) \
    X(compare_b_counts, output->compare_counts[1]) \
    X(compare_c_counts, output->compare_counts[2]) \
    X(bridge, output->bridge)

/* complete, as the slow step gets it; const fast_report_t *report */
#define ORACLE_FAST_REPORT(X) \
    X(sample_unsaturated_d_q25, report->sample.unsaturated_d_q25) \
    X(sample_unsaturated_q_q25, report->sample.unsaturated_q_q25) \
    X(sample_flux_alpha_q14, q_pair_x(report->sample.flux_q14.v)) \
    X(sample_flux_beta_q14, q_pair_y(report->sample.flux_q14.v)) \
    X(sample_theta_turn, report->sample.theta_turn) \
    X(sequence, report->sequence) \
    X(sum_i_d_pu, report->sums.i_d_pu) \
    X(sum_i_q_pu, report->sums.i_q_pu) \
    X(sum_power_pu, report->sums.power_pu) \
    X(sum_v_dc_pu, report->sums.v_dc_pu) \
    X(i_d_pu, dq_of(report->i_pu).d) \
    X(i_q_pu, dq_of(report->i_pu).q) \
    X(u_d_pu, dq_of(report->u_pu).d) \
    X(u_q_pu, dq_of(report->u_pu).q) \
    X(voltage_use_q15, report->voltage_use_q15) \
    X(voltage_limited, report->voltage_limited) \
    X(adc_saturated, report->adc_saturated) \
    X(current_sum_pu, report->current_sum_pu) \
    X(wrong_current_sensor, report->wrong_current_sensor) \
    X(current_undetermined, report->current_undetermined) \
    X(i_d_weakening_pu, report->i_d_weakening_pu) \
    X(offset_a_q4, report->offset_q4[0]) \
    X(offset_b_q4, report->offset_q4[1]) \
    X(offset_c_q4, report->offset_q4[2]) \
    X(offsets_done, report->offsets_done) \
    X(speed_q32, report->speed_q32) \
    X(rotor_valid, report->sensor_valid) \
    X(observer_speed_q32, report->observer.speed_q32) \
    X(observer_theta_turn, report->observer.theta_turn) \
    X(observer_flux_d_q14, dq_of(report->observer.flux_q14).d) \
    X(observer_flux_q_q14, dq_of(report->observer.flux_q14).q) \
    X(observer_sensor_turn, report->observer.sensor_turn) \
    X(observer_acquired, report->observer.acquired) \
    X(rotor_faults, report->rotor_faults) \
    X(quadrant_transitions, report->quadrant_transitions) \
    X(quadrant_step, report->quadrant_step) \
    X(idle_alpha_pu, report->idle_alpha_pu) \
    X(idle_beta_pu, report->idle_beta_pu) \
    X(trip, report->trip) \
    X(report_bridge, report->bridge)

/* of a slow step to the fast loop; const fast_setpoint_t *setpoint */
#define ORACLE_SETPOINT(X) \
    X(setpoint_sequence, setpoint->sequence) \
    X(i_d_reference_pu, setpoint->i_reference_pu.d) \
    X(i_q_reference_pu, setpoint->i_reference_pu.q) \
    X(i_d_sampling_correction_pu, setpoint->i_d_sampling_correction_pu) \
    X(d_proportional_q10, setpoint->tuning.d.proportional_q10) \
    X(d_integral_q15, setpoint->tuning.d.integral_q15) \
    X(d_anti_windup_q15, setpoint->tuning.d.anti_windup_q15) \
    X(q_proportional_q10, setpoint->tuning.q.proportional_q10) \
    X(q_integral_q15, setpoint->tuning.q.integral_q15) \
    X(q_anti_windup_q15, setpoint->tuning.q.anti_windup_q15) \
    X(w_l_d_q10, setpoint->tuning.w_l_d_q10) \
    X(w_l_q_q10, setpoint->tuning.w_l_q_q10) \
    X(forward_d_q25, setpoint->tuning.forward_d_q25) \
    X(forward_q_q25, setpoint->tuning.forward_q_q25) \
    X(advance_cos_q15, q_pair_x(setpoint->tuning.advance.v)) \
    X(advance_sin_q15, q_pair_y(setpoint->tuning.advance.v)) \
    X(dead_time_alpha_q8, setpoint->dead_time_slope.alpha_q8) \
    X(dead_time_beta_q8, setpoint->dead_time_slope.beta_q8) \
    X(observer_volt_alpha_q15, q_pair_x(setpoint->observer.volt)) \
    X(observer_volt_beta_q15, q_pair_y(setpoint->observer.volt)) \
    X(observer_minus_resistance_alpha_q15, q_pair_x(setpoint->observer.minus_resistance)) \
    X(observer_minus_resistance_beta_q15, q_pair_y(setpoint->observer.minus_resistance)) \
    X(observer_minus_inductance_alpha_q15, q_pair_x(setpoint->observer.minus_inductance)) \
    X(observer_minus_inductance_beta_q15, q_pair_y(setpoint->observer.minus_inductance)) \
    X(observer_minus_leak_alpha_q16, q_pair_x(setpoint->observer.minus_leak)) \
    X(observer_minus_leak_beta_q16, q_pair_y(setpoint->observer.minus_leak)) \
    X(observer_lead_turn, setpoint->observer.lead_turn) \
    X(observer_used, setpoint->observer.used) \
    X(calibrate_offsets, setpoint->calibrate_offsets) \
    X(torque_enabled, setpoint->torque_enabled) \
    X(clear_trip, setpoint->clear_trip) \
    X(release_break, setpoint->release_break) \
    X(safe_bridge, setpoint->safe_bridge) \
    X(least_square, setpoint->least_square)

/* of a slow step to the vehicle; const slow_output_t *output */
#define ORACLE_SLOW_OUTPUT(X) \
    X(motor_torque_command_mNm, output->motor_torque_command_mNm) \
    X(motor_torque_estimate_mNm, output->motor_torque_estimate_mNm) \
    X(hydraulic_torque_mNm, output->hydraulic_torque_mNm) \
    X(electric_brake_available_mNm, output->electric_brake_available_mNm) \
    X(electric_brake_ahead_mNm, output->electric_brake_ahead_mNm) \
    X(drive_available_mNm, output->drive_available_mNm) \
    X(drive_ahead_mNm, output->drive_ahead_mNm) \
    X(speed_mrad_s, output->speed_mrad_s) \
    X(i_d_mA, output->i_d_mA) \
    X(i_q_mA, output->i_q_mA) \
    X(bus_voltage_mV, output->bus_voltage_mV) \
    X(bus_current_mA, output->bus_current_mA) \
    X(torque_reason, output->torque_reason) \
    X(available_reason, output->available_reason) \
    X(ahead_reason, output->ahead_reason) \
    X(drive_available_reason, output->drive_available_reason) \
    X(drive_ahead_reason, output->drive_ahead_reason) \
    X(hydraulic_reason, output->hydraulic_reason) \
    X(fault_reason, output->fault_reason) \
    X(mode, output->mode) \
    X(waits_for, output->waits_for) \
    X(warning_reason, output->warning_reason) \
    X(present_warning, output->present_warning) \
    X(direction, output->direction) \
    X(hydraulic_valid, output->hydraulic_valid) \
    X(stop_lamp, output->stop_lamp) \
    X(standstill, output->standstill)

/* the table of torque limits after a slow step; const torque_limits_t *limits */
#define ORACLE_LIMIT_LINE(X, identifier, line) \
    X(driving_##identifier##_mNm, limits->driving[line].torque_mNm) \
    X(driving_##identifier##_reason, limits->driving[line].reason) \
    X(braking_##identifier##_mNm, limits->braking[line].torque_mNm) \
    X(braking_##identifier##_reason, limits->braking[line].reason)
#define ORACLE_LIMITS(X) \
    ORACLE_LIMIT_LINE(X, max_torque, TORQUE_LINE_MAX_TORQUE) \
    ORACLE_LIMIT_LINE(X, max_power, TORQUE_LINE_MAX_POWER) \
    ORACLE_LIMIT_LINE(X, phase_current, TORQUE_LINE_PHASE_CURRENT) \
    ORACLE_LIMIT_LINE(X, voltage, TORQUE_LINE_VOLTAGE) \
    ORACLE_LIMIT_LINE(X, drawn, TORQUE_LINE_DRAWN) \
    ORACLE_LIMIT_LINE(X, returned, TORQUE_LINE_RETURNED) \
    ORACLE_LIMIT_LINE(X, returned_peak, TORQUE_LINE_RETURNED_PEAK) \
    ORACLE_LIMIT_LINE(X, max_speed, TORQUE_LINE_MAX_SPEED) \
    ORACLE_LIMIT_LINE(X, winding, TORQUE_LINE_WINDING) \
    ORACLE_LIMIT_LINE(X, switch, TORQUE_LINE_SWITCH) \
    ORACLE_LIMIT_LINE(X, rotor, TORQUE_LINE_ROTOR) \
    ORACLE_LIMIT_LINE(X, enable, TORQUE_LINE_ENABLE) \
    ORACLE_LIMIT_LINE(X, current_gain, TORQUE_LINE_CURRENT_GAIN) \
    ORACLE_LIMIT_LINE(X, loss_optimum, TORQUE_LINE_LOSS_OPTIMUM) \
    ORACLE_LIMIT_LINE(X, electric_rated, TORQUE_LINE_ELECTRIC_RATED) \
    ORACLE_LIMIT_LINE(X, blend_out, TORQUE_LINE_BLEND_OUT) \
    ORACLE_LIMIT_LINE(X, electric_share, TORQUE_LINE_ELECTRIC_SHARE) \
    ORACLE_LIMIT_LINE(X, abs, TORQUE_LINE_ABS)

/* what is an event when it changes; report, setpoint and output of a slow step */
#define ORACLE_EVENTS(X) \
    X(mode, output->mode) \
    X(fault_reason, output->fault_reason) \
    X(warning_reason, output->warning_reason) \
    X(present_warning, output->present_warning) \
    X(torque_reason, output->torque_reason) \
    X(available_reason, output->available_reason) \
    X(drive_available_reason, output->drive_available_reason) \
    X(hydraulic_reason, output->hydraulic_reason) \
    X(hydraulic_valid, output->hydraulic_valid) \
    X(waits_for, output->waits_for) \
    X(direction, output->direction) \
    X(stop_lamp, output->stop_lamp) \
    X(standstill, output->standstill) \
    X(torque_enabled, setpoint->torque_enabled) \
    X(safe_bridge, setpoint->safe_bridge) \
    X(observer_used, setpoint->observer.used) \
    X(calibrate_offsets, setpoint->calibrate_offsets) \
    X(clear_trip, setpoint->clear_trip) \
    X(release_break, setpoint->release_break) \
    X(trip, report->trip) \
    X(report_bridge, report->bridge)

/* the slow steps of which --reached gives the number */
#define ORACLE_COUNTED(X) \
    X(slow_steps, true) \
    X(motor_commands, output->motor_torque_command_mNm != 0) \
    X(hydraulic_commands, output->hydraulic_torque_mNm != 0) \
    X(switching, report->bridge == BRIDGE_PWM)

/* and those by the number of a mode, a reason */
#define ORACLE_COUNTED_BY_NUMBER(X) \
    X(mode, output->mode) \
    X(bridge, report->bridge) \
    X(trip, report->trip) \
    X(fault, output->fault_reason) \
    X(warning, output->warning_reason) \
    X(present_warning, output->present_warning) \
    X(torque_limit, output->torque_reason) \
    X(brake_limit, output->available_reason) \
    X(drive_limit, output->drive_available_reason) \
    X(hydraulic_limit, output->hydraulic_reason) \
    X(waits_for, output->waits_for)

/* X(structure, field, "reason"): not part of the stored hashes */
#define ORACLE_NOT_HASHED(X) \
    X(slow_output_t, motor_torque_uncertainty_mNm, "no baseline has it yet") \
    X(torque_limits_t, losses, "between two modules of the slow step, shown nowhere") \
    X(torque_limits_t, drawn_b, "between two modules of the slow step, shown nowhere") \
    X(torque_limits_t, winding_lasting_mA, "likewise") \
    X(torque_limits_t, switch_lasting_mA, "likewise") \
    X(torque_limits_t, sensed, "likewise") \
    X(torque_limits_t, winding_hotter_cC, "likewise") \
    X(torque_limits_t, optimum_mNm, "likewise") \
    X(torque_limits_t, current_missing_q15, "likewise") \
    X(torque_limits_t, at, "read in the next step alone")

/* clang-format on */

#endif

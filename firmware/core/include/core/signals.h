/* SPDX-License-Identifier: Apache-2.0 */
/*
 * signals.h: the one table of signals, the inputs and outputs of the controller's two steps and the
 * view of its current loop: names, units, ranges, meanings, and where each of them is in the
 * messages.
 *
 *     X(name_unit, raw name, member, type, scale, lowest, highest, start, "unit", "meaning")
 *
 * member is the member of fast_input_t, fast_output_t, fast_view_t, slow_input_t or slow_output_t;
 * a test compares the table with these structures. The raw value is the integer in that member;
 * lowest, highest and start (of an input) are raw. scale names the conversion between raw and
 * engineering values: PLAIN the number itself, MILLI, CENTI, TURN (65 536 to one), CURRENT_CODE and
 * VOLTAGE_CODE of the converter, CURRENT_PU and SHARE Q15 of the current base and of one, DUTY
 * timer counts. type is the kind of variable for a tool: REAL, FLAG or CODE (an integer with
 * enumerated meaning).
 *
 * Everything that offers a controller to other programs (Python, FMU, XCP) reads this table, so a
 * signal has one name, one unit and one meaning everywhere. Units and texts are of no use to a
 * firmware, which takes the members alone. Signs: core/slow_messages.h.
 */
#ifndef CORE_SIGNALS_H
#define CORE_SIGNALS_H

/* clang-format off */

#define SIGNALS_FAST_INPUTS(X) \
    X(phase_a_a, phase_current_code_a, phase_current_code[0], \
      REAL, CURRENT_CODE, 0, 4095, 2048, "A", \
      "current into phase a at the sampling instant") \
    X(phase_b_a, phase_current_code_b, phase_current_code[1], \
      REAL, CURRENT_CODE, 0, 4095, 2048, "A", \
      "current into phase b at the sampling instant") \
    X(phase_c_a, phase_current_code_c, phase_current_code[2], \
      REAL, CURRENT_CODE, 0, 4095, 2048, "A", \
      "current into phase c at the sampling instant") \
    X(bus_voltage_v, bus_voltage_code, bus_voltage_code, REAL, VOLTAGE_CODE, 0, 4095, 0, "V", \
      "DC bus voltage at the sampling instant") \
    X(rotor_angle_turn, rotor_angle_turn, rotor_angle_turn, REAL, TURN, 0, 65535, 0, "turn", \
      "electrical angle of the rotor, any number of turns; read with an angle sensor only") \
    X(encoder_count, encoder_count, encoder.count, CODE, PLAIN, 0, 65535, 0, "", \
      "free running, four to a line; read with an encoder only") \
    X(encoder_index_count, encoder_index_count, encoder.index_count, CODE, PLAIN, 0, 65535, 0, "", \
      "the count at the latest index pulse") \
    X(encoder_index, encoder_index, encoder.index, FLAG, PLAIN, 0, 1, 0, "", \
      "an index pulse came since the last period") \
    X(hall_state, hall_state, hall_state, CODE, PLAIN, 0, 7, 0, "", \
      "bit 0 hall A, bit 1 B, bit 2 C; read with hall sensors only") \
    X(power_stage_fault, power_stage_fault, power_stage_fault, FLAG, PLAIN, 0, 1, 0, "", \
      "gate driver or break input active")

#define SIGNALS_FAST_OUTPUTS(X) \
    X(duty_a, compare_counts_a, compare_counts[0], REAL, DUTY, 0, 65535, 0, "1", \
      "share of the next period in which the high-side switch of phase a is on") \
    X(duty_b, compare_counts_b, compare_counts[1], REAL, DUTY, 0, 65535, 0, "1", \
      "share of the next period in which the high-side switch of phase b is on") \
    X(duty_c, compare_counts_c, compare_counts[2], REAL, DUTY, 0, 65535, 0, "1", \
      "share of the next period in which the high-side switch of phase c is on") \
    X(bridge, bridge, bridge, CODE, PLAIN, 0, 3, 0, "", \
      "0 freewheel: all switches off, 1 pulse-width modulation, 2 active short circuit, " \
      "3 the same on the high side")

#define SIGNALS_FAST_VIEW(X) \
    X(current_d_a, i_d_pu, i_d_pu, REAL, CURRENT_PU, -32768, 32767, 0, "A", \
      "direct-axis current at the sampling instant, peak phase value") \
    X(current_q_a, i_q_pu, i_q_pu, REAL, CURRENT_PU, -32768, 32767, 0, "A", \
      "quadrature-axis current at the sampling instant, peak phase value") \
    X(reference_d_a, i_d_reference_pu, i_d_reference_pu, \
      REAL, CURRENT_PU, -32768, 32767, 0, "A", \
      "reference of the direct-axis current, before the prefilter") \
    X(reference_q_a, i_q_reference_pu, i_q_reference_pu, \
      REAL, CURRENT_PU, -32768, 32767, 0, "A", \
      "reference of the quadrature-axis current, before the prefilter") \
    X(voltage_d, u_d_pu, u_d_pu, REAL, SHARE, -32768, 32767, 0, "1", \
      "direct-axis voltage of the next period, share of the voltage circle") \
    X(voltage_q, u_q_pu, u_q_pu, REAL, SHARE, -32768, 32767, 0, "1", \
      "quadrature-axis voltage of the next period, share of the voltage circle") \
    X(angle_turn, theta_turn, theta_turn, REAL, TURN, 0, 65535, 0, "turn", \
      "electrical angle in use at the sampling instant")

#define SIGNALS_SLOW_INPUTS(X) \
    X(drive_torque_nm, drive_torque_mNm, demand.drive_torque_mNm, \
      REAL, MILLI, INT32_MIN, INT32_MAX, 0, "N.m", \
      "driving torque demanded of this wheel, positive forward; lift-off braking where it is " \
      "against the direction") \
    X(brake_torque_nm, brake_torque_mNm, demand.brake_torque_mNm, \
      REAL, MILLI, 0, INT32_MAX, 0, "N.m", \
      "braking torque demanded of this wheel, motor and hydraulic brake together, magnitude") \
    X(demand_age_s, demand_age_ms, demand_age_ms, REAL, MILLI, 0, INT32_MAX, 0, "s", \
      "time since the last valid demand") \
    X(bms_charge_current_a, bms_charge_current_mA, bms.charge_current_mA, \
      REAL, MILLI, 0, INT32_MAX, 2000000000, "A", \
      "present charge current limit of the whole pack, magnitude") \
    X(bms_discharge_current_a, bms_discharge_current_mA, bms.discharge_current_mA, \
      REAL, MILLI, 0, INT32_MAX, 2000000000, "A", \
      "present discharge current limit of the whole pack, magnitude") \
    X(bms_contactor, bms_contactor, bms.contactor, CODE, PLAIN, 0, 2, 0, "", \
      "the pack's main contactor: 0 not reported, 1 closed, 2 open") \
    X(bms_charge_peak_current_a, bms_charge_peak_current_mA, bms.charge_peak_current_mA, \
      REAL, MILLI, 0, INT32_MAX, 0, "A", \
      "charge current of the whole pack allowed for a short time, magnitude; 0: not given") \
    X(hydraulic_feedback_nm, hydraulic_feedback_mNm, hydraulic.torque_mNm, \
      REAL, MILLI, INT32_MIN, INT32_MAX, 0, "N.m", \
      "measured torque of the hydraulic brake, magnitude") \
    X(hydraulic_feedback_age_s, hydraulic_feedback_age_ms, hydraulic.age_ms, \
      REAL, MILLI, 0, INT32_MAX, 0, "s", "time since it was received") \
    X(hydraulic_feedback_valid, hydraulic_feedback_valid, hydraulic.valid, \
      FLAG, PLAIN, 0, 1, 0, "", "it was received and its sensor takes it for plausible") \
    X(winding_temperature_c, winding_temperature_cC, temperature.winding_cC, \
      REAL, CENTI, -30000, 100000, 2500, "degC", \
      "temperature of the motor winding") \
    X(switch_temperature_c, switch_temperature_cC, temperature.switch_cC, \
      REAL, CENTI, -30000, 100000, 2500, "degC", \
      "temperature of the inverter switches") \
    X(enable, enable, demand.enable, FLAG, PLAIN, 0, 1, 0, "", \
      "the driver has switched the vehicle on") \
    X(direction, direction, demand.direction, CODE, PLAIN, 0, 2, 1, "", \
      "drive direction selected: 0 neutral, 1 forward, 2 reverse") \
    X(abs_active, abs_active, demand.abs_active, FLAG, PLAIN, 0, 1, 0, "", \
      "the anti-lock system intervenes: electric braking only as it permits") \
    X(abs_motor_share_percent, abs_motor_share_percent, demand.abs_motor_share_percent, \
      CODE, PLAIN, 0, 100, 0, "", \
      "largest share of the braking demand that the motor makes meanwhile, per cent") \
    X(fault_reset, fault_reset, demand.fault_reset, FLAG, PLAIN, 0, 1, 0, "", \
      "its rising edge acknowledges a latched fault") \
    X(selftest_passed, selftest_passed, selftest_passed, FLAG, PLAIN, 0, 1, 1, "", \
      "the hardware's power-up checks have passed") \
    X(config_accepted, config_accepted, config_accepted, FLAG, PLAIN, 0, 1, 1, "", \
      "the configuration was accepted at boot") \
    X(demand_reason, demand_reason, demand.reason, CODE, PLAIN, 0, 255, 0, "", \
      "why a torque is not what the pedal says; 0: it is") \
    X(bms_voltage_v, bms_voltage_mV, bms.voltage_mV, REAL, MILLI, 0, INT32_MAX, 0, "V", \
      "voltage at the terminals of the pack; 0: not given") \
    X(bms_current_a, bms_current_mA, bms.current_mA, REAL, MILLI, INT32_MIN, INT32_MAX, 0, "A", \
      "measured current of the pack, positive out of it") \
    X(bms_current_given, bms_current_given, bms.current_given, FLAG, PLAIN, 0, 1, 0, "", \
      "the battery's message gives its current")

#define SIGNALS_SLOW_OUTPUTS(X) \
    X(motor_torque_command_nm, motor_torque_command_mNm, motor_torque_command_mNm, \
      REAL, MILLI, INT32_MIN, INT32_MAX, 0, "N.m", \
      "present torque setpoint of the current loop, at the shaft, signed") \
    X(motor_torque_estimate_nm, motor_torque_estimate_mNm, motor_torque_estimate_mNm, \
      REAL, MILLI, INT32_MIN, INT32_MAX, 0, "N.m", \
      "torque at the shaft, from measured currents, signed") \
    X(hydraulic_torque_nm, hydraulic_torque_mNm, hydraulic_torque_mNm, \
      REAL, MILLI, INT32_MIN, INT32_MAX, 0, "N.m", \
      "command to the hydraulic brake, magnitude") \
    X(electric_brake_available_nm, electric_brake_available_mNm, electric_brake_available_mNm, \
      REAL, MILLI, INT32_MIN, INT32_MAX, 0, "N.m", \
      "present limit of the electric braking torque, magnitude") \
    X(electric_brake_ahead_nm, electric_brake_ahead_mNm, electric_brake_ahead_mNm, \
      REAL, MILLI, INT32_MIN, INT32_MAX, 0, "N.m", \
      "limit of the electric braking torque expected 0.3 s later, magnitude") \
    X(drive_available_nm, drive_available_mNm, drive_available_mNm, \
      REAL, MILLI, INT32_MIN, INT32_MAX, 0, "N.m", \
      "present limit of the driving torque, magnitude") \
    X(drive_ahead_nm, drive_ahead_mNm, drive_ahead_mNm, \
      REAL, MILLI, INT32_MIN, INT32_MAX, 0, "N.m", \
      "limit of the driving torque expected 0.3 s later, magnitude") \
    X(speed_rad_per_s, speed_mrad_s, speed_mrad_s, REAL, MILLI, INT32_MIN, INT32_MAX, 0, "rad/s", \
      "mechanical speed, estimated") \
    X(current_d_a, i_d_mA, i_d_mA, REAL, MILLI, INT32_MIN, INT32_MAX, 0, "A", \
      "direct-axis current, peak phase value, mean of a slow step") \
    X(current_q_a, i_q_mA, i_q_mA, REAL, MILLI, INT32_MIN, INT32_MAX, 0, "A", \
      "quadrature-axis current, peak phase value, mean of a slow step") \
    X(bus_voltage_v, bus_voltage_mV, bus_voltage_mV, REAL, MILLI, INT32_MIN, INT32_MAX, 0, "V", \
      "DC bus voltage, measured") \
    X(bus_current_a, bus_current_mA, bus_current_mA, REAL, MILLI, INT32_MIN, INT32_MAX, 0, "A", \
      "DC bus current, estimated, positive out of the battery") \
    X(torque_reason, torque_reason, torque_reason, CODE, PLAIN, 0, 255, 0, "", \
      "reason of the limit of the motor torque; 0: no limit") \
    X(available_reason, available_reason, available_reason, CODE, PLAIN, 0, 255, 0, "", \
      "reason of the limit of the electric braking torque") \
    X(ahead_reason, ahead_reason, ahead_reason, CODE, PLAIN, 0, 255, 0, "", \
      "reason of the limit of the electric braking torque expected 0.3 s later") \
    X(drive_available_reason, drive_available_reason, drive_available_reason, \
      CODE, PLAIN, 0, 255, 0, "", "reason of the limit of the driving torque") \
    X(drive_ahead_reason, drive_ahead_reason, drive_ahead_reason, \
      CODE, PLAIN, 0, 255, 0, "", \
      "reason of the limit of the driving torque expected 0.3 s later") \
    X(hydraulic_reason, hydraulic_reason, hydraulic_reason, CODE, PLAIN, 0, 255, 0, "", \
      "reason of a demand beyond motor and hydraulic brake; 0: demand met") \
    X(fault_reason, fault_reason, fault_reason, CODE, PLAIN, 0, 255, 0, "", \
      "the latched fault; 0: healthy") \
    X(warning_reason, warning_reason, warning_reason, CODE, PLAIN, 0, 255, 0, "", \
      "the latched warning, else the present one; 0: none") \
    X(mode, mode, mode, CODE, PLAIN, 0, 6, 0, "", \
      "0 boot, 1 self-test, 2 offset calibration, 3 ready, 4 run, 5 limp, 6 fault") \
    X(waits_for, waits_for, waits_for, CODE, PLAIN, 0, 255, 0, "", \
      "what driving torque waits for, by firmware/core/include/core/waits_for.h; 0: none") \
    X(direction, direction, direction, CODE, PLAIN, 0, 2, 0, "", \
      "in which driving torque is made: 0 neutral, 1 forward, 2 reverse") \
    X(hydraulic_valid, hydraulic_valid, hydraulic_valid, FLAG, PLAIN, 0, 1, 0, "", \
      "0: the demand is lost, the brake system takes its own path") \
    X(stop_lamp, stop_lamp, stop_lamp, FLAG, PLAIN, 0, 1, 0, "", \
      "1: the stop lamp is lit") \
    X(standstill, standstill, standstill, FLAG, PLAIN, 0, 1, 0, "", \
      "the wheel is known to be at rest (firmware/monitor, Standstill)") \
    X(present_warning, present_warning, present_warning, CODE, PLAIN, 0, 255, 0, "", \
      "the present warning, behind a latched one too; 0: none") \
    X(motor_torque_uncertainty_nm, motor_torque_uncertainty_mNm, motor_torque_uncertainty_mNm, \
      REAL, MILLI, 0, INT32_MAX, 0, "N.m", \
      "standard uncertainty of motor_torque_estimate_nm; 2147483 and more: unknown")
/* clang-format on */

#define SIGNALS_COUNT(...) +1
enum {
    SIGNALS_FAST_INPUT_COUNT = 0 SIGNALS_FAST_INPUTS(SIGNALS_COUNT),
    SIGNALS_FAST_OUTPUT_COUNT = 0 SIGNALS_FAST_OUTPUTS(SIGNALS_COUNT),
    SIGNALS_FAST_VIEW_COUNT = 0 SIGNALS_FAST_VIEW(SIGNALS_COUNT),
    SIGNALS_SLOW_INPUT_COUNT = 0 SIGNALS_SLOW_INPUTS(SIGNALS_COUNT),
    SIGNALS_SLOW_OUTPUT_COUNT = 0 SIGNALS_SLOW_OUTPUTS(SIGNALS_COUNT)
};
#undef SIGNALS_COUNT

#endif

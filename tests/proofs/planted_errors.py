# SPDX-License-Identifier: Apache-2.0
"""Errors in the sources under proof, each of which one proof must find."""

from dataclasses import dataclass


@dataclass(frozen=True)
class PlantedError:
    """A text of a source, which stands there once, and what takes its place."""

    function: str  # whose proof must fail, or the name of a proof in prove_composition.c
    source: str  # below firmware/
    right: str
    wrong: str


PLANTED = (
    PlantedError("pedals_step", "pedals/pedals.c",
                 "state->must_release ? q_min(wanted_mNm, 0) : wanted_mNm", "wanted_mNm"),
    PlantedError("monitor_open_step", "monitor/monitor_open.c",
                 "q_min(counted, MONITOR_OPEN_STEPS)", "counted"),
    PlantedError("monitor_emf_step", "monitor/monitor_emf.c",
                 "judged && wrong && !now->report->voltage_limited", "judged && wrong"),
    PlantedError("monitor_speed_step", "monitor/monitor_speed.c",
                 "larger(state->bound_urad_s - fall, sensor_urad_s)", "state->bound_urad_s - fall"),
    PlantedError("motor_model_x_per_d", "motor/motor_model.c",
                 "within_b(scaled_ratio(-scaled_multiply", "(scaled_ratio(-scaled_multiply"),
    PlantedError("motor_constants_init", "motor/motor_constants.c",
                 "config->rotor.sensor == CONFIG_ROTOR_HALL", "true"),
    PlantedError("thermal_model_step", "motor/thermal_model.c",
                 "now_q16 > MOST_q16 ? MOST_q16 : ", ""),
    PlantedError("hydraulic_model_step", "torque/hydraulic_model.c",
                 "torque_q6 + q_limit(change_q6, largest_q6)", "torque_q6 + change_q6"),
    PlantedError("hydraulic_feedback_step", "torque/hydraulic_feedback.c",
                 "q_max(state->report_mNm + change_mNm, 0)", "state->report_mNm + change_mNm"),
    PlantedError("temperatures_step", "controller/temperatures.c",
                 "return sensor->shows ? q_max(sensor->shown_cC, model_cC) : model_cC;",
                 "return model_cC;"),
    PlantedError("operating_point_setpoint", "controller/operating_point.c",
                 "setpoint->i_reference_pu.q = q_saturate16(sampled_pu.q)",
                 "setpoint->i_reference_pu.q = sampled_pu.q"),
    PlantedError("safe_state_step", "monitor/safe_state.c",
                 "out.bridge = BRIDGE_SHORT;", "out.bridge = BRIDGE_PWM;"),
    PlantedError("torque_init", "torque/torque.c", "    hill_hold_init(&state->hold);\n", ""),
    PlantedError("monitor_step", "monitor/monitor.c",
                 "measured_battery_open(now) ? MONITOR_BUS_RETURN_STEPS",
                 "measured_battery_open(now) ? 0"),
    PlantedError("controller_fast_report_copy", "controller/fast_step.c",
                 "    report->trip = fast->monitor.trip;\n", ""),
    PlantedError("recorder_slow", "app/recorder.c",
                 "next + 1U < RECORDER_SLOW_ENTRIES ? next + 1U : 0U", "next + 1U"),
    PlantedError("torque_limits_tightest_line", "torque/torque_limits.c",
                 "lines[line].torque_mNm < lines[out].torque_mNm",
                 "lines[line].torque_mNm > lines[out].torque_mNm"),
    PlantedError("torque_limits_at_most", "torque/torque_limits.c",
                 "    return *lines;", "    return lines[-1];"),
    PlantedError("brake_blending_step", "torque/brake_blending.c",
                 "bounds.deferrable_mNm), share_mNm));",
                 "bounds.deferrable_mNm), share_mNm) - 1);"),
    PlantedError("grid_interpolate", "core/include/core/grid.h",
                 "fraction_q20 + GRID_WHOLE_Q20 / 2) >> 20",
                 "fraction_q20 + GRID_WHOLE_Q20) >> 20"),
    PlantedError("grid_weights", "core/include/core/grid.h", ".at_10 = x - both", ".at_10 = x"),
    PlantedError("grid_weighted", "core/include/core/grid.h",
                 "weights->at_10 * at_10", "weights->at_10 * at_01"),
    PlantedError("loss_maps_row_d_mA", "motor/loss_maps.c",
                 "(uint32_t)part_mNm << (20 - row->step_log2)",
                 "(uint32_t)part_mNm << (21 - row->step_log2)"),
    PlantedError("loss_maps_row_at", "motor/loss_maps.c",
                 "first + (warms ? speeds * torques : 0)",
                 "first + speeds * torques"),
    PlantedError("torque_limits_line_text", "torque/torque_limits.c",
                 "return line < TORQUE_LINE_COUNT ? TEXTS[line] : \"unknown line\"",
                 "return TEXTS[line]"),
    PlantedError("feasible_holds", "motor/feasible_torque.c",
                 "feasible_most_squared(set);", "set->voltage_squared - 1;"),
    PlantedError("feasible_excess_b", "motor/feasible_power.c",
                 " + switching_b +\n                        charging_b(m, at, i_q_b, returned)",
                 " + switching_b"),
    PlantedError("feasible_ellipse_root", "motor/feasible_torque.c",
                 "*t_b = clamped_b(scaled_ratio(distance - half, squared))",
                 "*t_b = scaled_ratio(distance - half, squared)"),
    PlantedError("feasible_circle_d_b", "motor/feasible_circle.c",
                 "int32_t d_b = q_limit(map_b, m->constants->current_most_b)",
                 "int32_t d_b = map_b"),
    PlantedError("available_ahead_step", "torque/available_ahead.c",
                 "(state->step + 1U) % AVAILABLE_AHEAD_ROUND_steps;",
                 "(state->step + 1U) % (AVAILABLE_AHEAD_ROUND_steps + 1U);"),
    PlantedError("torque_step", "torque/torque.c",
                 "q_max(q_max(hydraulic_mNm, own_path_mNm) - split.hydraulic_mNm, 0)",
                 "q_max(hydraulic_mNm, own_path_mNm) - split.hydraulic_mNm - 1"),
    PlantedError("controller_fast_step", "controller/fast_step.c",
                 "return enabled && trip == REASON_NONE ?", "return enabled ?"),
    PlantedError("controller_limits", "controller/controller.c",
                 "return torque_limits_of(&slow->torque)",
                 "return torque_limits_of(&slow->torque) + 1"),
    PlantedError("controller_init", "controller/controller.c",
                 "    modes_init(&slow->modes);\n", ""),
    PlantedError("controller_slow_step", "controller/controller.c",
                 "bridge == BRIDGE_PWM;", "bridge != BRIDGE_OFF;"),
    PlantedError("road_step", "torque/road.c",
                 "q_max(-state->torque_mNm, 0)", "-state->torque_mNm"),
    PlantedError("loss_maps_row_rise_mA", "motor/loss_maps.c", "return 0;", "return 1;"),
    PlantedError("short_exit_fits", "monitor/short_exit.c",
                 "&flux, step_turn) <= (takes", "&flux, step_turn) < (takes"),
    PlantedError("feasible_point", "motor/feasible_torque.c",
                 "at.d_b = feasible_circle_d_b(set, airgap_b, at.d_b);\n"
                 "        at.x_b = motor_model_x_of_airgap_b(m, airgap_b, at.d_b)",
                 "at.d_b = feasible_circle_d_b(set, airgap_b, at.d_b);\n"
                 "        at.x_b = at.d_b"),
)  # fmt: skip


@dataclass(frozen=True)
class PlantedProofError(PlantedError):
    """An error that a proof written in C must find, which includes the source."""

    proof: str = "prove_composition.c"
    sources: tuple[str, ...] = ("foc/emf_observer.c", "foc/sense.c")


# Where a kernel would get what its proof does not assume.
PLANTED_IN_PROOFS = (
    PlantedProofError("whole_step", "foc/setpoint.c",
                 "q_saturate16(reference.d + correction)", "reference.d + correction"),
    PlantedProofError("whole_step", "foc/setpoint.c",
                 "const int32_t limited_d = q_limit(d, circle->radius_q15);",
                 "const int32_t limited_d = d;"),
    PlantedProofError("whole_step", "foc/foc.c",
                 "period->u_ab = ab16_saturated(u)", "period->u_ab.v = q_pair(u.alpha, u.beta)"),
    PlantedProofError("whole_step", "foc/foc.c",
                 "transforms_inverse_park(predicted, angle_applied)",
                 "transforms_inverse_park(i, angle_applied)"),
    PlantedProofError("whole_step", "foc/foc.c",
                 "q_saturate13(in->bus_voltage_code) * 8", "in->bus_voltage_code * 8"),
    PlantedProofError("whole_idle_step", "foc/foc.c",
                 "period->i_pu = transforms_park(i,",
                 "period->i_pu = transforms_park((ab16_t){.v = q_pair(sensed.sum_pu, 0)},"),
    PlantedProofError("frozen_currents", "foc/frozen_currents.c",
                 "!comparable || unmoved <", "unmoved <", "prove_foc.c",
                 ("core/angle.c", "core/circle.c", "foc/sense.c", "foc/sensor_isolation.c")),
    PlantedProofError("short_exit_flux", "monitor/short_exit.c",
                   "q_max(18 - (int32_t)", "q_max(17 - (int32_t)", "prove_short_exit.c", ()),
    PlantedProofError("short_exit_weighted", "monitor/short_exit.c",
                   ">> 15) - flux->magnets;", ">> 15) - 2 * flux->magnets;",
                   "prove_short_exit.c", ()),
    PlantedProofError("short_exit_takes", "monitor/short_exit.c",
                   "most_mV * most_mV - (int64_t)bus_mV * bus_mV", "most_mV * most_mV * 1000",
                   "prove_short_exit.c", ()),
    PlantedProofError("feasible_holds", "motor/feasible_torque.c",
                   "square(motor_model_u_q_b(m, at)) <=\n           feasible_most_squared(set);",
                   "square(motor_model_u_q_b(m, at)) ==\n           feasible_most_squared(set);",
                   "prove_feasible.c", ()),
)  # fmt: skip

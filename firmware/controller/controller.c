/* SPDX-License-Identifier: Apache-2.0 */
#include "controller/controller.h"

#include "config/bases.h"
#include "core/fault.h"
#include "core/q15.h"
#include "monitor/monitor_fast.h"

static uint16_t whole_counts(int32_t on_q16)
{
    return (uint16_t)((uint32_t)on_q16 >> 16);
}

static void update_output(controller_fast_t *fast, bridge_mode_t bridge)
{
    const int32_t *on_q16 = foc_on_times_q16(&fast->foc);
    for (int x = 0; x < SENSE_PHASES; x++) {
        fast->output.compare_counts[x] = whole_counts(on_q16[x]);
    }
    fast->output.bridge = bridge;
}

void controller_init(controller_t *controller, const config_t *config, int32_t timer_Hz)
{
    foc_init(&controller->fast.foc, config, timer_Hz);
    monitor_fast_init(&controller->fast.monitor, config);
    update_output(&controller->fast, BRIDGE_OFF);
    operating_point_init(&controller->slow.operating_point, config, timer_Hz);
    torque_init(&controller->slow.torque, config);
    monitor_slow_init(&controller->slow.monitor);
    modes_init(&controller->slow.modes);
    temperatures_init(&controller->slow.temperatures, config);
    const angle_choice_state_t no_rotor = {.confirmed = false};
    controller->slow.rotor = no_rotor;
    bridge_choice_init(&controller->slow.bridge_choice);
    current_expectation_init(&controller->slow.expected_current, config);
    controller->slow.last_command_mNm = 0;
    controller->slow.last_estimate_mNm = 0;
    controller->slow.step_count = 0;
}

fast_setpoint_t controller_initial_setpoint(const config_t *config, int32_t timer_Hz)
{
    fast_setpoint_t out = {.torque_enabled = false, .safe_bridge = BRIDGE_OFF};
    operating_point_initial_setpoint(config, timer_Hz, &out);
    return out;
}

/* What the bridge does; the only place that decides it. */
static bridge_mode_t bridge_command(const fast_setpoint_t *setpoint, bool enabled, reason_t trip)
{
    return enabled && trip == REASON_NONE ? BRIDGE_PWM : setpoint->safe_bridge;
}

const fast_output_t *controller_fast_step(controller_fast_t *fast, const config_t *config,
                                          const fast_setpoint_t *setpoint, const fast_input_t *in)
{
    const bool enabled = setpoint->torque_enabled;
    if (enabled && fast->monitor.trip == REASON_NONE) {
        if (foc_step(&fast->foc, config, setpoint, in)) {
            monitor_fast_trip(&fast->monitor, REASON_CURRENT_SENSOR);
        }
    } else {
        foc_idle_step(&fast->foc, config, setpoint, in);
    }

    const foc_period_t *period = foc_latest(&fast->foc);
    const monitor_fast_input_t watched = {
        .i_pu = period->i_pu,
        .v_dc_pu = period->v_dc_pu,
        .power_stage_fault = in->power_stage_fault,
        .switching = enabled,
        .clear_trip = setpoint->clear_trip,
        .slow_step_count = setpoint->sequence,
        .least_square = setpoint->least_square,
    };
    const reason_t trip = monitor_fast_step(&fast->monitor, &watched);
    update_output(fast, bridge_command(setpoint, enabled, trip));
    return &fast->output;
}

void controller_fast_report_copy(const controller_fast_t *fast, fast_report_t *report)
{
    report->trip = fast->monitor.trip;
    report->bridge = fast->output.bridge;
    foc_report_copy(&fast->foc, report);
}

void controller_fast_report_complete(fast_report_t *report)
{
    foc_report_complete(report);
}

void controller_fast_report(const controller_fast_t *fast, fast_report_t *report)
{
    controller_fast_report_copy(fast, report);
    controller_fast_report_complete(report);
}

/* By the bound of the step before, which the rotor sensor alone does not make smaller. */
static bool was_at_rest(const controller_slow_t *slow, const config_t *config)
{
    return slow->monitor.speed.rest_urad_s < INT64_C(1000) * config->monitor.standstill_mrad_s;
}

/* speed: by the sensor; on return by what is used. */
static angle_choice_output_t judge_rotor(controller_slow_t *slow, const config_t *config,
                                         const fast_report_t *report, bool cleared,
                                         rotor_speed_t *speed)
{
    const observer_view_t observer =
        operating_point_observer(&slow->operating_point, config, &report->observer);
    const angle_choice_input_t in = {
        .observer_mrad_s = observer.speed_mrad_s,
        .sensor_mrad_s = speed->wheel_mrad_s,
        .difference_turn = observer.difference_turn,
        .flux_q14 = (int16_t)observer.flux_q14.d,
        .across_q14 = (int16_t)observer.flux_q14.q,
        .expected_q14 = (int16_t)observer.expected_q14,
        .i_pu = dq_of(report->i_pu),
        .gain_suspected = slow->monitor.gain.level > 0,
        .acquired = report->observer.acquired,
        .sensor_valid = report->rotor_valid,
        .switching = report->bridge == BRIDGE_PWM,
        .cleared = cleared && report->bridge != BRIDGE_PWM && was_at_rest(slow, config),
    };
    const angle_choice_output_t out = angle_choice_step(&slow->rotor, config, &in);
    if (out.observer_used) {
        speed->turn_q32 = report->observer.speed_q32;
        speed->wheel_mrad_s = observer.speed_mrad_s;
    }
    return out;
}

/* The fast part's trip. Each can be acknowledged, but for that of the bus sensor, which heals; any
 * other number is a word in memory that was damaged. */
static reason_t trip_of(const fast_report_t *report)
{
    const reason_t trip = report->trip;
    const bool given = trip == REASON_NONE || trip == REASON_BUS_SENSOR ||
                       fault_clearing(trip) == FAULT_CLEARING_ACKNOWLEDGED;
    return given ? trip : REASON_MEMORY;
}

/* The input is built in its place: a copy of it would cost 90 instructions. */
static monitor_output_t step_monitor(controller_slow_t *slow, const config_t *config,
                                     const fast_report_t *report, const slow_input_t *in,
                                     const operating_point_t *at,
                                     const angle_choice_output_t *rotor)
{
    const monitor_slow_input_t watched = {
        .fast_trip = trip_of(report),
        .current_sum_pu = report->current_sum_pu,
        .offsets_known = report->offsets_done,
        .current_saturated = report->adc_saturated,
        .rotor_valid = rotor->valid,
        .wrong_current_sensor = report->wrong_current_sensor,
        .current_undetermined = report->current_undetermined,
        .rotor_faults = report->rotor_faults,
        .fast_step_count = report->sequence,
        .bus_voltage_mV = at->bus_voltage_mV,
        .battery_open = in->bms.contactor == CONTACTOR_OPEN,
        .battery_voltage_mV = in->bms.voltage_mV,
        .battery_current_mA = in->bms.current_given ? in->bms.current_mA : MONITOR_GAIN_NOT_GIVEN,
        .bus_current_mA = at->bus_current_mA,
        .charge_current_mA =
            q_min(q_max(in->bms.charge_current_mA, 0) / config->battery.driven_wheels,
                  config->battery.max_charge_current_mA),
        .speed_mrad_s = at->speed_mrad_s,
        .winding_temperature_cC = slow->temperatures.used.winding_cC,
        .switch_temperature_cC = slow->temperatures.used.switch_cC,
        .winding_sensor_broken = slow->temperatures.winding_broken,
        .switch_sensor_broken = slow->temperatures.switch_broken,
        .i_d_mA = at->latest_i_d_mA,
        .i_q_mA = at->latest_i_q_mA,
        .frame_known = rotor->valid && !rotor->observer_used,
        .u_d_mV = at->latest_u_d_mV,
        .u_q_mV = at->latest_u_q_mV,
        .voltage_limited = report->voltage_limited,
        .sampled_pu = at->sampled_pu,
        .reference_pu = {.d = slow->expected_current.reference_pu.d + report->i_d_weakening_pu,
                         .q = slow->expected_current.reference_pu.q},
        .latest_pu = dq_of(report->i_pu),
        .theta_turn = report->sample.theta_turn,
        .torque_command_mNm = slow->last_command_mNm,
        .torque_estimate_mNm = slow->last_estimate_mNm,
        .offset_q4 = {report->offset_q4[0], report->offset_q4[1], report->offset_q4[2]},
        .current_quarters = report->quadrant_transitions,
        .quarter_step = report->quadrant_step,
        .idle_alpha_pu = report->idle_alpha_pu,
        .idle_beta_pu = report->idle_beta_pu,
        .bridge = report->bridge,
    };
    return monitor_slow_step(&slow->monitor, config, &watched);
}

/* Lift-off braking, against the direction, is no driving: a released accelerator may demand it. */
static bool drive_demanded(const wheel_demand_t *demand)
{
    const int32_t sign = drive_direction_sign(demand->direction);
    const int32_t drive_mNm = demand->drive_torque_mNm;
    return sign > 0 ? drive_mNm > 0 : sign < 0 ? drive_mNm < 0 : drive_mNm != 0;
}

static modes_output_t decide_mode(controller_slow_t *slow, const config_t *config,
                                  const fast_report_t *report, const slow_input_t *in,
                                  const monitor_output_t *watch, bool rotor_valid)
{
    const wheel_demand_t *demand = &in->demand;
    const bool drives = drive_demanded(demand);
    const reason_t demand_warning =
        (int)demand->reason >= REASON_FIRST_FAULT ? demand->reason : REASON_NONE;
    reason_t warning = watch->warning;
    if (warning == REASON_NONE && slow->bridge_choice.overspeed) {
        warning = REASON_OVERSPEED;
    }
    if (warning == REASON_NONE && slow->rotor.sensor_wrong) {
        warning = slow->rotor.name;
    } else if (warning == REASON_NONE && slow->rotor.observer_used &&
               report->bridge == BRIDGE_PWM) {
        warning = REASON_ROTOR_UNCERTAIN;
    }
    if (warning == REASON_ROTOR_UNCERTAIN && slow->monitor.flow_level > 0) {
        warning = REASON_NONE; /* steps out of order contradict any rotor sensor */
    }
    if (warning == REASON_NONE && !slow->rotor.sensor_wrong && slow->monitor.gain.level == 0) {
        warning = brake_blending_finding(&slow->torque.blending);
    }
    warning = warning == REASON_NONE ? demand_warning : warning;
    warning = warning == REASON_NONE ? watch->flux_warning : warning;
    const modes_input_t modes_in = {
        .config_accepted = in->config_accepted,
        .selftest_passed = in->selftest_passed,
        .offsets_done = report->offsets_done,
        .offsets_plausible = watch->offsets_plausible,
        .rotor_valid =
            rotor_valid || (slow->rotor.observer_used &&
                            watch->speed_bound_mrad_s >= config->rotor.observer_speed_mrad_s),
        .rolling = watch->speed_bound_mrad_s > config->brake.blend_out_end_mrad_s,
        .at_rest = watch->at_rest,
        .enable = demand->enable,
        .demand_lost = demand_is_lost(config, in->demand_age_ms),
        .lost_reason = demand_warning == REASON_NONE ? REASON_DEMAND_TIMEOUT : demand_warning,
        .drive_demanded = drives,
        .neutral = slow->torque.demand.engaged == DRIVE_DIRECTION_NEUTRAL,
        .torque_demanded = drives || demand->brake_torque_mNm > 0,
        .fault_reset = demand->fault_reset,
        .warning = warning != REASON_NONE,
        .warning_reason = warning,
        .fault = watch->fault,
        .battery_lost = watch->battery_lost,
        .emf_conducts = watch->emf_conducts,
        .bridge = report->bridge,
    };
    return modes_step(&slow->modes, config, &modes_in);
}

/* The battery's own voltage where the sensor of the bus contradicts it, otherwise 0. Behind an open
 * contactor it limits what is zero already. */
static int32_t contradicting_mV(const slow_input_t *in, const monitor_output_t *watch)
{
    return watch->flux_warning == REASON_BUS_SENSOR ? in->bms.voltage_mV : 0;
}

/* The output in its place, which spares its copy. */
static void step_torque(controller_slow_t *slow, const config_t *config,
                        const fast_report_t *report, const slow_input_t *in,
                        const torque_enable_t *torque_enable, const operating_point_t *at,
                        const monitor_output_t *watch, bool rotor_valid, torque_output_t *out)
{
    const torque_input_t torque_in = {
        .drive_torque_mNm = in->demand.drive_torque_mNm,
        .brake_torque_mNm = in->demand.brake_torque_mNm,
        .demand_age_ms = in->demand_age_ms,
        .demand_reason = in->demand.reason,
        .direction = in->demand.direction,
        .abs_active = in->demand.abs_active,
        .abs_share_percent = in->demand.abs_motor_share_percent,
        .standstill = watch->standstill,
        .acknowledged = in->demand.fault_reset && watch->at_rest &&
                        in->demand.drive_torque_mNm == 0 && in->demand.brake_torque_mNm <= 0,
        .speed_mrad_s = at->speed_mrad_s,
        .current = {.d_mA = at->i_d_mA, .q_mA = at->i_q_mA},
        .i_d_weakening_mA = at->i_d_weakening_mA,
        .voltage_limited = report->voltage_limited,
        .voltage_use_q15 = report->voltage_use_q15,
        .rotor_valid = rotor_valid,
        /* Without any angle there is no torque that could ramp out. */
        .bridge_open = report->bridge != BRIDGE_PWM ||
                       (slow->rotor.sensor_wrong && !slow->rotor.observer_used),
        .flux_missing_q15 = watch->flux_missing_q15,
        .short_mNm = bridge_is_short(report->bridge) && rotor_valid ? watch->safe_torque_mNm : 0,
        .bus_voltage_mV = at->bus_voltage_mV,
        .battery_voltage_mV = contradicting_mV(in, watch),
        .phase_voltage_mV = at->phase_voltage_mV,
        .bms_charge_current_mA = in->bms.charge_current_mA,
        .bms_discharge_current_mA = in->bms.discharge_current_mA,
        .bms_charge_peak_mA = in->bms.charge_peak_current_mA,
        .hydraulic = in->hydraulic,
        .winding_temperature_cC = slow->temperatures.used.winding_cC,
        .switch_temperature_cC = slow->temperatures.used.switch_cC,
        .torque_enable = *torque_enable,
    };
    *out = torque_step(&slow->torque, config, &torque_in);
    torque_look_ahead(&slow->torque, config, &torque_in);
}

const torque_limits_t *controller_limits(const controller_slow_t *slow)
{
    return &slow->torque.table;
}

slow_output_t controller_slow_step(controller_slow_t *slow, const config_t *config,
                                   const fast_report_t *report, const slow_input_t *in,
                                   fast_setpoint_t *setpoint)
{
    rotor_speed_t speed = operating_point_speed(config, report->speed_q32);
    const angle_choice_output_t rotor =
        judge_rotor(slow, config, report, in->demand.fault_reset, &speed);
    operating_point_t at = operating_point_of(&slow->operating_point, config, report, speed,
                                              slow->temperatures.used.winding_cC);
    temperatures_step(&slow->temperatures, config, &in->temperature, &at);
    const monitor_output_t watch = step_monitor(slow, config, report, in, &at, &rotor);
    const modes_output_t modes = decide_mode(slow, config, report, in, &watch, rotor.valid);
    if (report->bridge != BRIDGE_PWM && watch.charging_mA > 0 &&
        torque_enable_any(modes.torque_enable)) {
        at.phase_voltage_mV = bridge_choice_phase_mV(config, at.phase_voltage_mV, at.bus_voltage_mV,
                                                     watch.charging_mA);
    }
    torque_output_t torque;
    step_torque(slow, config, report, in, &modes.torque_enable, &at, &watch, rotor.valid, &torque);

    const bridge_choice_input_t wanted = {
        .torque_enabled = torque_enable_any(modes.torque_enable),
        .torque_wanted = torque.command_mNm != 0 || in->demand.drive_torque_mNm != 0 ||
                         in->demand.brake_torque_mNm > 0,
        .torque_feasible = torque.current.feasible,
        .forced_mNm = torque.current.forced_mNm,
        .rotor_valid = rotor.valid,
        .observer_used = rotor.observer_used,
        .bridge = report->bridge,
        .safe_bridge = watch.safe_bridge,
        .safe_torque_mNm = watch.safe_torque_mNm,
        .emf_mV = watch.emf_mV,
        .phase_voltage_mV = at.phase_voltage_mV,
        .i_d_mA = at.latest_i_d_mA,
        .i_q_mA = at.latest_i_q_mA,
    };
    slow->step_count++;
    slow->last_command_mNm = torque.command_mNm;
    slow->last_estimate_mNm = torque.estimate_mNm;
    setpoint->sequence = slow->step_count;
    operating_point_setpoint(&slow->operating_point, config, torque.current.i_d_mA,
                             torque.current.i_q_mA, setpoint);
    setpoint->least_square = current_expectation_step(
        &slow->expected_current, setpoint->i_reference_pu, report->bridge == BRIDGE_PWM);
    setpoint->observer.used = rotor.observer_used;
    setpoint->calibrate_offsets = modes.calibrate_offsets;
    setpoint->torque_enabled =
        bridge_choice_step(&slow->bridge_choice, config, &wanted) == BRIDGE_PWM;
    setpoint->safe_bridge = watch.safe_bridge;
    setpoint->clear_trip = modes.clear_trip || watch.release_trip;
    setpoint->release_break = watch.release_break;

    const available_t *now = &slow->torque.ahead.now;
    const available_t *ahead = &slow->torque.ahead.ahead;
    const slow_output_t out = {
        .motor_torque_command_mNm = torque.command_mNm,
        .motor_torque_estimate_mNm = torque.estimate_mNm,
        .hydraulic_torque_mNm = torque.hydraulic_mNm,
        .electric_brake_available_mNm = torque.available.torque_mNm,
        .electric_brake_ahead_mNm = ahead->braking.torque_mNm,
        .drive_available_mNm = now->driving.torque_mNm,
        .drive_ahead_mNm = ahead->driving.torque_mNm,
        .speed_mrad_s = at.speed_mrad_s,
        .i_d_mA = at.i_d_mA,
        .i_q_mA = at.i_q_mA,
        .bus_voltage_mV = at.bus_voltage_mV,
        .bus_current_mA = at.bus_current_mA,
        .torque_reason = torque.reason,
        .available_reason = torque.available.reason,
        .ahead_reason = ahead->braking.reason,
        .drive_available_reason = now->driving.reason,
        .drive_ahead_reason = ahead->driving.reason,
        .hydraulic_reason = torque.hydraulic_reason,
        .fault_reason = modes.fault,
        .warning_reason = modes.warning,
        .present_warning = modes.present_warning,
        .mode = modes.mode,
        .waits_for = modes.waits_for,
        .direction = torque.engaged,
        .hydraulic_valid = torque.hydraulic_valid,
        .stop_lamp = torque.stop_lamp,
        .standstill = watch.at_rest,
    };
    return out;
}

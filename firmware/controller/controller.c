/* SPDX-License-Identifier: Apache-2.0 */
#include "controller/controller.h"

#include "config/finding_times.h"
#include "core/q15.h"
#include "fast_output.h"
#include "monitor/monitor_fast.h"

void controller_init(controller_t *controller, const config_t *config, int32_t timer_Hz)
{
    controller_fast_t *fast = &controller->fast;
    controller_slow_t *slow = &controller->slow;
    foc_init(&fast->foc, config, timer_Hz);
    monitor_fast_init(&fast->monitor, config);
    fast_output_write(fast, BRIDGE_OFF);
    measure_init(&slow->measure, config, timer_Hz);
    monitor_init(&slow->monitor);
    modes_init(&slow->modes);
    torque_init(&slow->torque, config);
    bridge_choice_init(&slow->bridge);
    const last_t none = {
        .temperature = {.winding_cC = config->motor.reference_temperature_cC,
                        .switch_cC = config->motor.reference_temperature_cC},
        .safe_bridge = BRIDGE_OFF,
        .engaged = DRIVE_DIRECTION_NEUTRAL,
        .at_rest = true,
    };
    slow->last = none;
    finding_times_t times[FINDING_COUNT];
    finding_times(config, times);
    findings_init(&slow->findings, times, config->driver.no_other_brake != 0);
    slow->torque_reason = shown_reason_init();
    slow->step_count = 0;
}

fast_setpoint_t controller_initial_setpoint(const config_t *config, int32_t timer_Hz)
{
    fast_setpoint_t out = {.torque_enabled = false, .safe_bridge = BRIDGE_OFF};
    operating_point_initial_setpoint(config, timer_Hz, &out);
    return out;
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

const torque_limits_t *controller_limits(const controller_slow_t *slow)
{
    return torque_limits_of(&slow->torque);
}

void controller_start_warm(controller_slow_t *slow, int32_t warmest_cC)
{
    slow->measure.temperatures.kept_cC = warmest_cC;
}

void controller_start_hold(controller_slow_t *slow, hill_hold_kept_t kept)
{
    torque_start_hold(&slow->torque, kept);
}

hill_hold_kept_t controller_hold(const controller_slow_t *slow)
{
    return torque_hold(&slow->torque);
}

int32_t controller_warmest_cC(const controller_slow_t *slow)
{
    const thermal_model_state_t *model = &slow->measure.temperatures.model;
    const int32_t model_cC =
        q_max(thermal_model_inner_cC(&model->winding), thermal_model_inner_cC(&model->switches));
    return q_max(model_cC,
                 q_max(slow->last.temperature.winding_cC, slow->last.temperature.switch_cC));
}

wheel_temperatures_t controller_temperatures(const controller_slow_t *slow)
{
    return slow->last.temperature;
}

/* What the fast loop does until the next slow step. */
static void write_setpoint(const controller_slow_t *slow, const config_t *config,
                           const measured_t *now, const monitored_t *watch,
                           const modes_output_t *mode, const current_setpoint_t *current,
                           bridge_mode_t bridge, fast_setpoint_t *setpoint)
{
    measure_setpoint(&slow->measure, config, current->i_d_mA, current->i_q_mA, setpoint);
    setpoint->sequence = slow->step_count;
    setpoint->least_square = current_expectation(config, setpoint->i_reference_pu,
                                                 slow->last.reference_pu, measured_switching(now));
    setpoint->observer.used = now->angle_by == ANGLE_BY_OBSERVER;
    setpoint->calibrate_offsets = mode->calibrate_offsets;
    setpoint->torque_enabled = bridge == BRIDGE_PWM;
    setpoint->safe_bridge = bridge == BRIDGE_PWM ? watch->safe.bridge : bridge;
    setpoint->clear_trip = mode->clear_trip || watch->release_trip;
    setpoint->release_break = watch->release_break;
}

static last_t last_of(const measured_t *now, const monitored_t *watch,
                      const torque_output_t *torque, const fast_setpoint_t *setpoint)
{
    const last_t out = {
        .torque_command_mNm = torque->command_mNm,
        .torque_estimate_mNm = torque->estimate_mNm,
        .hydraulic_added_mNm = torque->hydraulic_added_mNm,
        .hydraulic_apart_mNm = torque->hydraulic_apart_mNm,
        .reference_pu = setpoint->i_reference_pu,
        .temperature = {.winding_cC = now->winding_temperature_cC,
                        .switch_cC = now->switch_temperature_cC},
        .safe_bridge = watch->safe.bridge,
        .engaged = torque->engaged,
        .at_rest = watch->at_rest,
        .current_missing_q15 = watch->current_missing_q15,
    };
    return out;
}

static slow_output_t output_of(const measured_t *now, const monitored_t *watch,
                               const modes_output_t *mode, const torque_output_t *torque,
                               reason_t torque_reason)
{
    const available_t *available = &torque->available_now;
    const available_t *ahead = &torque->available_ahead;
    const slow_output_t out = {
        .motor_torque_command_mNm = torque->command_mNm,
        .motor_torque_estimate_mNm = torque->estimate_mNm,
        .motor_torque_uncertainty_mNm = torque->uncertainty_mNm,
        .hydraulic_torque_mNm = torque->hydraulic_mNm,
        .electric_brake_available_mNm = torque->available.torque_mNm,
        .electric_brake_ahead_mNm = ahead->braking.torque_mNm,
        .drive_available_mNm = available->driving.torque_mNm,
        .drive_ahead_mNm = ahead->driving.torque_mNm,
        .speed_mrad_s = now->speed_mrad_s,
        .i_d_mA = now->i_d_mA,
        .i_q_mA = now->i_q_mA,
        .bus_voltage_mV = now->bus_voltage_mV,
        .bus_current_mA = now->bus_current_mA,
        .torque_reason = torque_reason,
        .available_reason = torque->available.reason,
        .ahead_reason = ahead->braking.reason,
        .drive_available_reason = available->driving.reason,
        .drive_ahead_reason = ahead->driving.reason,
        .hydraulic_reason = torque->hydraulic_reason,
        .fault_reason = mode->fault,
        .warning_reason = mode->warning,
        .present_warning = mode->present_warning,
        .mode = mode->mode,
        .waits_for = mode->waits_for,
        .direction = torque->engaged,
        .hydraulic_valid = torque->hydraulic_valid,
        .stop_lamp = torque->stop_lamp,
        .standstill = watch->at_rest,
    };
    return out;
}

slow_output_t controller_slow_step(controller_slow_t *slow, const config_t *config,
                                   const fast_report_t *report, const slow_input_t *in,
                                   fast_setpoint_t *setpoint)
{
    findings_t *findings = &slow->findings;
    const measured_t now = measure_step(&slow->measure, config, report, in, &slow->last, findings);
    const monitored_t watch = monitor_step(&slow->monitor, config, &now, &slow->last, findings);
    const modes_output_t mode =
        modes_step(&slow->modes, config, &now, &watch, &slow->last, in, findings);
    const torque_enable_t *enable = &mode.torque_enable;
    const torque_output_t torque =
        torque_step(&slow->torque, config, &now, &slow->last, in, &watch, enable, findings);
    const bool demanded = in->demand.drive_torque_mNm != 0 || in->demand.brake_torque_mNm > 0;
    const bridge_mode_t bridge = bridge_choice_step(&slow->bridge, config, &now, &watch, &torque,
                                                    enable, demanded, findings);
    slow->step_count++;
    write_setpoint(slow, config, &now, &watch, &mode, &torque.current, bridge, setpoint);
    slow->last = last_of(&now, &watch, &torque, setpoint);
    const reason_t shown = shown_reason_step(&slow->torque_reason, torque.reason);
    return output_of(&now, &watch, &mode, &torque, shown);
}

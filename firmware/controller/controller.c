/* SPDX-License-Identifier: Apache-2.0 */
#include "controller/controller.h"

#include "config/bases.h"
#include "core/q15.h"
#include "monitor/monitor_fast.h"

/* Until the first sample nothing is known: the middle of the battery's range. */
static int32_t nominal_v_dc_pu(const config_t *config)
{
    const int32_t nominal_mV =
        (config->battery.min_voltage_mV + config->battery.max_voltage_mV) / 2;
    return q_scale(nominal_mV, 32768, config->drive.voltage_full_scale_mV);
}

void controller_init(controller_t *controller, const config_t *config)
{
    foc_init(&controller->fast.foc, config);
    monitor_fast_init(&controller->fast.monitor, config);
    controller->fast.bridge = BRIDGE_OFF;
    mean_values_init(&controller->slow.summary, nominal_v_dc_pu(config));
    controller->slow.modulation_limit_q15 = foc_modulation_limit_q15(&controller->fast.foc);
    torque_init(&controller->slow.torque, config);
    monitor_slow_init(&controller->slow.monitor);
    modes_init(&controller->slow.modes);
    controller->slow.last_command_mNm = 0;
    controller->slow.last_estimate_mNm = 0;
    controller->slow.step_count = 0;
}

fast_setpoint_t controller_initial_setpoint(const config_t *config)
{
    foc_state_t fresh;
    foc_init(&fresh, config);
    const int32_t highest_pu =
        q_scale(config->battery.max_voltage_mV, 32768, config->drive.voltage_full_scale_mV);
    const fast_setpoint_t out = {
        .tuning = current_tuning(config, foc_modulation_limit_q15(&fresh), highest_pu, 0,
                                 config->motor.reference_temperature_cC),
        .dead_time_slope = dead_time_slope_at(config, highest_pu),
        .torque_enabled = false,
        .safe_bridge = BRIDGE_OFF,
    };
    return out;
}

static uint16_t whole_counts(int32_t on_q16)
{
    return (uint16_t)((uint32_t)on_q16 >> 16);
}

/* What the bridge does; the only place that decides it. */
static bridge_mode_t bridge_command(const fast_setpoint_t *setpoint, reason_t trip)
{
    return setpoint->torque_enabled && trip == REASON_NONE ? BRIDGE_PWM : setpoint->safe_bridge;
}

fast_output_t controller_fast_step(controller_fast_t *fast, const config_t *config,
                                   const fast_setpoint_t *setpoint, const fast_input_t *in)
{
    if (bridge_command(setpoint, fast->monitor.trip) == BRIDGE_PWM) {
        foc_step(&fast->foc, config, setpoint, in);
    } else {
        foc_idle_step(&fast->foc, config, setpoint, in);
    }

    const foc_period_t *period = foc_latest(&fast->foc);
    const monitor_fast_input_t watched = {
        .i_pu = period->i_pu,
        .v_dc_pu = period->v_dc_pu,
        .power_stage_fault = in->power_stage_fault,
        .switching = setpoint->torque_enabled,
        .clear_trip = setpoint->clear_trip,
        .slow_step_count = setpoint->sequence,
    };
    fast->bridge = bridge_command(setpoint, monitor_fast_step(&fast->monitor, &watched));

    const int32_t *on_q16 = foc_on_times_q16(&fast->foc);
    const fast_output_t out = {
        .compare_counts = {whole_counts(on_q16[0]), whole_counts(on_q16[1]),
                           whole_counts(on_q16[2])},
        .bridge = fast->bridge,
    };
    return out;
}

void controller_fast_report(const controller_fast_t *fast, fast_report_t *report)
{
    foc_report(&fast->foc, report);
    report->trip = fast->monitor.trip;
    report->bridge = fast->bridge;
}

/* Bus current from the mean power: P = 3/2 u i, u = m limit v_dc/sqrt 3, so i_dc = sqrt(3)/2 limit
 * I_base (m i). */
static int32_t bus_current_mA(const config_t *config, int32_t power_pu,
                              int32_t modulation_limit_q15)
{
    const int32_t in_circle_mA =
        q_scale(bases_current_mA(config, power_pu), modulation_limit_q15, 32768);
    return q_scale(in_circle_mA, 866025, 1000000);
}

/* A share of the voltage circle in volts: u = m limit v_dc / sqrt(3); 32 768 sqrt(3) = 56 756. */
static int32_t phase_mV(int32_t share_q15, int32_t modulation_limit_q15, int32_t bus_mV)
{
    return q_scale(q_scale(share_q15, modulation_limit_q15, 32768), bus_mV, 56756);
}

static monitor_slow_input_t monitor_input(const controller_slow_t *slow, const config_t *config,
                                          const fast_report_t *report, const slow_input_t *in,
                                          int32_t speed_mrad_s, int32_t bus_mV)
{
    const monitor_slow_input_t out = {
        .fast_trip = report->trip,
        .current_sum_pu = report->current_sum_pu,
        .offsets_known = report->offsets_done,
        .current_saturated = report->adc_saturated,
        .rotor_valid = report->rotor_valid,
        .rotor_faults = report->rotor_faults,
        .fast_step_count = report->sequence,
        .bus_voltage_mV = bus_mV,
        .speed_mrad_s = speed_mrad_s,
        .winding_temperature_cC = in->temperature.winding_cC,
        .switch_temperature_cC = in->temperature.switch_cC,
        .i_d_mA = bases_current_mA(config, dq_of(report->i_pu).d),
        .i_q_mA = bases_current_mA(config, dq_of(report->i_pu).q),
        .u_d_mV = phase_mV(dq_of(report->u_pu).d, slow->modulation_limit_q15, bus_mV),
        .u_q_mV = phase_mV(dq_of(report->u_pu).q, slow->modulation_limit_q15, bus_mV),
        .voltage_limited = report->voltage_limited,
        .torque_command_mNm = slow->last_command_mNm,
        .torque_estimate_mNm = slow->last_estimate_mNm,
        .offset_q4 = {report->offset_q4[0], report->offset_q4[1], report->offset_q4[2]},
        .current_quarters = report->quadrant_transitions,
        .quarter_step = report->quadrant_step,
        .bridge = report->bridge,
    };
    return out;
}

static modes_output_t decide_mode(controller_slow_t *slow, const config_t *config,
                                  const fast_report_t *report, const slow_input_t *in,
                                  const monitor_output_t *watch, int32_t speed_mrad_s)
{
    const modes_input_t modes_in = {
        .config_accepted = in->config_accepted,
        .selftest_passed = in->selftest_passed,
        .offsets_done = report->offsets_done,
        .offsets_plausible = watch->offsets_plausible,
        .rotor_valid = report->rotor_valid,
        .rolling = q_abs(speed_mrad_s) > config->brake.blend_out_end_mrad_s,
        .enable = in->demand.enable,
        .drive_demanded = in->demand.drive_torque_mNm != 0,
        .torque_demanded = in->demand.drive_torque_mNm != 0 || in->demand.brake_torque_mNm > 0,
        .fault_reset = in->demand.fault_reset,
        .warning = watch->warning != REASON_NONE,
        .warning_reason = watch->warning,
        .fault = watch->fault,
        .safe_bridge = watch->safe_bridge,
    };
    return modes_step(&slow->modes, config, &modes_in);
}

static torque_output_t step_torque(controller_slow_t *slow, const config_t *config,
                                   const fast_report_t *report, const slow_input_t *in,
                                   const torque_enable_t *torque_enable, int32_t speed_mrad_s,
                                   int32_t bus_mV, const sampling_correction_t *sampling)
{
    const dq_t mean_pu = sampling_correction_to_mean(sampling, slow->summary.latest.i_pu);
    /* With a reserve below the index at which the fast loop begins to weaken the field (README,
     * Voltage reserve). */
    const int32_t index_q15 = config->current_loop.modulation_target_pu_q15 -
                              config->current_loop.modulation_reserve_pu_q15;
    const int32_t commanded_mV = phase_mV(index_q15, slow->modulation_limit_q15, bus_mV);
    const torque_input_t torque_in = {
        .drive_torque_mNm = in->demand.drive_torque_mNm,
        .brake_torque_mNm = in->demand.brake_torque_mNm,
        .demand_age_ms = in->demand_age_ms,
        .abs_active = in->demand.abs_active,
        .speed_mrad_s = speed_mrad_s,
        .current =
            {
                .d_mA = bases_current_mA(config, mean_pu.d),
                .q_mA = bases_current_mA(config, mean_pu.q),
            },
        .i_d_weakening_mA = bases_current_mA(config, report->i_d_weakening_pu),
        .voltage_limited = report->voltage_limited,
        .voltage_use_q15 = report->voltage_use_q15,
        .rotor_valid = report->rotor_valid,
        .bus_voltage_mV = bus_mV,
        .phase_voltage_mV = sampling_correction_mean_voltage(sampling, commanded_mV),
        .bms_charge_current_mA = in->bms.charge_current_mA,
        .bms_discharge_current_mA = in->bms.discharge_current_mA,
        .winding_temperature_cC = in->temperature.winding_cC,
        .switch_temperature_cC = in->temperature.switch_cC,
        .torque_enable = *torque_enable,
    };
    return torque_step(&slow->torque, config, &torque_in);
}

/* The reference that the fast loop compares its samples with. It adds what it weakens the field
 * by, of which the slow loop has taken account as of a mean. */
static dq_t sampled_reference_pu(const config_t *config, const current_setpoint_t *current,
                                 int32_t i_d_weakening_pu, const sampling_correction_t *sampling)
{
    const dq_t mean_pu = {
        .d = bases_current_pu_q15(config, current->i_d_mA) + i_d_weakening_pu,
        .q = bases_current_pu_q15(config, current->i_q_mA),
    };
    const dq_t sampled_pu = sampling_correction_to_sampled(sampling, mean_pu);
    const dq_t out = {.d = q_saturate16(sampled_pu.d - i_d_weakening_pu),
                      .q = q_saturate16(sampled_pu.q)};
    return out;
}

const torque_limits_t *controller_limits(const controller_slow_t *slow)
{
    return &slow->torque.table;
}

slow_output_t controller_slow_step(controller_slow_t *slow, const config_t *config,
                                   const fast_report_t *report, const slow_input_t *in,
                                   fast_setpoint_t *setpoint)
{
    const int32_t speed_mrad_s = bases_speed_mrad_s(config, report->speed_q32);
    const mean_values_t summary = mean_values_step(&slow->summary, report);
    const int32_t bus_mV = bases_bus_voltage_mV(config, summary.v_dc_pu);

    const monitor_slow_input_t watched =
        monitor_input(slow, config, report, in, speed_mrad_s, bus_mV);
    const monitor_output_t watch = monitor_slow_step(&slow->monitor, config, &watched);
    const modes_output_t modes = decide_mode(slow, config, report, in, &watch, speed_mrad_s);
    const int32_t speed_q32 = report->speed_q32;
    const sampling_correction_t sampling =
        sampling_correction_at(config, speed_q32, in->temperature.winding_cC);
    const torque_output_t torque = step_torque(slow, config, report, in, &modes.torque_enable,
                                               speed_mrad_s, bus_mV, &sampling);

    slow->step_count++;
    slow->last_command_mNm = torque.command_mNm;
    slow->last_estimate_mNm = torque.estimate_mNm;
    setpoint->sequence = slow->step_count;
    setpoint->i_reference_pu =
        sampled_reference_pu(config, &torque.current, report->i_d_weakening_pu, &sampling);
    setpoint->i_d_sampling_correction_pu = sampling_correction_d_pu(&sampling);
    setpoint->tuning = current_tuning(config, slow->modulation_limit_q15, summary.v_dc_pu,
                                      speed_q32, in->temperature.winding_cC);
    setpoint->dead_time_slope = dead_time_slope_at(config, summary.v_dc_pu);
    setpoint->calibrate_offsets = modes.calibrate_offsets;
    setpoint->torque_enabled = torque_enable_any(modes.torque_enable);
    setpoint->safe_bridge = watch.safe_bridge;
    setpoint->clear_trip = modes.clear_trip;

    const slow_output_t out = {
        .motor_torque_command_mNm = torque.command_mNm,
        .motor_torque_estimate_mNm = torque.estimate_mNm,
        .hydraulic_torque_mNm = torque.hydraulic_mNm,
        .electric_brake_available_mNm = torque.available.torque_mNm,
        .speed_mrad_s = speed_mrad_s,
        .i_d_mA = bases_current_mA(config, summary.i_pu.d),
        .i_q_mA = bases_current_mA(config, summary.i_pu.q),
        .bus_voltage_mV = bus_mV,
        .bus_current_mA = bus_current_mA(config, summary.power_pu, slow->modulation_limit_q15),
        .torque_reason = torque.reason,
        .available_reason = torque.available.reason,
        .hydraulic_reason = torque.hydraulic_reason,
        .fault_reason = modes.fault,
        .mode = modes.mode,
        .stop_lamp = torque.stop_lamp,
        .standstill = watch.standstill,
    };
    return out;
}

/* SPDX-License-Identifier: Apache-2.0 */
#include "controller/operating_point.h"

#include "config/bases.h"
#include "core/q15.h"
#include "core/sqrt3.h"
#include "foc/foc.h"
#include "motor/flux_map.h"
#include "observer_tuning.h"
#include "sampling_correction.h"
#include "tuning.h"
#include "winding.h"

enum { LEAD_SHARE = 4 };

static int32_t per_unit_of_mV(const config_t *config, int32_t voltage_mV)
{
    return q_scale(voltage_mV, 32768, config->drive.voltage_full_scale_mV);
}

void operating_point_init(operating_point_state_t *state, const config_t *config, int32_t timer_Hz)
{
    const int32_t middle_mV = (config->battery.min_voltage_mV + config->battery.max_voltage_mV) / 2;
    const int32_t modulation_limit_q15 = foc_modulation_limit_q15(config, timer_Hz);
    const operating_point_state_t fresh = {
        .modulation_limit_q15 = modulation_limit_q15,
        .magnets_pu = sampling_correction_magnets_pu(config),
        .observer = observer_constants(config, modulation_limit_q15),
        .winding = winding_constants(config),
        .v_dc_pu = per_unit_of_mV(config, middle_mV),
    };
    *state = fresh;
    state->observer_leak = state->observer.start;
}

/* The difference of two wrapping sums, as long as it is below 2^31. */
static int32_t mean(uint32_t now, uint32_t before, int32_t periods)
{
    const uint32_t rise = now - before;
    return (rise <= INT32_MAX ? (int32_t)rise : -(int32_t)(UINT32_MAX - rise) - 1) / periods;
}

static void average(operating_point_state_t *state, const fast_report_t *report)
{
    const int32_t periods = (uint16_t)(report->sequence - state->sequence);
    if (periods > 0) {
        const foc_sums_t *now = &report->sums;
        const foc_sums_t *before = &state->sums;
        state->i_pu.d = mean(now->i_d_pu, before->i_d_pu, periods);
        state->i_pu.q = mean(now->i_q_pu, before->i_q_pu, periods);
        state->power_pu = mean(now->power_pu, before->power_pu, periods);
        state->v_dc_pu = mean(now->v_dc_pu, before->v_dc_pu, periods);
        state->sums = *now;
        state->sequence = report->sequence;
    }
}

/* Part of a quantity, |share_q15| <= 32 768, rounded down. */
static inline int32_t part_of(int32_t whole, int32_t share_q15)
{
    return (int32_t)(((int64_t)whole * share_q15) >> 15);
}

/* P = 3/2 u i with u = m limit v_dc/sqrt 3: i_dc = sqrt(3)/2 limit I_base (m i). */
static int32_t bus_current_mA(const operating_point_state_t *state, const config_t *config)
{
    const int32_t in_circle_mA =
        part_of(bases_current_mA(config, state->power_pu), state->modulation_limit_q15);
    return part_of(in_circle_mA, SQRT3_2_Q15);
}

/* Radius of the voltage circle: limit v_dc/sqrt 3. */
static int32_t circle_mV(const operating_point_state_t *state, int32_t bus_mV)
{
    return part_of(part_of(bus_mV, state->modulation_limit_q15), INVERSE_SQRT3_Q15);
}

/* With a reserve below the index at which the fast loop begins to weaken the field (DERIVATIONS.md,
 * Voltage reserve). */
static int32_t phase_voltage_mV(const operating_point_state_t *state, const config_t *config,
                                int32_t radius_mV)
{
    const int32_t index_q15 = config->current_loop.modulation_target_pu_q15 -
                              config->current_loop.modulation_reserve_pu_q15;
    return sampling_correction_mean_voltage(&state->sampling, part_of(radius_mV, index_q15));
}

rotor_view_t operating_point_rotor(operating_point_state_t *state, const config_t *config,
                                   const fast_report_t *report)
{
    const observer_report_t *observer = &report->observer;
    const int32_t change_q32 = observer->speed_q32 - state->observer_speed_q32;
    state->observer_speed_q32 +=
        observer->acquired && state->observer.follows_speed ? change_q32 / LEAD_SHARE : change_q32;
    observer_leak_step(&state->observer_leak, &state->observer, state->observer_speed_q32,
                       observer->acquired);
    const uint16_t lead_turn = observer_lead_turn(&state->observer_leak, state->observer_speed_q32);
    const uint16_t rotor_turn = (uint16_t)(observer->theta_turn - lead_turn);
    state->observer_lead_turn = lead_turn;
    const dq_t flux_q14 = dq_of(observer->flux_q14);
    const rotor_view_t out = {
        .observer_mrad_s = bases_speed_mrad_s(config, observer->speed_q32),
        .sensor_mrad_s = bases_speed_mrad_s(config, report->speed_q32),
        .difference_turn = angle_difference(observer->sensor_turn, rotor_turn),
        .flux_q14 = flux_q14.d,
        .across_q14 = flux_q14.q,
        .expected_q14 = q_saturate16(observer_expected_flux_q14(&state->observer, lead_turn)),
        .i_pu = dq_of(report->i_pu),
        .acquired = observer->acquired,
        .sensor_valid = report->sensor_valid,
        .switching = report->bridge == BRIDGE_PWM,
    };
    return out;
}

void operating_point_of(operating_point_state_t *state, const config_t *config, rotor_speed_t speed,
                        int32_t winding_temperature_cC, measured_t *out)
{
    const fast_report_t *report = out->report;
    average(state, report);
    state->speed_q32 = speed.turn_q32;
    state->winding_temperature_cC = winding_temperature_cC;
    state->i_d_weakening_pu = report->i_d_weakening_pu;
    state->sampling =
        sampling_correction_at(config, state->magnets_pu, speed.turn_q32, winding_temperature_cC);
    const sampling_correction_t *sampling = &state->sampling;
    const dq_t i_pu = sampling_correction_to_mean(sampling, state->i_pu);
    const int32_t bus_mV = bases_bus_voltage_mV(config, state->v_dc_pu);
    const int32_t radius_mV = circle_mV(state, bus_mV);
    const dq_t latest_i = dq_of(report->i_pu);
    const dq_t latest_u = dq_of(report->u_pu);
    out->speed_mrad_s = speed.wheel_mrad_s;
    out->i_d_mA = bases_current_mA(config, i_pu.d);
    out->i_q_mA = bases_current_mA(config, i_pu.q);
    out->sampled_pu = state->i_pu;
    out->bus_voltage_mV = bus_mV;
    out->bus_current_mA = bus_current_mA(state, config);
    out->i_d_weakening_mA = bases_current_mA(
        config, sampling_correction_mean_change(sampling, report->i_d_weakening_pu));
    out->phase_voltage_mV = phase_voltage_mV(state, config, radius_mV);
    out->latest_i_d_mA = bases_current_mA(config, latest_i.d);
    out->latest_i_q_mA = bases_current_mA(config, latest_i.q);
    out->latest_u_d_mV = part_of(radius_mV, latest_u.d);
    out->latest_u_q_mV = part_of(radius_mV, latest_u.q);
}

/* From the present current to the one that a reference makes. */
static winding_path_t path_of(const operating_point_state_t *state, dq_t reference_pu)
{
    const winding_path_t out = {
        .from_pu = state->i_pu,
        .to_pu = {.d = reference_pu.d + state->i_d_weakening_pu, .q = reference_pu.q},
    };
    return out;
}

void operating_point_setpoint(const operating_point_state_t *state, const config_t *config,
                              int32_t i_d_mA, int32_t i_q_mA, fast_setpoint_t *setpoint)
{
    const dq_t mean_pu = {.d = bases_current_pu_q15(config, i_d_mA),
                          .q = bases_current_pu_q15(config, i_q_mA)};
    const dq_t sampled_pu = sampling_correction_to_sampled(&state->sampling, mean_pu);
    setpoint->i_reference_pu.d = q_saturate16(sampled_pu.d);
    setpoint->i_reference_pu.q = q_saturate16(sampled_pu.q);
    setpoint->i_d_sampling_correction_pu = sampling_correction_d_pu(&state->sampling);
    winding_t local;
    const winding_t *winding = &state->winding;
    if (flux_map_present(config)) {
        winding = winding_at(config, winding, path_of(state, setpoint->i_reference_pu),
                             state->winding_temperature_cC, &local);
    }
    setpoint->tuning = current_tuning(config, winding, state->modulation_limit_q15, state->v_dc_pu,
                                      state->speed_q32, state->winding_temperature_cC);
    setpoint->dead_time_slope = dead_time_slope_at(config, state->v_dc_pu);
    setpoint->observer =
        observer_tuning(&state->observer, winding, &state->observer_leak, config, state->v_dc_pu,
                        state->observer_lead_turn, state->winding_temperature_cC);
}

void operating_point_initial_setpoint(const config_t *config, int32_t timer_Hz,
                                      fast_setpoint_t *setpoint)
{
    operating_point_state_t at_rest;
    operating_point_init(&at_rest, config, timer_Hz);
    at_rest.v_dc_pu = per_unit_of_mV(config, config->battery.max_voltage_mV);
    at_rest.winding_temperature_cC = config->motor.reference_temperature_cC;
    operating_point_setpoint(&at_rest, config, 0, 0, setpoint);
}

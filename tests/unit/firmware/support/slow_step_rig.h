/* SPDX-License-Identifier: Apache-2.0 */
/*
 * slow_step_rig.h: the slow step of any configuration without a fast loop: currents follow the
 * setpoint a step late, and the report is what they would give. With a hydraulic brake of dead time
 * and lag, which has the configured gain or another.
 *
 * A slow step with its report takes two microseconds, a twentieth of one with its PWM periods.
 */
#ifndef SLOW_STEP_RIG_H
#define SLOW_STEP_RIG_H

#include <math.h>
#include <string.h>

#include "config/bases.h"
#include "controller/controller.h"
#include "core/q15.h"

enum {
    RIG_DEAD_TIME_MAX_ms = 1024,
    RIG_TRIM_q15 = 30000 /* square of the modulation index above which the fast loop trims */
};

typedef struct {
    int32_t command_mNm[RIG_DEAD_TIME_MAX_ms]; /* ring, by the step */
    double torque_mNm, gain;
} rig_brake_t;

typedef struct {
    config_t config;
    controller_t controller;
    fast_setpoint_t setpoint;
    fast_report_t report;
    slow_input_t in;
    slow_output_t out;
    rig_brake_t brake;
    double speed_rad_s, bus_v; /* mechanical */
    double weakening_a;        /* i_d of the fast loop's trim at the end of the voltage, <= 0 */
    int32_t modulation_limit_q15;
    int32_t periods; /* PWM periods a step */
    uint32_t steps;
} slow_rig_t;

static inline void slow_rig_start(slow_rig_t *rig, const config_t *config)
{
    memset(rig, 0, sizeof *rig);
    rig->config = *config;
    rig->modulation_limit_q15 = foc_modulation_limit_q15(config, BASES_MODEL_TIMER_Hz);
    rig->periods = config->drive.pwm_frequency_Hz / 1000;
    rig->bus_v = 0.5e-3 * (config->battery.min_voltage_mV + config->battery.max_voltage_mV);
    rig->brake.gain = 1.0;
    controller_init(&rig->controller, &rig->config, BASES_MODEL_TIMER_Hz);
    rig->setpoint = controller_initial_setpoint(&rig->config, BASES_MODEL_TIMER_Hz);
    rig->in.bms.charge_current_mA = 1000000;
    rig->in.bms.discharge_current_mA = 1000000;
    rig->in.temperature.winding_cC = 2500;
    rig->in.temperature.switch_cC = 2500;
    rig->in.selftest_passed = true;
    rig->in.config_accepted = true;
    rig->in.demand.enable = true;
    rig->in.demand.direction = DRIVE_DIRECTION_FORWARD;
    rig->in.hydraulic.age_ms = 1000000;
    rig->report.offsets_done = true;
    rig->report.sensor_valid = true;
    for (int x = 0; x < SENSE_PHASES; x++) {
        rig->report.offset_q4[x] = 2048 * 16;
    }
}

/* Voltage of a sampled current at the present speed, as a share of the circle. The mean current is
 * the sampled one less g (i + psi/L_d), g = (w T)^2/12. */
static inline dq_t slow_rig_voltage_pu(const slow_rig_t *rig, dq_t i_pu)
{
    const config_motor_t *m = &rig->config.motor;
    const double base_a = rig->config.drive.current_full_scale_mA * 1e-3;
    const double w = rig->speed_rad_s * m->pole_pairs;
    const double turned = w / rig->config.drive.pwm_frequency_Hz;
    const double g = turned * turned / 12.0;
    const int32_t winding_cC = q_limit(rig->in.temperature.winding_cC, 30000);
    const double warmer_K = (winding_cC - m->reference_temperature_cC) * 1e-2;
    const double psi =
        m->flux_linkage_nWb * 1e-9 * (1.0 + m->flux_coefficient_ppm_K * 1e-6 * warmer_K);
    const double r =
        bases_at_winding_temperature(&rig->config, m->phase_resistance_uOhm, winding_cC) * 1e-6;
    const double i_d =
        (i_pu.d * base_a / 32768.0 - g * psi / (m->d_inductance_nH * 1e-9)) / (1.0 + g);
    const double i_q = i_pu.q * base_a / 32768.0 / (1.0 + g);
    const double u_d = r * i_d - w * m->q_inductance_nH * 1e-9 * i_q;
    const double u_q = r * i_q + w * (m->d_inductance_nH * 1e-9 * i_d + psi);
    const double circle_v = rig->bus_v * 0.57735 * rig->modulation_limit_q15 / 32768.0;
    const double pu = 32768.0 / fmax(circle_v, 1.0);
    const double share = fmin(1.0, 32767.0 / fmax(hypot(u_d, u_q) * pu, 1.0)) * pu;
    const dq_t out = {.d = (int32_t)(u_d * share), .q = (int32_t)(u_q * share)};
    return out;
}

static inline void slow_rig_fast(slow_rig_t *rig)
{
    fast_report_t *report = &rig->report;
    const config_drive_t *drive = &rig->config.drive;
    const uint32_t n = (uint32_t)rig->periods;
    const bool switches = rig->setpoint.torque_enabled && report->trip == REASON_NONE;
    report->bridge = switches ? BRIDGE_PWM : rig->setpoint.safe_bridge;
    const double trim_a = report->voltage_use_q15 > RIG_TRIM_q15 ? rig->weakening_a : 0.0;
    report->i_d_weakening_pu = (int32_t)(trim_a * 32768e3 / drive->current_full_scale_mA);
    dq_t i = {.d = 0, .q = 0};
    dq_t u = {.d = 0, .q = 0};
    if (switches) {
        i.d = q_clamp(rig->setpoint.i_reference_pu.d + report->i_d_weakening_pu, -32767, 32767);
        i.q = rig->setpoint.i_reference_pu.q;
        u = slow_rig_voltage_pu(rig, i);
    }
    const int32_t v_pu = (int32_t)(rig->bus_v * 32768e3 / drive->voltage_full_scale_mV);
    report->sequence = (uint16_t)(report->sequence + n);
    report->i_pu = dq16_of(i);
    report->u_pu = dq16_of(u);
    report->sums.i_d_pu += n * (uint32_t)i.d;
    report->sums.i_q_pu += n * (uint32_t)i.q;
    report->sums.power_pu += n * (uint32_t)((u.d * i.d + u.q * i.q) / 32768);
    report->sums.v_dc_pu += n * (uint32_t)v_pu;
    report->voltage_use_q15 = (u.d * u.d + u.q * u.q) / 32768;
    report->voltage_limited = report->voltage_use_q15 > 32700;
    report->speed_q32 = (int32_t)(rig->speed_rad_s * rig->config.motor.pole_pairs * 4294967296.0 /
                                  (6.283185307179586 * drive->pwm_frequency_Hz));
}

static inline void slow_rig_brake(slow_rig_t *rig)
{
    const config_brake_t *config = &rig->config.brake;
    rig_brake_t *brake = &rig->brake;
    const uint32_t dead_ms = (uint32_t)config->hydraulic_dead_time_ms;
    brake->command_mNm[rig->steps % RIG_DEAD_TIME_MAX_ms] = rig->out.hydraulic_torque_mNm;
    const uint32_t late = (rig->steps - dead_ms) % RIG_DEAD_TIME_MAX_ms;
    const double wanted_mNm = rig->steps < dead_ms ? 0.0 : brake->gain * brake->command_mNm[late];
    const double rate = config->hydraulic_rate_mNm_s * 1e-3;
    const double change_mNm =
        (wanted_mNm - brake->torque_mNm) / (config->hydraulic_time_constant_ms + 1.0);
    brake->torque_mNm += fmin(fmax(change_mNm, -rate), rate);
    rig->steps++;
}

/* One millisecond. */
static inline void slow_rig_step(slow_rig_t *rig)
{
    slow_rig_fast(rig);
    rig->out = controller_slow_step(&rig->controller.slow, &rig->config, &rig->report, &rig->in,
                                    &rig->setpoint);
    slow_rig_brake(rig);
}

#endif

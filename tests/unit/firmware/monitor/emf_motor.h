/* SPDX-License-Identifier: Apache-2.0 */
/* emf_motor.h: the angle check, and what it sees of a motor in double precision, in a dq frame with
 * an angle error. */
#ifndef TEST_EMF_MOTOR_H
#define TEST_EMF_MOTOR_H

#include <math.h>

#include "core/q15.h"
#include "monitor/monitor_emf.h"
#include "monitor_case.h"
#include "paper_vehicle.h"

static const double PI = 3.14159265358979323846;

/* Parameters of the motor relative to the configuration. */
typedef struct {
    double resistance, inductance, flux; /* factors */
    double dead_time_share;              /* uncompensated share of the dead-time voltage */
} plant_t;

static const plant_t AS_CONFIGURED = {1.0, 1.0, 1.0, 0.0};

/* Steady state at a mechanical speed; currents in the rotor's dq frame. The estimated frame leads
 * it by offset_deg. */
static inline monitor_case_t emf_measured(const config_t *config, double rpm, double i_d_a,
                                          double i_q_a, double offset_deg, const plant_t *plant)
{
    const config_motor_t *m = &config->motor;
    const double w = rpm * 2.0 * PI / 60.0 * m->pole_pairs;
    const double r = 1e-6 * m->phase_resistance_uOhm * plant->resistance;
    const double l_d = 1e-9 * m->d_inductance_nH * plant->inductance;
    const double l_q = 1e-9 * m->q_inductance_nH * plant->inductance;
    const double psi = 1e-9 * m->flux_linkage_nWb * plant->flux;
    const double dead_v = plant->dead_time_share * 4.0 / 3.0 * 1e-9 * config->drive.dead_time_ns *
                          config->drive.pwm_frequency_Hz * 53.0;
    const double u_d = r * i_d_a - w * l_q * i_q_a + dead_v;
    const double u_q = r * i_q_a + w * (l_d * i_d_a + psi);
    const double c = cos(offset_deg * PI / 180.0);
    const double s = sin(offset_deg * PI / 180.0);
    const monitor_case_t out = {
        .report = {.bridge = BRIDGE_PWM},
        .now = {.latest_u_d_mV = (int32_t)lround(1e3 * (c * u_d + s * u_q)),
                .latest_u_q_mV = (int32_t)lround(1e3 * (c * u_q - s * u_d)),
                .latest_i_d_mA = (int32_t)lround(1e3 * (c * i_d_a + s * i_q_a)),
                .latest_i_q_mA = (int32_t)lround(1e3 * (c * i_q_a - s * i_d_a)),
                .bus_voltage_mV = 53000,
                .speed_mrad_s = mrad_s_of_rpm(rpm),
                .angle_valid = true},
    };
    return out;
}

/* The state at a speed that has long not moved. */
static inline monitor_emf_state_t emf_steady_at(int32_t speed_mrad_s)
{
    const monitor_emf_state_t out = {.steady_mrad_s = speed_mrad_s, .steady_steps = UINT16_MAX};
    return out;
}

static config_t config;
static monitor_emf_state_t state;

static inline monitor_case_t measured(double rpm, double i_d_a, double i_q_a, double offset_deg,
                                      const plant_t *plant)
{
    return emf_measured(&config, rpm, i_d_a, i_q_a, offset_deg, plant);
}

/* Milliseconds until the fault, or -1 within a second; from the state as it is. */
static inline int time_to_fault_now(const monitor_case_t *in)
{
    for (int n = 1; n <= 1000; n++) {
        if (monitor_emf_step(&state, &config, measured_of(in))) {
            return n;
        }
    }
    return -1;
}

/* The same at a speed that has long not moved. */
static inline int time_to_fault(const monitor_case_t *in)
{
    state = emf_steady_at(q_abs(in->now.speed_mrad_s));
    return time_to_fault_now(in);
}

#endif

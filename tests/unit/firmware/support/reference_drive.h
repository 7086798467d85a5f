/* SPDX-License-Identifier: Apache-2.0 */
/*
 * reference_drive.h: a shipped configuration in a random state (speed up to 110 %, temperature, bus
 * voltage) on the circuit of reference_motor.h in double precision, with the currents that the
 * minimum-loss map and the voltage limit give at a torque.
 */
#ifndef REFERENCE_DRIVE_H
#define REFERENCE_DRIVE_H

#include "motor/feasible_torque.h"
#include "random_values.h"
#include "reference_motor.h"
#include "torque_model.h"

extern const config_t CONFIG_LU2013, CONFIG_EBIKE36V, CONFIG_SCOOTER48V, CONFIG_IPM400V;

enum { STATES = 500, HALVINGS = 30 };

typedef struct {
    const config_t *config;
    reference_motor_t motor;
    int32_t speed_mrad_s, winding_cC;
    double phase_v, weakest_a;
} drive_t;

static inline reference_point_t at_d(const drive_t *drive, double d_a, double airgap_nm)
{
    const reference_motor_t *m = &drive->motor;
    const double g_q = m->w_rad_s * m->l_q_h * m->iron_siemens;
    double x = 0.0;
    for (int n = 0; n < 40; n++) {
        const double flux = m->psi_wb + (m->l_d_h - m->l_q_h) * (d_a + g_q * x);
        x = airgap_nm / (1.5 * m->pole_pairs * fmax(flux, 0.25 * m->psi_wb));
    }
    return reference_point(m, d_a + g_q * x, x);
}

static inline double volts(const drive_t *drive, reference_point_t p)
{
    const reference_motor_t *m = &drive->motor;
    const double w = m->w_rad_s;
    /* torque current from the terminal current */
    const double g = w * m->iron_siemens;
    const double x =
        (p.i_q_a - g * (m->l_d_h * p.i_d_a + m->psi_wb)) / (1.0 + g * g * m->l_d_h * m->l_q_h);
    const double i_dt = p.i_d_a + g * m->l_q_h * x;
    return hypot(m->resistance_ohm * p.i_d_a - w * m->l_q_h * x,
                 m->resistance_ohm * p.i_q_a + w * (m->l_d_h * i_dt + m->psi_wb));
}

static inline reference_point_t at_map(const drive_t *drive, double airgap_nm)
{
    const double map_a = 1e-3 * map_d_mA(drive->config, drive->speed_mrad_s, drive->winding_cC,
                                         (int32_t)lround(1e3 * airgap_nm));
    return at_d(drive, map_a, airgap_nm);
}

/* With the map's i_d, or the i_d on the voltage limit, down to the largest field weakening. */
static inline reference_point_t at_torque(const drive_t *drive, double airgap_nm)
{
    const double map_a = 1e-3 * map_d_mA(drive->config, drive->speed_mrad_s, drive->winding_cC,
                                         (int32_t)lround(1e3 * airgap_nm));
    double high_a = map_a;
    double low_a = fmin(map_a, drive->weakest_a);
    if (volts(drive, at_d(drive, map_a, airgap_nm)) <= drive->phase_v) {
        return at_d(drive, map_a, airgap_nm);
    }
    for (int n = 0; n < HALVINGS; n++) {
        const double middle_a = 0.5 * (low_a + high_a);
        if (volts(drive, at_d(drive, middle_a, airgap_nm)) <= drive->phase_v) {
            low_a = middle_a;
        } else {
            high_a = middle_a;
        }
    }
    return at_d(drive, low_a, airgap_nm);
}

static inline double friction_nm(const drive_t *drive)
{
    const config_motor_t *motor = &drive->config->motor;
    const double speed_rad_s = 1e-3 * drive->speed_mrad_s;
    return 1e-3 * motor->friction_torque_mNm * fmin(1.0, speed_rad_s / 0.5) +
           1e-6 * motor->viscous_friction_uNm_s * speed_rad_s;
}

/* A point of terminal currents of the circuit. */
static inline reference_point_t of_terminal(const drive_t *drive, double d_a, double q_a)
{
    const reference_motor_t *m = &drive->motor;
    const double g = m->w_rad_s * m->iron_siemens;
    const double x = (q_a - g * (m->l_d_h * d_a + m->psi_wb)) / (1.0 + g * g * m->l_d_h * m->l_q_h);
    return reference_point(m, d_a + g * m->l_q_h * x, x);
}

static inline drive_t any_drive(const config_t *config, random_t *random, int32_t *phase_mV)
{
    const config_battery_t *battery = &config->battery;
    drive_t drive = {
        .config = config,
        .speed_mrad_s = random_between(random, 1000, config->motor.max_speed_mrad_s / 10 * 11),
        .winding_cC = random_between(random, -2000, 14000),
    };
    *phase_mV =
        (int32_t)(0.55 * random_between(random, battery->min_voltage_mV, battery->max_voltage_mV));
    drive.phase_v = 1e-3 * *phase_mV;
    drive.motor = reference_motor(config, drive.speed_mrad_s, drive.winding_cC);
    return drive;
}

#endif

/* SPDX-License-Identifier: Apache-2.0 */
/*
 * plain_drive.h: a plain motor of any inductance, resistance and iron loss in double precision, for
 * references of the current circle.
 */
#ifndef PLAIN_DRIVE_H
#define PLAIN_DRIVE_H

#include <math.h>

#include "plain_motor.h"
#include "random_values.h"

static const double MOST = 4.0;
static const double CIRCLE = 4.0 * 255.0 / 256.0;

/* u_d = R d - X_q x, u_q = E + R i_fe + per_x x + per_d d, i_q = i_fe + (1 + a_d a_q) x + a_d d */
typedef struct {
    double psi, saliency;
    double r, x_d, x_q, emf;
    double iron; /* conductance: a_d = X_d iron, a_q = X_q iron, i_fe = E iron */
    double u, lowest;
} plain_drive_t;

typedef struct {
    double d, x;
} plain_point_t;

static inline double drive_a2(const plain_drive_t *d)
{
    return 1.0 + d->x_d * d->iron * d->x_q * d->iron;
}

static inline void drive_apply(const plain_drive_t *d, plain_motor_t *motor)
{
    motor_model_t *m = &motor->model;
    m->flux_b = plain_units(d->psi);
    m->slope_flux_b = m->flux_b;
    m->saliency_b = plain_ratio(d->saliency);
    m->slope_saliency_b = m->saliency_b;
    m->x_per_airgap_q23 = (int32_t)lround(ldexp(1.0 / d->psi, 23));
    m->resistance_b = plain_ratio(d->r);
    m->reactance_d_b = plain_ratio(d->x_d);
    m->reactance_q_b = plain_ratio(d->x_q);
    m->emf_b = plain_units(d->emf);
    m->cross_d = plain_ratio(d->x_d * d->iron);
    m->cross_q = plain_ratio(d->x_q * d->iron);
    m->iron_current_b = plain_units(d->emf * d->iron);
    m->one_plus_a2 = plain_ratio(drive_a2(d));
    m->inverse_one_plus_a2 = plain_ratio(1.0 / drive_a2(d));
    m->flux_per_x = plain_ratio(d->saliency * d->x_q * d->iron);
    m->voltage_q_b = plain_units(d->emf * (1.0 + d->r * d->iron));
    m->voltage_q_per_x = plain_ratio(d->r * drive_a2(d) + d->x_d * d->x_q * d->iron);
    m->voltage_q_per_d = plain_ratio(d->x_d + d->r * d->x_d * d->iron);
    motor->set.voltage_squared = (int64_t)ldexp(d->u * d->u, 2 * PLAIN_UNIT_LOG2);
    motor->set.weakest_d_b = plain_units(d->lowest);
}

/* Of terminal currents, and the other way round. */
static inline double drive_x(const plain_drive_t *d, double i_d, double i_q)
{
    return (i_q - d->emf * d->iron - d->x_d * d->iron * i_d) / drive_a2(d);
}

static inline double drive_i_q(const plain_drive_t *d, plain_point_t at)
{
    return drive_a2(d) * at.x + d->emf * d->iron + d->x_d * d->iron * at.d;
}

static inline double drive_u_d(const plain_drive_t *d, plain_point_t at)
{
    return d->r * at.d - d->x_q * at.x;
}

/* E + X_d i_dt + R i_q with i_dt = d + a_q x */
static inline double drive_u_q(const plain_drive_t *d, plain_point_t at)
{
    return d->emf + d->x_d * (at.d + d->x_q * d->iron * at.x) + d->r * drive_i_q(d, at);
}

/* |u|^2 along the circle of terminal currents to the second order in the angle, excess + 2 half t +
 * squared t^2, the circle bending towards the voltage without i_d and torque. */
typedef struct {
    double excess, half, squared;
} plain_square_t;

static inline plain_square_t drive_square(const plain_drive_t *d, plain_point_t at,
                                          double i_d_per_t, double i_q_per_t, double most_squared)
{
    const plain_point_t none = {.d = 0.0, .x = 0.0};
    const double x_per_t = (i_q_per_t - d->x_d * d->iron * i_d_per_t) / drive_a2(d);
    const plain_point_t next = {.d = i_d_per_t, .x = x_per_t};
    const double u_d = drive_u_d(d, at);
    const double u_q = drive_u_q(d, at);
    const double s_d = drive_u_d(d, next);
    const double s_q = drive_u_q(d, next) - drive_u_q(d, none);
    const plain_square_t out = {
        .excess = u_d * u_d + u_q * u_q - most_squared,
        .half = s_d * u_d + s_q * u_q,
        .squared = s_d * s_d + s_q * s_q - u_d * u_d - u_q * (u_q - drive_u_q(d, none)),
    };
    return out;
}

static inline double drive_clamped(double x, double lowest, double highest)
{
    return fmin(fmax(x, lowest), highest);
}

static inline double drive_beside(double most, double d)
{
    return sqrt(fmax(most * most - d * d, 0.0));
}

#endif

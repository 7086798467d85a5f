/* SPDX-License-Identifier: Apache-2.0 */
/*
 * feasible_ellipse.h: what the parts of feasible_torque.h share: the voltage ellipse along a
 * straight line of currents, the map's i_d, and the limits of the numbers. DERIVATIONS.md,
 * Feasible torque.
 */
#ifndef MOTOR_FEASIBLE_ELLIPSE_H
#define MOTOR_FEASIBLE_ELLIPSE_H

#include "core/q15.h"
#include "motor/feasible_torque.h"

enum {
    ELLIPSE_SMALL_b = 1 << 8,        /* currents of no consequence */
    ELLIPSE_HOLDS_LOG2 = 4,          /* 3 % of the voltage: less than the fast loop's own reserve */
    ELLIPSE_CIRCLE_RESERVE_LOG2 = 8, /* 0.4 % */
    ELLIPSE_MOST_COEFFICIENT = 1 << 29
};

static inline int32_t clamped_b(int32_t x)
{
    return q_saturate26(x);
}

static inline int32_t multiply64_b(int64_t a, int64_t b)
{
    return q_saturate64((a * b) >> 24);
}

static inline int32_t within(int32_t x)
{
    return q_saturate27(x);
}

/* Of a quadratic equation: keeps the products under its root below 2^62. */
static inline int32_t coefficient(int64_t x)
{
    return q_limit(q_saturate64(x), ELLIPSE_MOST_COEFFICIENT);
}

static inline int32_t coefficient_sum(int32_t a, int32_t b)
{
    return q_limit(q_add(a, b), ELLIPSE_MOST_COEFFICIENT);
}

/* The same of a sum of products, x / 2^24. */
static inline int32_t coefficient_of_products(int64_t x)
{
    const int32_t most = ELLIPSE_MOST_COEFFICIENT >> 8;
    const int32_t upper = (int32_t)(x >> 32);
    if ((uint32_t)upper + (uint32_t)most < 2U * (uint32_t)most) {
        return (int32_t)(x >> 24);
    }
    return upper < 0 ? -ELLIPSE_MOST_COEFFICIENT : ELLIPSE_MOST_COEFFICIENT;
}

static inline int64_t square(int32_t x)
{
    return (int64_t)x * x;
}

/* The voltage along a straight line in (i_d, i_qt): u + slope t. */
typedef struct {
    int32_t u_d, u_q, slope_d, slope_q;
} line_t;

static inline line_t line_from(const motor_model_t *m, motor_point_t at, int32_t d_per_t,
                               int32_t x_per_t)
{
    const line_t out = {
        .u_d = motor_model_u_d_b(m, at),
        .u_q = motor_model_u_q_b(m, at),
        .slope_d = scaled_dot(m->resistance_b, d_per_t, -m->reactance_q_b, x_per_t),
        .slope_q = scaled_dot(m->voltage_q_per_d, d_per_t, m->voltage_q_per_x, x_per_t),
    };
    return out;
}

/* The upper (sign 1) or lower (-1) intersection t of the line with the ellipse; without one false
 * and the t of the least voltage. */
bool feasible_ellipse_root(const feasible_set_t *set, const line_t *line, int32_t sign,
                           int32_t *t_b);

static inline bool voltage_suffices(const feasible_set_t *set, motor_point_t at)
{
    const motor_model_t *m = set->model;
    return square(motor_model_u_d_b(m, at)) + square(motor_model_u_q_b(m, at)) <=
           set->voltage_squared;
}

/* With the fast loop's own reserve. */
static inline int64_t feasible_most_squared(const feasible_set_t *set)
{
    return set->voltage_squared + (set->voltage_squared >> ELLIPSE_HOLDS_LOG2);
}

static inline int32_t map_d_b(const feasible_set_t *set, int32_t airgap_b)
{
    const motor_constants_t *k = set->model->constants;
    return motor_model_current_b(
        k, loss_maps_row_d_mA(&set->row, scaled_shift(airgap_b, -k->torque_shift)));
}

/* The cap's torque with the i_d of the voltage ellipse. */
void feasible_weaken_cap(feasible_side_t *side);

/* The phase current limit, less a reserve for the fast loop's field weakening. */
static inline int32_t circle_b(const motor_model_t *m)
{
    return m->constants->current_most_b -
           (m->constants->current_most_b >> ELLIPSE_CIRCLE_RESERVE_LOG2);
}

/* The i_d on the circle for a torque above the one at the map's i_d, between the map's i_d and that
 * of maximum torque per ampere. */
int32_t feasible_circle_d_b(const feasible_set_t *set, int32_t airgap_b, int32_t map_b);

/* Of the sum u_d i_d + u_q i_q. Coefficients below 2^26 and an i_d below 2^25: a sum of two
 * products is below 2^29. */
feasible_power_t feasible_power_of(const motor_model_t *m);

#endif

/* SPDX-License-Identifier: Apache-2.0 */
#include "torque/feasible_torque.h"

#include "config/bases.h"
#include "core/q15.h"

enum {
    CORRECTIONS = 2,
    NEWTON_STEPS = 2,
    VOLTAGE_CORRECTIONS = 5,
    SMALL_b = 1 << 8,
    CIRCLE_PASSES = 3,
    CIRCLE_RESERVE_LOG2 = 8, /* 0.4 % */
    MOST_TORQUE_b = 1 << 29,
    MOST_b = 1 << 25
};

static int32_t clamped_b(int32_t x)
{
    return q_limit(x, MOST_b);
}

static int32_t multiply64_b(int64_t a, int64_t b)
{
    return q_saturate64((a * b) >> 24);
}

/* The roots of M x^2 + 2 m x + n = 0, n in squared volts: those of the voltage ellipse. */
typedef struct {
    bool exist;
    int32_t lower_b, upper_b;
} roots_t;

static roots_t ellipse_roots(int32_t per_d, int32_t at_d, int32_t per_q, int32_t at_q,
                             int32_t voltage_b)
{
    /* |at_d + per_d x|^2 + |at_q + per_q x|^2 = voltage^2 */
    const int64_t half_b = ((int64_t)per_d * at_d + (int64_t)per_q * at_q) >> 24;
    const int32_t squared =
        q_max(q_saturate64(((int64_t)per_d * per_d + (int64_t)per_q * per_q) >> 24), 1);
    const int64_t excess =
        ((int64_t)at_d * at_d + (int64_t)at_q * at_q - (int64_t)voltage_b * voltage_b) >> 24;
    const int64_t under_root = half_b * half_b - squared * excess;
    const int32_t root = scaled_root(under_root);
    const int32_t middle = q_saturate64(half_b);
    const roots_t out = {
        .exist = under_root >= 0,
        .lower_b = clamped_b(scaled_ratio(-middle - root, squared)),
        .upper_b = clamped_b(scaled_ratio(-middle + root, squared)),
    };
    return out;
}

static bool voltage_suffices(const feasible_set_t *set, motor_point_t at)
{
    const int64_t u_d = motor_model_u_d_b(set->model, at);
    const int64_t u_q = motor_model_u_q_b(set->model, at);
    return u_d * u_d + u_q * u_q <= (int64_t)set->voltage_b * set->voltage_b;
}

static int32_t map_d_b(const feasible_set_t *set, int32_t airgap_b)
{
    const motor_constants_t *k = set->model->constants;
    return motor_model_current_b(
        k, loss_maps_row_d_mA(&set->row, scaled_shift(airgap_b, -k->torque_shift)));
}

/* i_d at a torque: the map's, or what the voltage ellipse leaves at this i_qt. */
static int32_t d_at_b(const feasible_set_t *set, motor_point_t at)
{
    const motor_model_t *m = set->model;
    const int32_t map_b = map_d_b(set, motor_model_airgap_b(m, at));
    at.d_b = map_b;
    if (voltage_suffices(set, at)) {
        return map_b;
    }
    const roots_t d = ellipse_roots(
        m->resistance_b, -scaled_multiply(m->reactance_q_b, at.x_b), m->voltage_q_per_d,
        m->voltage_q_b + scaled_multiply(m->voltage_q_per_x, at.x_b), set->voltage_b);
    return q_max(q_min(d.upper_b, map_b), q_min(set->weakest_d_b, map_b));
}

feasible_set_t feasible_set_at(const motor_model_t *model, int32_t phase_voltage_mV)
{
    const motor_constants_t *k = model->constants;
    const config_t *config = model->config;
    const int32_t most_mA =
        bases_current_mA(config, config->current_loop.field_weakening_current_pu_q15);
    /* Not beyond the end of the magnets' flux, L_d i_d = -psi. */
    const int32_t whole_b = scaled_ratio(model->flux_b, q_max(k->inductance_d_b, 1));
    const feasible_set_t out = {
        .model = model,
        .row = loss_maps_row_at(config, model->speed_mrad_s, model->winding_temperature_cC),
        .voltage_b = clamped_b(scaled_shift(q_max(phase_voltage_mV, 0), k->voltage_shift)),
        .weakest_d_b = -q_min(motor_model_current_b(k, most_mA), whole_b),
    };
    return out;
}

/* Magnitude of the shaft torque on a side, of an airgap torque along the rotation. */
static int32_t magnitude_mNm(const feasible_set_t *set, side_t side, int32_t airgap_b)
{
    const motor_model_t *m = set->model;
    const int32_t shaft_b = side * (airgap_b - m->friction_b);
    return scaled_shift(q_max(shaft_b, 0), -m->constants->torque_shift);
}

/* The far end of the ellipse at an i_d; false where the voltage suffices for no current. */
static bool ellipse_end(const feasible_set_t *set, side_t side, motor_point_t *at)
{
    const motor_model_t *m = set->model;
    const roots_t x = ellipse_roots(
        -m->reactance_q_b, scaled_multiply(m->resistance_b, at->d_b), m->voltage_q_per_x,
        m->voltage_q_b + scaled_multiply(m->voltage_q_per_d, at->d_b), set->voltage_b);
    at->x_b = side > 0 ? x.upper_b : x.lower_b;
    return x.exist;
}

int32_t feasible_by_voltage_mNm(const feasible_set_t *set, side_t side)
{
    const motor_model_t *m = set->model;
    motor_point_t at = {.d_b = set->weakest_d_b, .x_b = 0};
    bool exists = ellipse_end(set, side, &at);
    int32_t before_b = at.d_b;
    int32_t error_before_b = 0;
    for (int pass = 0; exists && pass < VOLTAGE_CORRECTIONS; pass++) {
        /* Where the map's i_d at this torque lies beyond field weakening's it is the one that
         * flows: the secant method on the difference. */
        const int32_t map_b = map_d_b(set, motor_model_airgap_b(m, at));
        const int32_t error_b = q_min(map_b, set->weakest_d_b) - at.d_b;
        if (error_b == 0) {
            break;
        }
        const int32_t change_b = error_before_b - error_b;
        int32_t step_b = error_b;
        if (pass > 0 && q_abs(change_b) > SMALL_b) {
            const int32_t slope = scaled_ratio(at.d_b - before_b, q_abs(change_b));
            step_b = clamped_b(multiply64_b(error_b, change_b > 0 ? slope : -slope));
        }
        before_b = at.d_b;
        error_before_b = error_b;
        at.d_b = q_clamp(at.d_b + step_b, -m->constants->current_most_b, set->weakest_d_b);
        exists = ellipse_end(set, side, &at);
    }
    return exists ? magnitude_mNm(set, side, motor_model_airgap_b(m, at)) : 0;
}

/* A little inside the limit, which leaves the fast loop's field weakening some current. */
static int32_t circle_b(const motor_model_t *m)
{
    return m->constants->current_most_b - (m->constants->current_most_b >> CIRCLE_RESERVE_LOG2);
}

/* i_qt on the current circle. */
static int32_t circle_x_b(const motor_model_t *m, side_t side, int32_t d_b, int32_t *left_b)
{
    const int64_t most_b = circle_b(m);
    *left_b = q_max(scaled_root(most_b * most_b - (int64_t)d_b * d_b), 1);
    return clamped_b(motor_model_x_of_i_q_b(m, side * *left_b, d_b));
}

/* Along the circle from the best i_d down to where the voltage suffices: Newton's method on
 * |u|^2 = U^2, which is nearly linear in i_d there. */
static motor_point_t circle_and_ellipse(const feasible_set_t *set, side_t side, motor_point_t at)
{
    const motor_model_t *m = set->model;
    const int32_t lowest_b = q_max(q_min(set->weakest_d_b, at.d_b), -circle_b(m));
    const int32_t highest_b = at.d_b;
    int32_t left_b = 0;
    for (int pass = 0; pass < NEWTON_STEPS; pass++) {
        at.x_b = circle_x_b(m, side, at.d_b, &left_b);
        const int64_t u_d = motor_model_u_d_b(m, at);
        const int64_t u_q = motor_model_u_q_b(m, at);
        const int64_t excess = (u_d * u_d + u_q * u_q - (int64_t)set->voltage_b * set->voltage_b);
        const int32_t slope_q = q_limit(scaled_ratio(-side * at.d_b, left_b), 1 << 27);
        const int32_t slope_x = scaled_multiply(m->inverse_one_plus_a2, slope_q - m->cross_d);
        const int64_t slope_u_d = m->resistance_b - scaled_multiply(m->reactance_q_b, slope_x);
        const int64_t slope_u_q = m->voltage_q_per_d + scaled_multiply(m->voltage_q_per_x, slope_x);
        const int64_t half_slope = (u_d * slope_u_d + u_q * slope_u_q) >> 24;
        if (half_slope <= 0) {
            at.d_b = lowest_b;
            continue;
        }
        const int32_t step_b = scaled_ratio(q_saturate64(excess >> 25), q_saturate64(half_slope));
        at.d_b = q_clamp(at.d_b - step_b, lowest_b, highest_b);
    }
    at.x_b = circle_x_b(m, side, at.d_b, &left_b);
    return at;
}

/* Maximum torque per ampere on the circle: the i_d at which (psi + (L_d - L_q) i_d) i_q is
 * largest. */
static int32_t circle_best_d_b(const motor_model_t *m)
{
    if (m->saliency_b == 0) {
        return 0;
    }
    const int32_t per_flux_b = scaled_multiply(m->saliency_b, m->constants->current_most_b);
    const int64_t psi_b = m->flux_b;
    const int32_t root_b = scaled_root(psi_b * psi_b + 8 * (int64_t)per_flux_b * per_flux_b);
    const int32_t d_of_most = scaled_ratio(root_b - m->flux_b, q_max(q_abs(4 * per_flux_b), 1));
    const int32_t d_b = scaled_multiply(d_of_most, m->constants->current_most_b);
    return m->saliency_b < 0 ? -d_b : d_b;
}

/* Airgap torque on the current circle, along the side. */
static int32_t circle_airgap_b(const motor_model_t *m, side_t side, int32_t d_b)
{
    int32_t left_b = 0;
    const motor_point_t at = {.d_b = d_b, .x_b = circle_x_b(m, side, d_b, &left_b)};
    return side * motor_model_airgap_b(m, at);
}

int32_t feasible_circle_d_b(const motor_model_t *m, int32_t airgap_b, int32_t map_d_b)
{
    const side_t side = airgap_b >= 0 ? SIDE_DRIVING : SIDE_BRAKING;
    const int32_t from_b = q_limit(map_d_b, m->constants->current_most_b);
    const int32_t best_b = circle_best_d_b(m);
    const int32_t most_b = circle_airgap_b(m, side, best_b);
    const int32_t missing_b = q_max(most_b - side * airgap_b, 0);
    int32_t d_b = from_b;
    for (int pass = 0; pass < CIRCLE_PASSES; pass++) {
        /* Near its maximum the torque is a parabola over i_d. */
        const int32_t span_b = most_b - circle_airgap_b(m, side, d_b);
        if (span_b < SMALL_b) {
            break;
        }
        const int32_t share = scaled_root((int64_t)scaled_ratio(missing_b, span_b) << 24);
        const int32_t lowest_b = q_min(from_b, best_b);
        d_b = q_clamp(best_b + scaled_multiply(q_min(share, 2 * SCALED_ONE), d_b - best_b),
                      lowest_b, best_b);
    }
    return d_b;
}

int32_t feasible_by_current_mNm(const feasible_set_t *set, side_t side)
{
    const motor_model_t *m = set->model;
    int32_t left_b = 0;
    motor_point_t at = {.d_b = circle_best_d_b(m), .x_b = 0};
    at.x_b = circle_x_b(m, side, at.d_b, &left_b);
    if (!voltage_suffices(set, at)) {
        at = circle_and_ellipse(set, side, at);
    }
    return magnitude_mNm(set, side, motor_model_airgap_b(m, at));
}

/* The sum u_d i_d + u_q i_q over i_qt at a fixed i_d: a x^2 + b x + c. */
typedef struct {
    int64_t a, b, c;
} power_t;

static power_t power_at_b(const motor_model_t *m, int32_t d_b)
{
    const int32_t i_q_b = m->iron_current_b + scaled_multiply(m->cross_d, d_b);
    const int32_t u_d_b = scaled_multiply(m->resistance_b, d_b);
    const int32_t u_q_b = m->voltage_q_b + scaled_multiply(m->voltage_q_per_d, d_b);
    const power_t out = {
        .a = multiply64_b(m->voltage_q_per_x, m->one_plus_a2),
        .b = ((int64_t)m->voltage_q_per_x * i_q_b + (int64_t)u_q_b * m->one_plus_a2 -
              (int64_t)m->reactance_q_b * d_b) >>
             24,
        .c = ((int64_t)u_d_b * d_b + (int64_t)u_q_b * i_q_b) >> 24,
    };
    return out;
}

/* Two thirds of current times voltage: the sum of the dq products of peak quantities. */
static int32_t limit_b(const feasible_set_t *set, int32_t current_mA, int32_t bus_mV)
{
    const motor_constants_t *k = set->model->constants;
    const int32_t i_b = motor_model_current_b(k, q_max(current_mA, 0));
    const int32_t v_b = clamped_b(scaled_shift(q_max(bus_mV, 0), k->voltage_shift));
    return scaled_multiply(scaled_multiply(i_b, v_b), SCALED_ONE / 3 * 2);
}

/* Where currents turned by an uncertain angle return more, README, Uncertain angle. */
static int32_t uncertain_b(const feasible_set_t *set, motor_point_t at)
{
    const motor_model_t *m = set->model;
    if (m->constants->hall_angle_b == 0) {
        return 0;
    }
    const int32_t i_q_b = motor_model_i_q_b(m, at);
    const int32_t saliency = m->reactance_d_b - m->reactance_q_b;
    const int32_t across_b = scaled_multiply(m->emf_b + scaled_multiply(saliency, at.d_b), at.d_b) -
                             scaled_multiply(scaled_multiply(saliency, i_q_b), i_q_b);
    const int32_t angle_b = scaled_multiply(m->speed_b, m->constants->hall_angle_b);
    return multiply64_b(q_abs(across_b), angle_b);
}

/* The largest torque that the motor may make on a side anyway, and its power: where even that is
 * within a limit there is nothing to solve. Its i_d is the first one of the solution otherwise. */
static motor_point_t at_cap(const feasible_set_t *set, side_t side, int32_t cap_mNm)
{
    const motor_model_t *m = set->model;
    const int32_t shaft_b = scaled_shift(cap_mNm, m->constants->torque_shift);
    const int32_t airgap_b = side * q_min(shaft_b, MOST_TORQUE_b) + m->friction_b;
    const int32_t map_b = map_d_b(set, airgap_b);
    motor_point_t at = {.d_b = map_b, .x_b = motor_model_x_of_airgap_b(m, airgap_b, map_b)};
    if (!voltage_suffices(set, at)) {
        at.d_b = d_at_b(set, at);
    }
    return at;
}

static int64_t power_b(const power_t *p, int32_t x_b)
{
    return (((((p->a * x_b) >> 24) + p->b) * x_b) >> 24) + p->c;
}

int32_t feasible_by_drawn_mNm(const feasible_set_t *set, side_t side, int32_t cap_mNm,
                              int32_t current_mA, int32_t bus_mV)
{
    const motor_model_t *m = set->model;
    const int32_t most_b =
        side > 0 ? limit_b(set, current_mA, bus_mV)
                 : q_max(limit_b(set, current_mA, bus_mV), m->constants->negligible_power_b);
    motor_point_t at = at_cap(set, side, cap_mNm);
    power_t p = power_at_b(m, at.d_b);
    if (power_b(&p, at.x_b) <= most_b) {
        return FEASIBLE_UNBOUNDED;
    }
    for (int pass = 0;; pass++) {
        const int64_t left = most_b - p.c;
        const int32_t root = scaled_root(p.b * p.b + 4 * p.a * left);
        const int32_t sum = q_saturate64(p.b + root);
        if (side > 0) {
            at.x_b = left <= 0 ? 0 : scaled_ratio(q_saturate64(2 * left), q_max(sum, 1));
        } else {
            at.x_b = -scaled_ratio(sum, q_max(q_saturate64(2 * p.a), 1));
        }
        at.x_b = clamped_b(at.x_b);
        if (pass == CORRECTIONS) {
            return magnitude_mNm(set, side, motor_model_airgap_b(m, at));
        }
        at.d_b = d_at_b(set, at);
        p = power_at_b(m, at.d_b);
    }
}

int32_t feasible_by_returned_mNm(const feasible_set_t *set, int32_t cap_mNm, int32_t current_mA,
                                 int32_t bus_mV)
{
    const motor_model_t *m = set->model;
    const int32_t most_b = limit_b(set, current_mA, bus_mV);
    motor_point_t at = at_cap(set, SIDE_BRAKING, cap_mNm);
    power_t p = power_at_b(m, at.d_b);
    const int64_t vertex_b = 2 * ((p.a * at.x_b) >> 24) + p.b;
    if (vertex_b >= 0 && power_b(&p, at.x_b) - uncertain_b(set, at) >= -(int64_t)most_b) {
        return FEASIBLE_UNBOUNDED; /* more and more comes back up to the cap, and not too much */
    }
    for (int pass = 0;; pass++) {
        const int64_t left = p.c + most_b - uncertain_b(set, at);
        const int64_t under_root = p.b * p.b - 4 * p.a * left;
        const int32_t sum = q_max(q_saturate64(p.b + scaled_root(under_root)), 1);
        at.x_b = left <= 0 ? 0 : -clamped_b(scaled_ratio(q_saturate64(2 * left), sum));
        if (pass == CORRECTIONS) {
            const int64_t least = p.c + q_max(most_b, m->constants->negligible_power_b);
            return p.b <= 0 || under_root < 0 || p.b * p.b < 4 * p.a * least
                       ? FEASIBLE_UNBOUNDED
                       : magnitude_mNm(set, SIDE_BRAKING, motor_model_airgap_b(m, at));
        }
        at.d_b = d_at_b(set, at);
        p = power_at_b(m, at.d_b);
    }
}

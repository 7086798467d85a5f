/* SPDX-License-Identifier: Apache-2.0 */
/* Battery power: the largest torque that draws or returns no more than a power. */
#include "feasible_ellipse.h"

enum {
    CORRECTIONS = 3,   /* of i_d, for a power; a further one only after a large change */
    FAR_LOG2 = 5,      /* 3 % of the phase current */
    STEEPEST = 1 << 25 /* i_d over i_qt, 24 fraction bits */
};

/* A sum of coefficients, each up to 2^30 in an extreme configuration. */
static int32_t sum(int32_t first, int32_t second, int32_t third)
{
    return within(q_add(q_add(first, second), third));
}

/* The resistance of the conducting switches counts as the winding's. */
feasible_power_t feasible_power_of(const motor_model_t *m)
{
    const int32_t switches_b = m->constants->loss_resistance_b;
    const int32_t per_x = m->voltage_q_per_x + scaled_multiply(switches_b, m->one_plus_a2);
    const int32_t per_d = m->voltage_q_per_d + scaled_multiply(switches_b, m->cross_d);
    const int32_t at_zero_b = m->voltage_q_b + scaled_multiply(switches_b, m->iron_current_b);
    const feasible_power_t out = {
        .a = within(scaled_multiply(per_x, m->one_plus_a2)),
        .b = sum(scaled_multiply(per_x, m->iron_current_b),
                 scaled_multiply(at_zero_b, m->one_plus_a2), 0),
        .b_d = sum(scaled_multiply(per_x, m->cross_d), scaled_multiply(per_d, m->one_plus_a2),
                   -m->reactance_q_b),
        .c = within(scaled_multiply(at_zero_b, m->iron_current_b)),
        .c_d = sum(scaled_multiply(at_zero_b, m->cross_d),
                   scaled_multiply(per_d, m->iron_current_b), 0),
        .c_dd = sum(m->resistance_b, switches_b, scaled_multiply(per_d, m->cross_d)),
    };
    return out;
}

/* Along a straight line of currents, i_d = offset + slope x: a x^2 + b x + c. */
typedef struct {
    int32_t offset_b, slope; /* slope: 24 fraction bits */
    int32_t a, b, c;
} power_t;

static power_t power_at(const feasible_set_t *set, int32_t d_b)
{
    const feasible_power_t *p = &set->power;
    const power_t out = {
        .offset_b = d_b,
        .slope = 0,
        .a = p->a,
        .b = p->b + scaled_multiply(p->b_d, d_b),
        .c = p->c + scaled_multiply(p->c_d + scaled_multiply(p->c_dd, d_b), d_b),
    };
    return out;
}

static power_t power_along(const feasible_set_t *set, motor_point_t at, int32_t slope)
{
    const feasible_power_t *p = &set->power;
    const int32_t by_slope = scaled_multiply(p->c_dd, slope);
    power_t out = power_at(set, clamped_b(at.d_b - scaled_multiply(slope, at.x_b)));
    out.slope = slope;
    out.a = within(p->a + scaled_multiply(p->b_d + by_slope, slope));
    out.b += scaled_multiply(2 * by_slope, out.offset_b) + scaled_multiply(p->c_d, slope);
    return out;
}

static int64_t power_of_x_b(const power_t *p, int32_t x_b)
{
    const int64_t per_x = (((int64_t)p->a * x_b) >> 24) + p->b;
    return ((per_x * x_b) >> 24) + p->c;
}

/* Two thirds of current times voltage: the sum of the dq products of peak quantities. */
int32_t feasible_power_b(const motor_model_t *model, int32_t current_mA, int32_t bus_mV)
{
    const motor_constants_t *k = model->constants;
    const int32_t i_b = motor_model_current_b(k, q_max(current_mA, 0));
    const int32_t v_b = clamped_b(scaled_shift(q_max(bus_mV, 0), k->voltage_shift));
    return scaled_multiply(scaled_multiply(i_b, v_b), SCALED_ONE / 3 * 2);
}

/* Additional returned power by the angle error: DERIVATIONS.md, Uncertain angle. */
static int32_t uncertain_b(const motor_model_t *m, motor_point_t at, int32_t i_q_b)
{
    const int32_t saliency = m->reactance_d_b - m->reactance_q_b;
    const int32_t u_q_b = clamped_b(m->emf_b + scaled_multiply(saliency, at.d_b));
    const int32_t u_d_b = clamped_b(scaled_multiply(saliency, i_q_b));
    const int32_t across_b = scaled_dot(u_q_b, at.d_b, -u_d_b, i_q_b);
    const int32_t angle_b = scaled_multiply(m->speed_b, m->constants->hall_angle_b);
    return multiply64_b(q_abs(across_b), angle_b);
}

/* Adds the switching loss of the bridge, c |i|, as a straight line over x: that of a point, with
 * the slope of |i_q|. Returns i_q. */
static int32_t add_switching(power_t *p, const motor_model_t *m, const motor_point_t *at)
{
    const int32_t i_q_b = clamped_b(motor_model_i_q_b(m, *at));
    const int32_t per_ampere_b = m->constants->loss_b;
    const int32_t current_b = motor_model_magnitude_b(at->d_b, i_q_b);
    const int32_t offset_b = i_q_b < 0 ? current_b + at->x_b : current_b - at->x_b;
    p->b += i_q_b < 0 ? -per_ampere_b : per_ampere_b;
    p->c = coefficient_sum(p->c, scaled_multiply(per_ampere_b, offset_b));
    return i_q_b;
}

/* Power into the battery, less what an uncertain angle may return beyond the margin: but no draw by
 * that. */
static int32_t charging_b(const motor_model_t *m, motor_point_t at, int32_t i_q_b,
                          feasible_returned_t returned)
{
    if (m->constants->hall_angle_b == 0) {
        return returned.power_b;
    }
    const int32_t beyond_b = uncertain_b(m, at, i_q_b) - returned.margin_b;
    return returned.power_b - q_clamp(beyond_b, 0, q_max(returned.power_b, 0));
}

int32_t feasible_excess_b(const feasible_set_t *set, motor_point_t at, feasible_returned_t returned)
{
    const motor_model_t *m = set->model;
    const power_t p = power_at(set, at.d_b);
    const int32_t i_q_b = clamped_b(motor_model_i_q_b(m, at));
    const int32_t switching_b =
        scaled_multiply(m->constants->loss_b, motor_model_magnitude_b(at.d_b, i_q_b));
    return q_saturate64(power_of_x_b(&p, at.x_b) + switching_b +
                        charging_b(m, at, i_q_b, returned));
}

/* i_d over i_qt along the voltage ellipse, at a point on it. */
static int32_t ellipse_slope(const motor_model_t *m, motor_point_t at)
{
    const int32_t u_d = motor_model_u_d_b(m, at);
    const int32_t u_q = motor_model_u_q_b(m, at);
    const int32_t per_x = scaled_dot(u_q, m->voltage_q_per_x, -u_d, m->reactance_q_b);
    const int32_t per_d = scaled_dot(u_q, m->voltage_q_per_d, u_d, m->resistance_b);
    return q_limit(scaled_ratio(-per_x, q_max(per_d, 1)), STEEPEST);
}

/* i_d follows the torque: that of the map, or that of the voltage ellipse at this i_qt if lower.
 * True where it moves so far that the power needs another correction. */
static bool corrected(const feasible_set_t *set, motor_point_t *at, bool straight, power_t *power)
{
    const int32_t before_b = at->d_b;
    const int32_t map_b = map_d_b(set, motor_model_airgap_b(set->model, *at));
    const motor_point_t by_map = {.d_b = map_b, .x_b = at->x_b};
    bool on_ellipse = false;
    if (voltage_suffices(set, by_map)) {
        at->d_b = map_b;
    } else {
        const int32_t x_per_d = motor_model_x_per_d(set->model, *at);
        const line_t line = line_from(set->model, *at, SCALED_ONE, x_per_d);
        const int32_t lowest_b = q_min(set->weakest_d_b, map_b);
        int32_t change_b = 0;
        (void)feasible_ellipse_root(set, &line, 1, &change_b);
        at->d_b = q_clamp(before_b + change_b, lowest_b, map_b);
        at->x_b = clamped_b(at->x_b + scaled_multiply(x_per_d, at->d_b - before_b));
        on_ellipse = at->d_b > lowest_b;
    }
    const bool far = q_abs(at->d_b - before_b) > set->model->constants->current_most_b >> FAR_LOG2;
    const bool along = far && straight && on_ellipse;
    *power = along ? power_along(set, *at, ellipse_slope(set->model, *at)) : power_at(set, at->d_b);
    return far;
}

/* Of a x^2 + b x = left, b > 0, the root nearest zero; zero if that has the other sign. */
static int32_t near_root_b(const power_t *p, int32_t left, int32_t sign)
{
    const int64_t under_root = square(p->b) + 4 * (int64_t)p->a * left;
    const int32_t sum = q_max(p->b + scaled_root(under_root), 1);
    return (left > 0) == (sign > 0) ? clamped_b(scaled_ratio(2 * left, sum)) : 0;
}

feasible_cap_power_t feasible_cap_power(const feasible_side_t *side)
{
    power_t p = power_at(side->set, side->cap.d_b);
    const int32_t i_q_b = add_switching(&p, side->set->model, &side->cap);
    const feasible_cap_power_t out = {
        .a = p.a, .b = p.b, .c = p.c, .i_q_b = i_q_b, .drawn_b = power_of_x_b(&p, side->cap.x_b)};
    return out;
}

static power_t power_of_cap(const feasible_side_t *side, const feasible_cap_power_t *cap)
{
    const power_t out = {
        .offset_b = side->cap.d_b, .slope = 0, .a = cap->a, .b = cap->b, .c = cap->c};
    return out;
}

int32_t feasible_by_drawn_at(const feasible_side_t *side, const feasible_cap_power_t *cap,
                             int32_t power_b, motor_point_t *found)
{
    const motor_model_t *m = side->set->model;
    const bool drives = side->sign > 0;
    const int32_t most_b = drives ? power_b : q_max(power_b, m->constants->negligible_power_b);
    motor_point_t at = side->cap;
    *found = at;
    if (cap->drawn_b <= most_b) {
        return FEASIBLE_UNBOUNDED;
    }
    power_t p = power_of_cap(side, cap);
    bool last = false;
    for (int pass = 0;; pass++) {
        const int32_t left = coefficient_sum(most_b, -p.c);
        if (drives) {
            at.x_b = near_root_b(&p, left, 1);
        } else {
            const int32_t sum = p.b + scaled_root(square(p.b) + 4 * (int64_t)p.a * left);
            at.x_b = clamped_b(-scaled_ratio(sum, q_max(2 * p.a, 1)));
        }
        at.d_b = clamped_b(p.offset_b + scaled_multiply(p.slope, at.x_b));
        if (last) {
            *found = at;
            return feasible_magnitude_mNm(side, motor_model_airgap_b(m, at));
        }
        last = !corrected(side->set, &at, drives, &p) || pass == CORRECTIONS - 1;
        (void)add_switching(&p, m, &at);
    }
}

int32_t feasible_by_returned_at(const feasible_side_t *side, const feasible_cap_power_t *cap,
                                feasible_returned_t returned, motor_point_t *found)
{
    const motor_model_t *m = side->set->model;
    motor_point_t at = side->cap;
    *found = at;
    power_t p = power_of_cap(side, cap);
    p.c = coefficient_sum(p.c, charging_b(m, at, cap->i_q_b, returned));
    const int64_t vertex_b = 2 * (((int64_t)p.a * at.x_b) >> 24) + p.b;
    if (vertex_b >= 0 && cap->drawn_b + (p.c - cap->c) >= 0) {
        return FEASIBLE_UNBOUNDED; /* the power returned up to the cap is below the bound */
    }
    bool last = false;
    for (int pass = 0;; pass++) {
        at.x_b = near_root_b(&p, -p.c, -1);
        at.d_b = clamped_b(p.offset_b + scaled_multiply(p.slope, at.x_b));
        if (last) {
            const int32_t missing_b = m->constants->negligible_power_b - q_max(returned.power_b, 0);
            const int32_t least_b = coefficient_sum(p.c, q_max(missing_b, 0));
            if (p.b <= 0 || square(p.b) < 4 * (int64_t)p.a * least_b) {
                return FEASIBLE_UNBOUNDED;
            }
            *found = at;
            return feasible_magnitude_mNm(side, motor_model_airgap_b(m, at));
        }
        at.x_b = q_max(at.x_b, side->cap.x_b);
        last = !corrected(side->set, &at, true, &p) || pass == CORRECTIONS - 1;
        const int32_t i_q_b = add_switching(&p, m, &at);
        p.c = coefficient_sum(p.c, charging_b(m, at, i_q_b, returned));
    }
}

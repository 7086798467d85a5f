/* SPDX-License-Identifier: Apache-2.0 */
/* The phase current circle: maximum torque per ampere, and where the voltage ellipse meets it. */
#include "feasible_ellipse.h"

enum {
    CIRCLE_STEPS = 4,              /* to the ellipse; up to a short one */
    SHORT_ANGLE = SCALED_ONE >> 3, /* rad; the error left is of the third order */
    CIRCLE_PASSES = 3,             /* to the torque */
    SMALL_SPAN_LOG2 = 14,          /* of the largest torque, whose scale may be coarse */
    FORCED_RESERVE_LOG2 = 8        /* of the squared voltage, for the second order */
};

/* Magnitude of i_q on the circle at an i_d. */
static int32_t circle_q_b(const motor_model_t *m, int32_t d_b)
{
    return q_max(scaled_root(square(circle_b(m)) - square(d_b)), 1);
}

static motor_point_t point_of(const motor_model_t *m, int32_t d_b, int32_t i_q_b)
{
    const motor_point_t out = {.d_b = d_b, .x_b = clamped_b(motor_model_x_of_i_q_b(m, i_q_b, d_b))};
    return out;
}

/* The point on the circle at an i_d; sign: of its i_q. */
static motor_point_t on_circle(const motor_model_t *m, int32_t sign, int32_t d_b)
{
    return point_of(m, d_b, sign * circle_q_b(m, d_b));
}

/* Maximum torque per ampere on the circle: the i_d at which (psi + (L_d - L_q) i_d) i_q is largest.
 * Written without a difference of two nearly equal numbers, for a small saliency. */
static int32_t best_d_b(const motor_model_t *m)
{
    const int32_t per_flux_b = scaled_multiply(m->slope_saliency_b, m->constants->current_most_b);
    const int32_t root_b = scaled_root(square(m->slope_flux_b) + 8 * square(per_flux_b));
    const int32_t d_of_most = scaled_ratio(2 * per_flux_b, root_b + m->slope_flux_b);
    return scaled_multiply(d_of_most, m->constants->current_most_b);
}

/* DERIVATIONS.md, Phase current: the quadratic of both sides, and its change by the resistive
 * power. */
static feasible_circle_t circle_start(const feasible_set_t *set)
{
    const motor_model_t *m = set->model;
    const int32_t most_b = circle_b(m);
    const int32_t reactive_b = clamped_b(scaled_multiply(m->reactance_q_b, most_b));
    const int32_t resistive_b = clamped_b(scaled_multiply(m->resistance_b, most_b));
    const int32_t emf_b = clamped_b(m->emf_b);
    const int32_t excess = coefficient_of_products(square(emf_b) + square(reactive_b) +
                                                   square(resistive_b) - set->voltage_squared);
    const int32_t half = coefficient_of_products((int64_t)m->reactance_d_b * emf_b);
    const int32_t squared =
        coefficient_of_products(square(m->reactance_d_b) - square(m->reactance_q_b));
    const int32_t root = q_max(scaled_root(square(half) - (int64_t)squared * excess), 1);
    const int32_t best_b = best_d_b(m);
    const int32_t lowest_b = q_max(q_min(set->weakest_d_b, best_b), -most_b);
    const int32_t d_b = q_limit(-scaled_ratio(excess, half + root), most_b - most_b / 64);
    const int32_t at_b = q_clamp(d_b, lowest_b, best_b);
    const int32_t i_q_b = scaled_root(square(most_b) - square(at_b));
    const int32_t across_b =
        clamped_b(emf_b + scaled_multiply(m->reactance_d_b - m->reactance_q_b, at_b));
    const int32_t power_b = scaled_multiply(scaled_multiply(m->resistance_b, i_q_b), across_b);
    const feasible_circle_t out = {
        .known = true,
        .best_b = best_b,
        .lowest_b = lowest_b,
        .d_b = d_b,
        .by_side_b = q_limit(scaled_ratio(power_b, root), most_b / 8),
    };
    return out;
}

/* The angle along the circle to the ellipse, towards higher |u|, at most half a radian: on the line
 * of its tangent |u|^2 to the second order, the circle bending towards the voltage of no current.
 */
static int32_t circle_root(const feasible_set_t *set, const line_t *line)
{
    const motor_model_t *m = set->model;
    const int32_t half = coefficient_of_products((int64_t)line->slope_d * line->u_d +
                                                 (int64_t)line->slope_q * line->u_q);
    const int64_t u_squared = square(line->u_d) + square(line->u_q);
    const int32_t excess = coefficient_of_products(u_squared - set->voltage_squared);
    const int64_t inwards = u_squared - (int64_t)line->u_q * m->voltage_q_b;
    const int32_t squared =
        coefficient_of_products(square(line->slope_d) + square(line->slope_q) - inwards);
    const int32_t root = scaled_root(square(half) - (int64_t)squared * excess);
    const int32_t t = half > 0 ? scaled_ratio(-excess, half + root)
                               : scaled_ratio(root - half, q_max(squared, 1));
    return q_limit(t, SCALED_ONE / 2);
}

/* Along the circle from its start to the ellipse, between the lowest i_d and the best: steps to the
 * second order, up to a short one. */
static motor_point_t circle_and_ellipse(const feasible_side_t *side,
                                        const feasible_circle_t *circle)
{
    const feasible_set_t *set = side->set;
    const motor_model_t *m = set->model;
    const int32_t start_b = circle->d_b - side->sign * circle->by_side_b;
    const int32_t from_b = q_clamp(start_b, circle->lowest_b, circle->best_b);
    int32_t i_q_b = side->sign * circle_q_b(m, from_b);
    motor_point_t at = point_of(m, from_b, i_q_b);
    int32_t before = 0;
    for (int pass = 0; pass < CIRCLE_STEPS; pass++) {
        /* Along the tangent, as long as i_q. */
        const int32_t d_per_t = q_abs(i_q_b);
        const int32_t q_per_t = -side->sign * at.d_b;
        const line_t line =
            line_from(m, at, d_per_t,
                      scaled_multiply(m->inverse_one_plus_a2,
                                      q_per_t - scaled_multiply(m->cross_d, d_per_t)));
        const int32_t t = circle_root(set, &line);
        const int32_t bend = scaled_multiply(t, t) / 2;
        int32_t d_b = 0;
        int32_t q_b = 0;
        /* Of i_d and i_q the smaller one changes more; the other follows from the circle. */
        const bool by_q = at.d_b < -d_per_t;
        if (by_q) {
            const int32_t change_b = scaled_dot(t, q_per_t, -bend, i_q_b);
            q_b = q_clamp(side->sign * (i_q_b + change_b), 1, circle_b(m));
            d_b = -scaled_root(square(circle_b(m)) - square(q_b));
        } else {
            d_b = at.d_b + scaled_dot(t, d_per_t, -bend, at.d_b);
        }
        const int32_t to_b = q_clamp(d_b, circle->lowest_b, circle->best_b);
        if (to_b == at.d_b) {
            break; /* at an end */
        }
        i_q_b = side->sign * (by_q && to_b == d_b ? q_b : circle_q_b(m, to_b));
        at = point_of(m, to_b, i_q_b);
        const bool turned = (t < 0) != (before < 0) && q_abs(t) > q_abs(before) / 2;
        if (q_abs(t) < SHORT_ANGLE || (before != 0 && turned)) {
            break; /* near enough; or to and fro, where the two do not meet */
        }
        before = t;
    }
    return at;
}

int32_t feasible_by_current_mNm(feasible_side_t *side, feasible_circle_t *circle)
{
    const motor_model_t *m = side->set->model;
    const int32_t i_q_b = motor_model_i_q_b(m, side->cap);
    if (side->cap_has_voltage && square(side->cap.d_b) + square(i_q_b) <= square(circle_b(m))) {
        return FEASIBLE_UNBOUNDED;
    }
    if (!circle->known) {
        *circle = circle_start(side->set);
    }
    const motor_point_t end = circle_and_ellipse(side, circle);
    const int32_t end_mNm = feasible_magnitude_mNm(side, motor_model_airgap_b(m, end));
    if (end_mNm < side->cap_mNm) {
        side->cap = end;
        side->cap_mNm = end_mNm;
    } else if (!side->cap_has_voltage) {
        feasible_weaken_cap(side);
    }
    return end_mNm;
}

/* Where the voltage suffices on the circle at the lowest i_d, the ellipse meets the circle there or
 * at a higher one: no need to know where the ellipse ends. Where it suffices for no torque, the two
 * do not meet, and the current bounds nothing. */
feasible_bounds_t feasible_by_voltage_and_current(feasible_side_t *side, feasible_circle_t *circle)
{
    const feasible_set_t *set = side->set;
    feasible_bounds_t out = {.voltage_mNm = FEASIBLE_UNBOUNDED};
    if (!side->cap_has_voltage &&
        !voltage_suffices(set, on_circle(set->model, side->sign, set->weakest_d_b))) {
        out.voltage_mNm = feasible_by_voltage_mNm(side);
    }
    out.current_mNm =
        out.voltage_mNm > 0 ? feasible_by_current_mNm(side, circle) : FEASIBLE_UNBOUNDED;
    return out;
}

/* DERIVATIONS.md, Forced torque: |u|^2 along the circle to the second order, from zero torque
 * towards braking; its root nearest zero torque, or its least. */
static motor_point_t least_forced(const feasible_set_t *set, motor_point_t at, int32_t i_q_b)
{
    const motor_model_t *m = set->model;
    const int32_t most_b = q_min(circle_b(m), -set->weakest_d_b);
    const int32_t d_per_t = -i_q_b;
    const int32_t x_per_t =
        scaled_multiply(m->inverse_one_plus_a2, at.d_b - scaled_multiply(m->cross_d, d_per_t));
    const line_t line = line_from(m, at, d_per_t, x_per_t);
    const int32_t half =
        coefficient(((int64_t)line.slope_d * line.u_d + (int64_t)line.slope_q * line.u_q) >> 24);
    const int64_t within =
        feasible_most_squared(set) - (set->voltage_squared >> FORCED_RESERVE_LOG2);
    const int32_t excess = coefficient((square(line.u_d) + square(line.u_q) - within) >> 24);
    const int64_t inwards = square(line.u_d) + (int64_t)line.u_q * (line.u_q - m->voltage_q_b);
    const int32_t squared =
        coefficient((square(line.slope_d) + square(line.slope_q) - inwards) >> 24);
    const int32_t root = scaled_root(square(half) - (int64_t)squared * excess);
    const int32_t t = q_clamp(scaled_ratio(-half - root, q_max(squared, 1)), 0, SCALED_ONE / 2);
    const int32_t q_b = q_limit(i_q_b + scaled_multiply(t, at.d_b), most_b);
    const int32_t d_b = -scaled_root(square(most_b) - square(q_b));
    const motor_point_t out = {.d_b = d_b, .x_b = clamped_b(motor_model_x_of_i_q_b(m, q_b, d_b))};
    return out;
}

bool feasible_forced(const feasible_set_t *set, motor_point_t *at)
{
    const motor_model_t *m = set->model;
    motor_point_t none = {.d_b = set->weakest_d_b, .x_b = 0};
    if (feasible_holds(set, *at) || feasible_holds(set, none)) {
        return false;
    }
    const int32_t i_q_b = clamped_b(motor_model_i_q_b(m, none));
    *at = least_forced(set, none, i_q_b);
    return true;
}

/* Near its maximum the torque is a parabola over i_d. */
int32_t feasible_circle_d_b(const feasible_set_t *set, int32_t airgap_b, int32_t map_b)
{
    const motor_model_t *m = set->model;
    const int32_t sign = airgap_b >= 0 ? 1 : -1;
    const int32_t best_b = best_d_b(m);
    const int32_t lowest_b = q_min(q_limit(map_b, m->constants->current_most_b), best_b);
    const int32_t most_b = sign * motor_model_airgap_b(m, on_circle(m, sign, best_b));
    const int32_t missing_b = q_max(most_b - sign * airgap_b, 0);
    int32_t d_b = q_limit(map_b, m->constants->current_most_b);
    for (int pass = 0; pass < CIRCLE_PASSES; pass++) {
        const int32_t here_b = sign * motor_model_airgap_b(m, on_circle(m, sign, d_b));
        const int32_t span_b = most_b - here_b;
        if (span_b <= q_abs(most_b) >> SMALL_SPAN_LOG2) {
            break;
        }
        const int32_t share = scaled_root((int64_t)scaled_ratio(missing_b, span_b) << 24);
        d_b = q_clamp(best_b + scaled_multiply(q_min(share, 2 * SCALED_ONE), d_b - best_b),
                      lowest_b, best_b);
    }
    return d_b;
}

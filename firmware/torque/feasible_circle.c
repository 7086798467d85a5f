/* SPDX-License-Identifier: Apache-2.0 */
/* The phase current circle: maximum torque per ampere, and where the voltage ellipse meets it. */
#include "feasible_ellipse.h"

enum {
    NEWTON_STEPS = 3, /* along the circle to the ellipse */
    CIRCLE_PASSES = 3 /* to the torque */
};

/* The point on the circle at an i_d; *i_q_b its i_q, signed. */
static motor_point_t on_circle(const motor_model_t *m, int32_t sign, int32_t d_b, int32_t *i_q_b)
{
    *i_q_b = sign * q_max(scaled_root(square(circle_b(m)) - square(d_b)), 1);
    const motor_point_t out = {.d_b = d_b,
                               .x_b = clamped_b(motor_model_x_of_i_q_b(m, *i_q_b, d_b))};
    return out;
}

/* Where circle and ellipse meet without resistance and iron loss: the root of
 * (X_d^2 - X_q^2) d^2 + 2 w psi X_d d + (w psi)^2 + (X_q I)^2 - U^2 for which i_d is highest. */
static int32_t lossless_d_b(const feasible_set_t *set)
{
    const motor_model_t *m = set->model;
    const int32_t u_d_most_b = clamped_b(scaled_multiply(m->reactance_q_b, circle_b(m)));
    const int32_t u_q_most_b = clamped_b(scaled_multiply(m->reactance_d_b, circle_b(m)));
    const int32_t emf_b = clamped_b(m->emf_b);
    const int64_t a = (square(u_d_most_b) - square(u_q_most_b)) >> 23;
    const int64_t b = ((int64_t)emf_b * u_q_most_b) >> 23;
    const int64_t c = (square(emf_b) + square(u_d_most_b) - set->voltage_squared) >> 23;
    const int32_t sum =
        coefficient(b + scaled_root(square(coefficient(b)) +
                                    (int64_t)coefficient(a) * q_max(coefficient(c), 0)));
    const int32_t share = scaled_ratio(coefficient(c), q_max(sum, 1));
    return -scaled_multiply(q_clamp(share, 0, SCALED_ONE - SCALED_ONE / 64), circle_b(m));
}

/* The angle along the circle to the ellipse, towards higher |u|, at most half a radian: on the line
 * of its tangent |u|^2 to the second order, the circle bending towards the voltage of no current.
 */
static int32_t circle_root(const feasible_set_t *set, const line_t *line)
{
    const motor_model_t *m = set->model;
    const int32_t half = coefficient(
        ((int64_t)line->slope_d * line->u_d + (int64_t)line->slope_q * line->u_q) >> 24);
    const int32_t excess =
        coefficient((square(line->u_d) + square(line->u_q) - set->voltage_squared) >> 24);
    const int64_t inwards = square(line->u_d) + (int64_t)line->u_q * (line->u_q - m->voltage_q_b);
    const int32_t squared =
        coefficient((square(line->slope_d) + square(line->slope_q) - inwards) >> 24);
    const int32_t root = scaled_root(square(half) - (int64_t)squared * excess);
    const int32_t t = half > 0 ? scaled_ratio(-excess, q_max(half + root, 1))
                               : scaled_ratio(root - half, q_max(squared, 1));
    return q_limit(t, SCALED_ONE / 2);
}

/* Along the circle from the best i_d down to where the voltage suffices: from the lossless point
 * to the second order. */
static motor_point_t circle_and_ellipse(const feasible_side_t *side)
{
    const feasible_set_t *set = side->set;
    const motor_model_t *m = set->model;
    const int32_t highest_b = set->best_d_b;
    const int32_t lowest_b = q_max(q_min(set->weakest_d_b, highest_b), -circle_b(m));
    int32_t i_q_b = 0;
    motor_point_t at =
        on_circle(m, side->sign, q_clamp(lossless_d_b(set), lowest_b, highest_b), &i_q_b);
    for (int pass = 0; pass < NEWTON_STEPS; pass++) {
        /* Along the tangent, as long as i_q. */
        const int32_t d_per_t = q_abs(i_q_b);
        const int32_t q_per_t = -side->sign * at.d_b;
        const line_t line =
            line_from(m, at, d_per_t,
                      scaled_multiply(m->inverse_one_plus_a2,
                                      q_per_t - scaled_multiply(m->cross_d, d_per_t)));
        const int32_t t = circle_root(set, &line);
        const int32_t bend = scaled_multiply(t, t) / 2;
        int32_t d_b = at.d_b + scaled_multiply(t, d_per_t) - scaled_multiply(bend, at.d_b);
        if (at.d_b < -d_per_t) {
            const int32_t change_b = scaled_multiply(t, q_per_t) - scaled_multiply(bend, i_q_b);
            const int32_t q_b = q_clamp(side->sign * (i_q_b + change_b), 1, circle_b(m));
            d_b = -scaled_root(square(circle_b(m)) - square(q_b));
        }
        at = on_circle(m, side->sign, q_clamp(d_b, lowest_b, highest_b), &i_q_b);
    }
    return at;
}

int32_t feasible_by_current_mNm(const feasible_side_t *side)
{
    const motor_model_t *m = side->set->model;
    int32_t i_q_b = motor_model_i_q_b(m, side->cap);
    if (side->cap_has_voltage && square(side->cap.d_b) + square(i_q_b) <= square(circle_b(m))) {
        return FEASIBLE_UNBOUNDED;
    }
    motor_point_t at = on_circle(m, side->sign, side->set->best_d_b, &i_q_b);
    if (!voltage_suffices(side->set, at)) {
        at = circle_and_ellipse(side);
    }
    return feasible_magnitude_mNm(side, motor_model_airgap_b(m, at));
}

int32_t feasible_circle_best_d_b(const motor_model_t *m)
{
    if (m->saliency_b == 0) {
        return 0;
    }
    const int32_t per_flux_b = scaled_multiply(m->saliency_b, m->constants->current_most_b);
    const int32_t root_b = scaled_root(square(m->flux_b) + 8 * square(per_flux_b));
    const int32_t d_of_most = scaled_ratio(root_b - m->flux_b, q_max(q_abs(4 * per_flux_b), 1));
    const int32_t d_b = scaled_multiply(d_of_most, m->constants->current_most_b);
    return m->saliency_b < 0 ? -d_b : d_b;
}

/* Near its maximum the torque is a parabola over i_d. */
int32_t feasible_circle_d_b(const feasible_set_t *set, int32_t airgap_b, int32_t map_b)
{
    const motor_model_t *m = set->model;
    const int32_t sign = airgap_b >= 0 ? 1 : -1;
    const int32_t best_b = set->best_d_b;
    const int32_t lowest_b = q_min(q_limit(map_b, m->constants->current_most_b), best_b);
    int32_t i_q_b = 0;
    const int32_t most_b = sign * motor_model_airgap_b(m, on_circle(m, sign, best_b, &i_q_b));
    const int32_t missing_b = q_max(most_b - sign * airgap_b, 0);
    int32_t d_b = q_limit(map_b, m->constants->current_most_b);
    for (int pass = 0; pass < CIRCLE_PASSES; pass++) {
        const int32_t here_b = sign * motor_model_airgap_b(m, on_circle(m, sign, d_b, &i_q_b));
        const int32_t span_b = most_b - here_b;
        if (span_b < ELLIPSE_SMALL_b) {
            break;
        }
        const int32_t share = scaled_root((int64_t)scaled_ratio(missing_b, span_b) << 24);
        d_b = q_clamp(best_b + scaled_multiply(q_min(share, 2 * SCALED_ONE), d_b - best_b),
                      lowest_b, best_b);
    }
    return d_b;
}

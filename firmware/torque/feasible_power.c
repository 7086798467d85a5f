/* SPDX-License-Identifier: Apache-2.0 */
/* Battery power: the largest torque that draws or returns no more than a power. */
#include "feasible_ellipse.h"

enum {
    CORRECTIONS = 3, /* of i_d, for a power; after the first only after a large change */
    FAR_LOG2 = 5     /* 3 % of the phase current */
};

feasible_power_t feasible_power_of(const motor_model_t *m)
{
    const feasible_power_t out = {
        .a = within(scaled_multiply(m->voltage_q_per_x, m->one_plus_a2)),
        .b = within(scaled_multiply(m->voltage_q_per_x, m->iron_current_b) +
                    scaled_multiply(m->voltage_q_b, m->one_plus_a2)),
        .b_d = within(scaled_multiply(m->voltage_q_per_x, m->cross_d) +
                      scaled_multiply(m->voltage_q_per_d, m->one_plus_a2) - m->reactance_q_b),
        .c = within(scaled_multiply(m->voltage_q_b, m->iron_current_b)),
        .c_d = within(scaled_multiply(m->voltage_q_b, m->cross_d) +
                      scaled_multiply(m->voltage_q_per_d, m->iron_current_b)),
        .c_dd = within(m->resistance_b + scaled_multiply(m->voltage_q_per_d, m->cross_d)),
    };
    return out;
}

/* At a fixed i_d: a x^2 + b x + c. */
typedef struct {
    int32_t a, b, c;
} power_t;

static power_t power_at(const feasible_set_t *set, int32_t d_b)
{
    const feasible_power_t *p = &set->power;
    const power_t out = {
        .a = p->a,
        .b = p->b + scaled_multiply(p->b_d, d_b),
        .c = p->c + scaled_multiply(p->c_d + scaled_multiply(p->c_dd, d_b), d_b),
    };
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

/* Additional returned power by the angle error: README, Uncertain angle. */
static int32_t uncertain_b(const motor_model_t *m, motor_point_t at)
{
    if (m->constants->hall_angle_b == 0) {
        return 0;
    }
    const int32_t i_q_b = clamped_b(motor_model_i_q_b(m, at));
    const int32_t saliency = m->reactance_d_b - m->reactance_q_b;
    const int32_t u_q_b = clamped_b(m->emf_b + scaled_multiply(saliency, at.d_b));
    const int32_t u_d_b = clamped_b(scaled_multiply(saliency, i_q_b));
    const int32_t across_b = scaled_multiply(u_q_b, at.d_b) - scaled_multiply(u_d_b, i_q_b);
    const int32_t angle_b = scaled_multiply(m->speed_b, m->constants->hall_angle_b);
    return multiply64_b(q_abs(across_b), angle_b);
}

int32_t feasible_drawn_b(const feasible_set_t *set, motor_point_t at)
{
    const power_t p = power_at(set, at.d_b);
    return q_saturate64(power_of_x_b(&p, at.x_b) - uncertain_b(set->model, at));
}

/* i_d at the torque of a point: that of the map, or that of the voltage ellipse at this i_qt if
 * lower. */
static int32_t d_at_b(const feasible_set_t *set, motor_point_t at)
{
    at.d_b = map_d_b(set, motor_model_airgap_b(set->model, at));
    if (voltage_suffices(set, at)) {
        return at.d_b;
    }
    const line_t line = line_from(set->model, at, SCALED_ONE, 0);
    int32_t change_b = 0;
    (void)feasible_ellipse_root(set, &line, 1, &change_b);
    return q_clamp(at.d_b + change_b, q_min(set->weakest_d_b, at.d_b), at.d_b);
}

/* i_d follows the torque; true where it moves so far that the power needs another correction. */
static bool corrected(const feasible_set_t *set, motor_point_t *at)
{
    const int32_t before_b = at->d_b;
    at->d_b = d_at_b(set, *at);
    return q_abs(at->d_b - before_b) > set->model->constants->current_most_b >> FAR_LOG2;
}

int32_t feasible_by_drawn_mNm(const feasible_side_t *side, int32_t power_b)
{
    const motor_model_t *m = side->set->model;
    const int32_t most_b =
        side->sign > 0 ? power_b : q_max(power_b, m->constants->negligible_power_b);
    motor_point_t at = side->cap;
    power_t p = power_at(side->set, at.d_b);
    if (power_of_x_b(&p, at.x_b) <= most_b) {
        return FEASIBLE_UNBOUNDED;
    }
    bool last = false;
    for (int pass = 0;; pass++) {
        const int32_t left = coefficient((int64_t)most_b - p.c);
        const int32_t sum = p.b + scaled_root(square(p.b) + 4 * (int64_t)p.a * left);
        if (side->sign > 0) {
            at.x_b = left <= 0 ? 0 : scaled_ratio(2 * left, q_max(sum, 1));
        } else {
            at.x_b = -scaled_ratio(sum, q_max(2 * p.a, 1));
        }
        at.x_b = clamped_b(at.x_b);
        if (last) {
            return feasible_magnitude_mNm(side, motor_model_airgap_b(m, at));
        }
        last = !corrected(side->set, &at) || pass == CORRECTIONS - 1;
        p = power_at(side->set, at.d_b);
    }
}

int32_t feasible_by_returned_mNm(const feasible_side_t *side, int32_t power_b)
{
    const motor_model_t *m = side->set->model;
    motor_point_t at = side->cap;
    power_t p = power_at(side->set, at.d_b);
    const int64_t vertex_b = 2 * (((int64_t)p.a * at.x_b) >> 24) + p.b;
    if (vertex_b >= 0 && power_of_x_b(&p, at.x_b) - uncertain_b(m, at) >= -(int64_t)power_b) {
        return FEASIBLE_UNBOUNDED; /* the power returned up to the cap is below the bound */
    }
    bool last = false;
    for (int pass = 0;; pass++) {
        const int32_t left = coefficient((int64_t)p.c + power_b - uncertain_b(m, at));
        const int64_t under_root = square(p.b) - 4 * (int64_t)p.a * left;
        const int32_t sum = q_max(p.b + scaled_root(under_root), 1);
        at.x_b = left <= 0 ? 0 : -clamped_b(scaled_ratio(2 * left, sum));
        if (last) {
            const int32_t least =
                coefficient((int64_t)p.c + q_max(power_b, m->constants->negligible_power_b));
            return p.b <= 0 || under_root < 0 || square(p.b) < 4 * (int64_t)p.a * least
                       ? FEASIBLE_UNBOUNDED
                       : feasible_magnitude_mNm(side, motor_model_airgap_b(m, at));
        }
        last = !corrected(side->set, &at) || pass == CORRECTIONS - 1;
        p = power_at(side->set, at.d_b);
    }
}

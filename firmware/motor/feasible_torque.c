/* SPDX-License-Identifier: Apache-2.0 */
#include "motor/feasible_torque.h"

#include "core/fade.h"
#include "feasible_ellipse.h"
#include "motor/flux_map.h"

enum {
    TANGENTS = 2,      /* to the torque's hyperbola */
    MOST_TANGENTS = 5, /* where the hyperbola bends most */
    VOLTAGE_STEPS = 2, /* along the ellipse, where i_d is that of the map */
    MOST_TORQUE_b = 1 << 29
};

/* Magnitude of the shaft torque on a side, of an airgap torque along the rotation. */
int32_t feasible_magnitude_mNm(const feasible_side_t *side, int32_t airgap_b)
{
    const motor_model_t *m = side->set->model;
    const int32_t shaft_b = side->sign * (airgap_b - m->friction_b);
    return scaled_shift(q_max(shaft_b, 0), -m->constants->torque_shift);
}

/* ---- the voltage ellipse ---- */

bool feasible_ellipse_root(const feasible_set_t *set, const line_t *line, int32_t sign,
                           int32_t *t_b)
{
    const int32_t half = coefficient_of_products((int64_t)line->slope_d * line->u_d +
                                                 (int64_t)line->slope_q * line->u_q);
    const int32_t squared =
        q_max(coefficient_of_products(square(line->slope_d) + square(line->slope_q)), 1);
    const int32_t excess =
        coefficient_of_products(square(line->u_d) + square(line->u_q) - set->voltage_squared);
    const int64_t under_root = square(half) - (int64_t)squared * excess;
    const int32_t distance = sign * scaled_root(under_root);
    *t_b = clamped_b(scaled_ratio(distance - half, squared));
    return under_root >= 0;
}

bool feasible_holds(const feasible_set_t *set, motor_point_t at)
{
    const motor_model_t *m = set->model;
    return square(motor_model_u_d_b(m, at)) + square(motor_model_u_q_b(m, at)) <=
           feasible_most_squared(set);
}

/* Derivative of the map's i_d with respect to the airgap torque, 24 fraction bits. */
static int32_t map_d_per_torque(const feasible_set_t *set, int32_t airgap_b)
{
    const motor_constants_t *k = set->model->constants;
    const int32_t rise_mA =
        loss_maps_row_rise_mA(&set->row, scaled_shift(airgap_b, -k->torque_shift));
    const int32_t shift = k->current_shift + 24 - k->torque_shift - set->row.step_log2;
    return within(scaled_shift(rise_mA, q_min(shift, 30)));
}

/* The point of the same torque at which the voltage suffices: along the tangent of the torque's
 * hyperbola to the ellipse, then back to the torque. */
static motor_point_t weakened(const feasible_set_t *set, int32_t airgap_b, motor_point_t at,
                              int tangents)
{
    const motor_model_t *m = set->model;
    const int32_t highest_b = at.d_b;
    const int32_t lowest_b = q_min(set->weakest_d_b, highest_b);
    const int passes = m->saliency_b != 0 ? tangents : 1;
    for (int pass = 0; pass < passes; pass++) {
        if (pass >= TANGENTS && feasible_holds(set, at)) {
            break;
        }
        const line_t line = line_from(m, at, SCALED_ONE, motor_model_x_per_d(m, at));
        int32_t change_b = 0;
        (void)feasible_ellipse_root(set, &line, 1, &change_b);
        at.d_b = q_clamp(at.d_b + change_b, lowest_b, highest_b);
        at.x_b = motor_model_x_of_airgap_b(m, airgap_b, at.d_b);
    }
    return at;
}

/* The far end of the ellipse at an i_d; false if the voltage suffices for no current. */
static bool ellipse_end(const feasible_side_t *side, motor_point_t *at)
{
    at->x_b = 0;
    const line_t line = line_from(side->set->model, *at, 0, SCALED_ONE);
    return feasible_ellipse_root(side->set, &line, side->sign, &at->x_b);
}

/* One step of Newton's method, from a point of the ellipse to the one at which i_d is that of the
 * map: there the map is a straight line over the torque, and the torque is taken as one over the
 * currents. False where this line does not meet the ellipse. */
static bool towards_map(const feasible_side_t *side, motor_point_t *at, int32_t error_b,
                        int32_t d_per_torque)
{
    const motor_model_t *m = side->set->model;
    const int32_t by_torque = within(multiply64_b(d_per_torque, motor_model_airgap_per_d(m, *at)));
    const int32_t inverse = scaled_ratio(SCALED_ONE, q_max(SCALED_ONE - by_torque, SCALED_ONE / 4));
    const int32_t change = within(multiply64_b(d_per_torque, motor_model_airgap_per_x(m, *at)));
    const int32_t d_per_x = within(scaled_multiply(inverse, change));
    at->d_b = clamped_b(at->d_b + scaled_multiply(inverse, error_b));
    const line_t line = line_from(m, *at, d_per_x, SCALED_ONE);
    int32_t change_b = 0;
    const bool meets = feasible_ellipse_root(side->set, &line, side->sign, &change_b);
    at->d_b = clamped_b(at->d_b + scaled_multiply(d_per_x, change_b));
    at->x_b = clamped_b(at->x_b + change_b);
    return meets;
}

/* The end of the ellipse at the lowest i_d of field weakening, or at the map's where that is lower;
 * false if the voltage suffices for no current. */
static bool voltage_end(const feasible_side_t *side, motor_point_t *end, int32_t *airgap_b)
{
    const feasible_set_t *set = side->set;
    const motor_model_t *m = set->model;
    end->d_b = set->weakest_d_b;
    bool exists = ellipse_end(side, end);
    *airgap_b = motor_model_airgap_b(m, *end);
    for (int pass = 0; exists && pass < VOLTAGE_STEPS; pass++) {
        const int32_t map_b = map_d_b(set, *airgap_b);
        const int32_t wanted_b = q_clamp(map_b, -m->constants->current_most_b, set->weakest_d_b);
        const int32_t error_b = wanted_b - end->d_b;
        if (q_abs(error_b) < ELLIPSE_SMALL_b) {
            break;
        }
        const int32_t slope = map_b == wanted_b ? map_d_per_torque(set, *airgap_b) : 0;
        if (!towards_map(side, end, error_b, slope)) {
            end->d_b = wanted_b;
            exists = ellipse_end(side, end);
        }
        *airgap_b = motor_model_airgap_b(m, *end);
    }
    return exists;
}

/* i_d of maximum torque per voltage, DERIVATIONS.md, Feasible torque; resistance and iron loss not
 * counted. Not needed, and then the most negative number, where it lies beyond the current circle.
 */
static int32_t voltage_best_d_b(const motor_model_t *m, int32_t voltage_b)
{
    const int32_t l_d = m->inductance_d_b;
    const int32_t beyond_b = scaled_multiply(l_d, circle_b(m)) - m->flux_b;
    if (m->saliency_b <= 0 && beyond_b <= 0) {
        return INT32_MIN;
    }
    const int32_t flux_b =
        q_min(scaled_ratio(voltage_b, q_max(m->speed_b, 1)), MOTOR_MODEL_MOST_CURRENT_b);
    const int32_t magnet = coefficient_of_products((int64_t)m->flux_b * m->inductance_q_b);
    const int32_t more = coefficient_of_products(square(flux_b) - 2 * square(beyond_b));
    if (m->saliency_b < 0 && -(int64_t)m->saliency_b * more > (int64_t)magnet * beyond_b) {
        return INT32_MIN;
    }
    const int32_t reluctance = coefficient_of_products((int64_t)m->saliency_b * flux_b);
    const int32_t sum = magnet + scaled_root(square(magnet) + 8 * square(reluctance));
    const int32_t d_flux_b = scaled_multiply(2 * flux_b, scaled_ratio(reluctance, q_max(sum, 1)));
    return scaled_ratio(clamped_b(d_flux_b) - m->flux_b, q_max(l_d, 1));
}

/* Down to maximum torque per voltage on the current circle; with a hot winding the part beyond
 * current_loop.field_weakening_current fades out. */
static int32_t weakest_d_b(const motor_model_t *m, int32_t voltage_b)
{
    const config_motor_t *motor = &m->config->motor;
    const int32_t always_b = q_min(m->constants->weakening_most_b, circle_b(m));
    const int32_t share_q15 =
        fade_q15(m->winding_temperature_cC, motor->derate_winding_temperature_cC,
                 motor->max_winding_temperature_cC);
    const int32_t more_b = scaled_multiply(circle_b(m) - always_b, share_q15 * 512);
    return q_max(-(always_b + more_b), q_min(voltage_best_d_b(m, voltage_b), 0));
}

feasible_set_t feasible_set_at(const motor_model_t *model, int32_t phase_voltage_mV)
{
    const int32_t voltage_b =
        clamped_b(scaled_shift(q_max(phase_voltage_mV, 0), model->constants->voltage_shift));
    const feasible_set_t out = {
        .model = model,
        .power = feasible_power_of(model),
        .row = loss_maps_row_at(model->config, model->speed_mrad_s, model->winding_temperature_cC),
        .voltage_squared = square(voltage_b),
        .weakest_d_b = weakest_d_b(model, voltage_b),
    };
    return out;
}

void feasible_set_around(feasible_set_t *set, motor_model_t *model, motor_current_t around)
{
    if (flux_map_present(model->config)) {
        const int32_t voltage_b = scaled_root(set->voltage_squared);
        motor_model_move(model, around);
        set->power = feasible_power_of(model);
        set->weakest_d_b = weakest_d_b(model, voltage_b);
    }
}

/* ---- points ---- */

static int32_t cap_airgap_b(const motor_model_t *m, int32_t sign, int32_t cap_mNm)
{
    const int32_t shaft_b = scaled_shift(cap_mNm, m->constants->torque_shift);
    return sign * q_min(shaft_b, MOST_TORQUE_b) + m->friction_b;
}

static motor_point_t with_map(const feasible_set_t *set, int32_t airgap_b)
{
    const int32_t map_b = map_d_b(set, airgap_b);
    const motor_point_t out = {.d_b = map_b,
                               .x_b = motor_model_x_of_airgap_b(set->model, airgap_b, map_b)};
    return out;
}

motor_point_t feasible_point(const feasible_set_t *set, int32_t airgap_b)
{
    const motor_model_t *m = set->model;
    motor_point_t at = with_map(set, airgap_b);
    if (square(at.d_b) + square(motor_model_i_q_b(m, at)) > square(m->constants->current_most_b)) {
        at.d_b = feasible_circle_d_b(set, airgap_b, at.d_b);
        at.x_b = motor_model_x_of_airgap_b(m, airgap_b, at.d_b);
    }
    return voltage_suffices(set, at) ? at : weakened(set, airgap_b, at, MOST_TANGENTS);
}

feasible_side_t feasible_side_at(const feasible_set_t *set, side_t sign, int32_t cap_mNm)
{
    const motor_model_t *m = set->model;
    const motor_point_t cap = with_map(set, cap_airgap_b(m, (int32_t)sign, cap_mNm));
    const feasible_side_t out = {.set = set,
                                 .sign = (int32_t)sign,
                                 .cap_mNm = cap_mNm,
                                 .cap = cap,
                                 .cap_has_voltage = voltage_suffices(set, cap)};
    return out;
}

/* First iteration: the point only tells whether other bounds are needed. */
void feasible_weaken_cap(feasible_side_t *side)
{
    const feasible_set_t *set = side->set;
    const int32_t airgap_b = cap_airgap_b(set->model, side->sign, side->cap_mNm);
    side->cap = weakened(set, airgap_b, side->cap, 1);
    side->cap_has_voltage = voltage_suffices(set, side->cap);
}

int32_t feasible_by_voltage_mNm(feasible_side_t *side)
{
    if (side->cap_has_voltage) {
        return FEASIBLE_UNBOUNDED;
    }
    motor_point_t end;
    int32_t end_b = 0;
    const bool exists = voltage_end(side, &end, &end_b);
    const int32_t end_mNm = exists ? feasible_magnitude_mNm(side, end_b) : 0;
    end.x_b = exists ? end.x_b : 0;
    if (end_mNm >= side->cap_mNm) {
        feasible_weaken_cap(side);
        if (side->cap_has_voltage) {
            return FEASIBLE_UNBOUNDED;
        }
    } else {
        side->cap = end;
        side->cap_mNm = end_mNm;
    }
    side->cap_has_voltage = true;
    return end_mNm;
}

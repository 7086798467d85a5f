/* SPDX-License-Identifier: Apache-2.0 */
#include "torque/feasible_torque.h"

#include "core/q15.h"
#include "torque/limit.h"

enum {
    CORRECTIONS = 3,   /* of i_d, for a power; after the first only after a large change */
    FAR_LOG2 = 5,      /* 3 % of the phase current */
    NEWTON_STEPS = 3,  /* along the current circle */
    TANGENTS = 2,      /* to the torque's hyperbola */
    VOLTAGE_STEPS = 2, /* along the ellipse, where i_d is that of the map */
    CIRCLE_PASSES = 3,
    SMALL_b = 1 << 8,
    CIRCLE_RESERVE_LOG2 = 8, /* 0.4 % */
    HOLDS_LOG2 = 4,          /* 3 % of the voltage: less than the fast loop's own reserve */
    MOST_TORQUE_b = 1 << 29,
    MOST_COEFFICIENT = 1 << 29,
    MOST_b = MOTOR_MODEL_MOST_CURRENT_b
};

static int32_t clamped_b(int32_t x)
{
    return q_limit(x, MOST_b);
}

static int32_t multiply64_b(int64_t a, int64_t b)
{
    return q_saturate64((a * b) >> 24);
}

static int32_t within(int32_t x)
{
    return q_limit(x, 1 << 26);
}

/* Of a quadratic equation: keeps the products under its root below 2^62. */
static int32_t coefficient(int64_t x)
{
    return q_limit(q_saturate64(x), MOST_COEFFICIENT);
}

static int64_t square(int32_t x)
{
    return (int64_t)x * x;
}

/* Magnitude of the shaft torque on a side, of an airgap torque along the rotation. */
int32_t feasible_magnitude_mNm(const feasible_side_t *side, int32_t airgap_b)
{
    const motor_model_t *m = side->set->model;
    const int32_t shaft_b = side->sign * (airgap_b - m->friction_b);
    return scaled_shift(q_max(shaft_b, 0), -m->constants->torque_shift);
}

/* ---- the voltage ellipse ---- */

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
        .slope_d =
            scaled_multiply(m->resistance_b, d_per_t) - scaled_multiply(m->reactance_q_b, x_per_t),
        .slope_q = scaled_multiply(m->voltage_q_per_d, d_per_t) +
                   scaled_multiply(m->voltage_q_per_x, x_per_t),
    };
    return out;
}

/* The upper (sign 1) or lower (-1) intersection t of the line with the ellipse; without one false
 * and the t of the least voltage. */
static bool ellipse_root(const feasible_set_t *set, const line_t *line, int32_t sign, int32_t *t_b)
{
    const int32_t half = coefficient(
        ((int64_t)line->slope_d * line->u_d + (int64_t)line->slope_q * line->u_q) >> 24);
    const int32_t squared =
        q_max(coefficient((square(line->slope_d) + square(line->slope_q)) >> 24), 1);
    const int32_t excess =
        coefficient((square(line->u_d) + square(line->u_q) - set->voltage_squared) >> 24);
    const int64_t under_root = square(half) - (int64_t)squared * excess;
    const int32_t distance = sign * scaled_root(under_root);
    *t_b = clamped_b(scaled_ratio(distance - half, squared));
    return under_root >= 0;
}

static bool voltage_suffices(const feasible_set_t *set, motor_point_t at)
{
    const motor_model_t *m = set->model;
    return square(motor_model_u_d_b(m, at)) + square(motor_model_u_q_b(m, at)) <=
           set->voltage_squared;
}

bool feasible_holds(const feasible_set_t *set, motor_point_t at)
{
    const motor_model_t *m = set->model;
    return square(motor_model_u_d_b(m, at)) + square(motor_model_u_q_b(m, at)) <=
           set->voltage_squared + (set->voltage_squared >> HOLDS_LOG2);
}

static int32_t map_d_b(const feasible_set_t *set, int32_t airgap_b)
{
    const motor_constants_t *k = set->model->constants;
    return motor_model_current_b(
        k, loss_maps_row_d_mA(&set->row, scaled_shift(airgap_b, -k->torque_shift)));
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
    (void)ellipse_root(set, &line, 1, &change_b);
    return q_clamp(at.d_b + change_b, q_min(set->weakest_d_b, at.d_b), at.d_b);
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
        const line_t line = line_from(m, at, SCALED_ONE, motor_model_x_per_d(m, at));
        int32_t change_b = 0;
        (void)ellipse_root(set, &line, 1, &change_b);
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
    return ellipse_root(side->set, &line, side->sign, &at->x_b);
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
    const bool meets = ellipse_root(side->set, &line, side->sign, &change_b);
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
        if (q_abs(error_b) < SMALL_b) {
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

/* ---- the current circle ---- */

/* Below the limit by a reserve for the fast loop's field weakening. */
static int32_t circle_b(const motor_model_t *m)
{
    return m->constants->current_most_b - (m->constants->current_most_b >> CIRCLE_RESERVE_LOG2);
}

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

/* Along the circle from the best i_d down to where the voltage suffices: from the
 * lossless point two steps to the second order. */
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

/* Maximum torque per ampere on the circle: the i_d at which (psi + (L_d - L_q) i_d) i_q is
 * largest. */
static int32_t circle_best_d_b(const motor_model_t *m)
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

/* The i_d on the circle for a torque above the one at the map's i_d, between the map's i_d and that
 * of maximum torque per ampere. Near its maximum the torque is a parabola over i_d. */
static int32_t circle_d_b(const feasible_set_t *set, int32_t airgap_b, int32_t map_d_b)
{
    const motor_model_t *m = set->model;
    const int32_t sign = airgap_b >= 0 ? 1 : -1;
    const int32_t best_b = set->best_d_b;
    const int32_t lowest_b = q_min(q_limit(map_d_b, m->constants->current_most_b), best_b);
    int32_t i_q_b = 0;
    const int32_t most_b = sign * motor_model_airgap_b(m, on_circle(m, sign, best_b, &i_q_b));
    const int32_t missing_b = q_max(most_b - sign * airgap_b, 0);
    int32_t d_b = q_limit(map_d_b, m->constants->current_most_b);
    for (int pass = 0; pass < CIRCLE_PASSES; pass++) {
        const int32_t here_b = sign * motor_model_airgap_b(m, on_circle(m, sign, d_b, &i_q_b));
        const int32_t span_b = most_b - here_b;
        if (span_b < SMALL_b) {
            break;
        }
        const int32_t share = scaled_root((int64_t)scaled_ratio(missing_b, span_b) << 24);
        d_b = q_clamp(best_b + scaled_multiply(q_min(share, 2 * SCALED_ONE), d_b - best_b),
                      lowest_b, best_b);
    }
    return d_b;
}

/* ---- points ---- */

/* Coefficients below 2^26 and an i_d below 2^25: a sum of two products is below 2^29. */
static feasible_power_t power_of(const motor_model_t *m)
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

/* i_d of maximum torque per voltage, README, Feasible torque; resistance and iron loss not counted.
 * Not needed, and then the most negative number, where it lies beyond the current circle. */
static int32_t voltage_best_d_b(const motor_model_t *m, int32_t voltage_b)
{
    const int32_t l_d = m->constants->inductance_d_b;
    if (m->saliency_b <= 0 && scaled_multiply(l_d, circle_b(m)) <= m->flux_b) {
        return INT32_MIN;
    }
    const int32_t flux_b = q_min(scaled_ratio(voltage_b, q_max(m->speed_b, 1)), MOST_b);
    const int32_t magnet = coefficient(((int64_t)m->flux_b * m->constants->inductance_q_b) >> 24);
    const int32_t reluctance = coefficient(((int64_t)m->saliency_b * flux_b) >> 24);
    const int32_t sum = magnet + scaled_root(square(magnet) + 8 * square(reluctance));
    const int32_t d_flux_b =
        scaled_multiply(2 * flux_b, q_limit(scaled_ratio(reluctance, q_max(sum, 1)), SCALED_ONE));
    return scaled_ratio(clamped_b(d_flux_b) - m->flux_b, q_max(l_d, 1));
}

/* Down to maximum torque per voltage on the current circle; with a hot winding the part beyond
 * current_loop.field_weakening_current fades out. */
static int32_t weakest_d_b(const motor_model_t *m, int32_t voltage_b)
{
    const config_motor_t *motor = &m->config->motor;
    const int32_t always_b = q_min(m->constants->weakening_most_b, circle_b(m));
    const int32_t share_q15 =
        limit_fade_q15(m->winding_temperature_cC, motor->derate_winding_temperature_cC,
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
        .power = power_of(model),
        .row = loss_maps_row_at(model->config, model->speed_mrad_s, model->winding_temperature_cC),
        .voltage_squared = square(voltage_b),
        .weakest_d_b = weakest_d_b(model, voltage_b),
        .best_d_b = circle_best_d_b(model),
    };
    return out;
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
        at.d_b = circle_d_b(set, airgap_b, at.d_b);
        at.x_b = motor_model_x_of_airgap_b(m, airgap_b, at.d_b);
    }
    return voltage_suffices(set, at) ? at : weakened(set, airgap_b, at, TANGENTS);
}

feasible_side_t feasible_side_at(const feasible_set_t *set, side_t sign, int32_t cap_mNm)
{
    const motor_model_t *m = set->model;
    const int32_t shaft_b = scaled_shift(cap_mNm, m->constants->torque_shift);
    const int32_t airgap_b = (int32_t)sign * q_min(shaft_b, MOST_TORQUE_b) + m->friction_b;
    feasible_side_t out = {.set = set,
                           .sign = (int32_t)sign,
                           .cap = with_map(set, airgap_b),
                           .voltage_mNm = FEASIBLE_UNBOUNDED,
                           .cap_has_voltage = true};
    if (voltage_suffices(set, out.cap)) {
        return out;
    }
    motor_point_t end;
    int32_t end_b = 0;
    const bool exists = voltage_end(&out, &end, &end_b);
    if (exists && out.sign * (end_b - airgap_b) >= 0) {
        out.cap = weakened(set, airgap_b, out.cap, 1); /* first iteration */
        out.cap_has_voltage = voltage_suffices(set, out.cap);
    } else {
        out.cap = end;
        out.cap_has_voltage = false;
    }
    if (!out.cap_has_voltage) {
        out.voltage_mNm = exists ? feasible_magnitude_mNm(&out, end_b) : 0;
    }
    return out;
}

/* ---- battery power ---- */

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

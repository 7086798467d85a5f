/* SPDX-License-Identifier: Apache-2.0 */
#include "motor/loss_braking.h"

#include <stdbool.h>

#include "core/q15.h"

enum {
    CIRCLE_PASSES = 2,       /* Newton's method along the circle; the slope is that of the EMF */
    SETPOINT_PASSES = 2,     /* the loss of the bridge follows i_d */
    UNCERTAIN_PASSES = 3,    /* and what an uncertain angle may return */
    CIRCLE_RESERVE_LOG2 = 8, /* as the other bounds keep it */
    /* Of hall sensors: electrical speed of a sector in 32 ms, 2^15 mrad/s, and eight times it. */
    SPEED_LOG2 = 5,
    WAITING_SPEED = 1 << 10,
    EXTRAPOLATING_SPEED = 8 * WAITING_SPEED,
    PER_Q_LOG2 = 8
};

static int64_t square(int32_t x)
{
    return (int64_t)x * x;
}

loss_braking_t loss_braking_at(const motor_model_t *model, feasible_returned_t returned,
                               int32_t share_q15)
{
    const motor_constants_t *k = model->constants;
    const int32_t whole_b = k->current_most_b - (k->current_most_b >> CIRCLE_RESERVE_LOG2);
    const int32_t derated_b =
        share_q15 < Q15_ONE ? (int32_t)(((int64_t)whole_b * share_q15) >> 15) : whole_b;
    const loss_braking_t out = {
        .current_b = model->config->brake.loss_braking != 0 ? derated_b : 0,
        .returned = returned,
        .by_map_mNm = FEASIBLE_UNBOUNDED,
    };
    return out;
}

/* The i_d on the circle beside an i_q, <= 0. */
static int32_t on_circle_d_b(int32_t current_b, int32_t i_q_b)
{
    return -scaled_root(square(current_b) - square(i_q_b));
}

/* The lowest i_d beside an i_q: beside hall sensors' angle none may drive. DERIVATIONS.md,
 * Loss braking. */
static int32_t lowest_d_b(const motor_model_t *m, int32_t current_b, int32_t i_q_b)
{
    const int32_t circle_b = on_circle_d_b(current_b, i_q_b);
    if (m->constants->hall_angle_b == 0) {
        return circle_b;
    }
    const int32_t speed = scaled_shift(m->speed_b, -m->constants->speed_shift - SPEED_LOG2);
    const uint32_t times = (uint32_t)q_clamp(speed, WAITING_SPEED, EXTRAPOLATING_SPEED);
    const int32_t per_q_q8 = (int32_t)(times * times * 7U >> 14);
    return q_max(circle_b, q_saturate64((int64_t)q_min(i_q_b, 0) * per_q_q8 >> PER_Q_LOG2));
}

int32_t loss_braking_torque_mNm(const feasible_side_t *side, loss_braking_t *losses,
                                int32_t by_map_mNm)
{
    const feasible_set_t *set = side->set;
    const motor_model_t *m = set->model;
    losses->by_map_mNm = by_map_mNm;
    losses->torque_mNm = 0;
    if (by_map_mNm == FEASIBLE_UNBOUNDED) {
        return by_map_mNm;
    }
    const int32_t copper_b = (int32_t)((square(losses->current_b) >> 24) * m->resistance_b >> 24);
    const int32_t loss_b = copper_b + motor_model_bridge_loss_b(m->constants, losses->current_b);
    if (losses->returned.power_b > loss_b) {
        return by_map_mNm;
    }
    /* What the motor draws has been measured, with any angle. */
    const feasible_returned_t none = {
        .power_b = q_min(losses->returned.power_b, 0) + losses->returned.drawn_b,
        .margin_b = INT32_MAX,
    };
    motor_point_t at = {.d_b = -losses->current_b, .x_b = 0};
    for (int pass = 0; pass < CIRCLE_PASSES; pass++) {
        at.d_b = on_circle_d_b(losses->current_b, motor_model_i_q_b(m, at));
        const int32_t slope_b =
            m->emf_b + scaled_multiply(m->reactance_d_b - m->reactance_q_b, at.d_b);
        const int32_t change_b = scaled_ratio(feasible_excess_b(set, at, none), q_max(slope_b, 1));
        at.x_b = q_clamp(at.x_b - change_b, -losses->current_b, 0);
    }
    losses->at = at;
    losses->torque_mNm = feasible_magnitude_mNm(side, motor_model_airgap_b(m, at));
    return q_max(by_map_mNm, losses->torque_mNm);
}

current_setpoint_t loss_braking_setpoint(const feasible_set_t *set, const loss_braking_t *losses,
                                         int32_t torque_mNm, current_setpoint_t current)
{
    const motor_model_t *m = set->model;
    const motor_constants_t *k = m->constants;
    if (losses->current_b == 0 || q_abs(torque_mNm) <= losses->by_map_mNm) {
        return current;
    }
    const int32_t airgap_b = motor_model_airgap_of_shaft_b(m, torque_mNm);
    if (airgap_b >= 0) {
        return current;
    }
    const motor_current_t flowing = {.d_mA = current.i_d_mA, .q_mA = current.i_q_mA};
    motor_point_t at = motor_model_point(m, flowing);
    const int32_t highest_b = at.d_b;
    const int32_t twice_q = q_max(2 * set->power.c_dd, 1);
    feasible_returned_t returned = losses->returned;
    returned.power_b += returned.drawn_b;
    const int passes = k->hall_angle_b != 0 ? UNCERTAIN_PASSES : SETPOINT_PASSES;
    for (int pass = 0; pass < passes; pass++) {
        const int32_t excess_b = feasible_excess_b(set, at, returned);
        if (pass == 0 && excess_b >= 0) {
            return current;
        }
        /* q d^2 + e d + c returns what the battery takes: the root below the map's i_d. */
        const int32_t e = set->power.c_d + scaled_multiply(set->power.b_d, at.x_b) +
                          scaled_multiply(twice_q, at.d_b);
        const int64_t under_root = square(e) - 2 * (int64_t)twice_q * excess_b;
        at.d_b -= scaled_ratio(q_add(e, scaled_root(under_root)), twice_q);
        at.d_b = q_clamp(
            at.d_b, q_min(lowest_d_b(m, losses->current_b, motor_model_i_q_b(m, at)), highest_b),
            highest_b);
        at.x_b = motor_model_x_of_airgap_b(m, airgap_b, at.d_b);
    }
    const int32_t most_mA = m->config->motor.max_phase_current_mA;
    current.i_d_mA = q_limit(motor_model_current_mA(k, at.d_b), most_mA);
    const int32_t left_mA =
        scaled_root((int64_t)most_mA * most_mA - (int64_t)current.i_d_mA * current.i_d_mA);
    const int32_t along_mA = q_limit(motor_model_current_mA(k, motor_model_i_q_b(m, at)), left_mA);
    current.i_q_mA = m->speed_mrad_s >= 0 ? along_mA : -along_mA;
    return current;
}

/* SPDX-License-Identifier: Apache-2.0 */
#include "motor/current_setpoint.h"

#include "core/q15.h"

/* i_d with the trim, which lowers it to -weakest at most. Along the current circle from zero torque
 * to braking the voltage falls up to the angle atan(R/(w L_q)): a braking current up to there is
 * not given up for a lower i_d, which could hold the voltage no better. */
static int32_t trimmed_d_mA(const feasible_set_t *set, motor_point_t at, int32_t trim_mA)
{
    const motor_model_t *model = set->model;
    const motor_constants_t *k = model->constants;
    const int64_t most_mA = model->config->motor.max_phase_current_mA;
    const int32_t wanted_mA = motor_model_current_mA(k, at.d_b);
    const int32_t weakest_mA = motor_model_current_mA(k, set->weakest_d_b);
    const int32_t d_mA = q_max(wanted_mA + trim_mA, q_min(wanted_mA, weakest_mA));
    const int32_t braking_mA = -motor_model_current_mA(k, motor_model_i_q_b(model, at));
    const int64_t left_squared = most_mA * most_mA - (int64_t)braking_mA * braking_mA;
    if (braking_mA <= 0 || (int64_t)d_mA * d_mA <= left_squared) {
        return d_mA;
    }
    const int32_t ratio =
        scaled_ratio(model->resistance_b, q_max(model->reactance_q_b, model->resistance_b + 1));
    const int64_t q_mA = q_min(braking_mA, scaled_multiply((int32_t)most_mA, ratio));
    const int32_t circle_mA = -scaled_root(most_mA * most_mA - q_mA * q_mA);
    return q_max(d_mA, q_min(wanted_mA, circle_mA));
}

current_setpoint_t current_setpoint_step(const feasible_set_t *set, int32_t torque_mNm,
                                         int32_t i_d_weakening_mA)
{
    const motor_model_t *model = set->model;
    const motor_constants_t *k = model->constants;
    const int32_t most_mA = model->config->motor.max_phase_current_mA;
    const int32_t trim_mA =
        q_clamp(i_d_weakening_mA, -motor_model_current_mA(k, k->weakening_most_b), 0);
    const int32_t airgap_b = motor_model_airgap_of_shaft_b(model, torque_mNm);
    motor_point_t at = feasible_point(set, airgap_b);
    const bool has_voltage = feasible_holds(set, at);
    const bool forced = !has_voltage && feasible_forced(set, &at);
    const int32_t wanted_mA = motor_model_current_mA(k, at.d_b);
    const bool trims = trim_mA < 0 && !forced;
    const int32_t d_mA = q_limit(trims ? trimmed_d_mA(set, at, trim_mA) : wanted_mA, most_mA);
    if (d_mA != wanted_mA) {
        at.d_b = motor_model_current_b(k, d_mA);
        at.x_b = motor_model_x_of_airgap_b(model, airgap_b, at.d_b);
    }
    const int32_t along_mA = motor_model_current_mA(k, motor_model_i_q_b(model, at));
    const int32_t q_mA = model->speed_mrad_s >= 0 ? along_mA : -along_mA;
    const int64_t left_squared = (int64_t)most_mA * most_mA - (int64_t)d_mA * d_mA;
    const bool inside = (int64_t)q_mA * q_mA <= left_squared;
    const int32_t left_mA = inside ? q_abs(q_mA) : scaled_root(left_squared);
    const bool limited = q_abs(q_mA) > left_mA + most_mA / 256;
    if (limited) {
        const motor_current_t made = {.d_mA = d_mA, .q_mA = q_limit(q_mA, left_mA)};
        at = motor_model_point(model, made);
    }
    const current_setpoint_t out = {
        .i_d_mA = q_limit(d_mA - trim_mA, most_mA),
        .i_q_mA = q_limit(q_mA, left_mA),
        .limited = limited,
        .feasible = (has_voltage && d_mA == wanted_mA && !limited) || feasible_holds(set, at),
        .forced_mNm = forced ? q_abs(motor_model_torque_mNm(model, at)) : 0,
    };
    return out;
}

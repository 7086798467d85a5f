/* SPDX-License-Identifier: Apache-2.0 */
#include "motor/observer_error.h"

#include "core/angle.h"
#include "core/q15.h"
#include "motor/flux_map.h"

enum {
    CONSTANT_Q15 = 16384, /* 50 % */
    MAP_Q15 = 3277,       /* 10 % */
    SINE_Q24 = 4342263,   /* of 15 degrees */
    COSINE_Q24 = 16205546,
    SINE_SQUARED_Q24 = 1123858
};

static int32_t tolerance_q15(const config_t *config)
{
    return flux_map_present(config) ? MAP_Q15 : CONSTANT_Q15;
}

/* Active flux psi_d - psi_q i_d/i_q along the observer's angle and the error of psi_q across it,
 * both times i_q. */
bool observer_error_explains(const config_t *config, motor_current_t i, int32_t angle_turn)
{
    const flux_map_point_t at = flux_map_at(config, i.d_mA, i.q_mA);
    const int64_t active = (int64_t)at.d_nWb * i.q_mA - (int64_t)at.q_nWb * i.d_mA;
    const int64_t wrong = (((int64_t)at.q_nWb * tolerance_q15(config)) >> 15) * i.q_mA;
    const int64_t along = active < 0 ? -active : active;
    const int64_t across = wrong < 0 ? -wrong : wrong;
    const sincos_t angle = angle_sincos((uint16_t)angle_turn);
    return (along >> 16) * angle.sin < (across >> 16) * angle.cos;
}

/* The largest i_qt beside an i_d, >= 0. */
static int32_t most_x_b(const motor_model_t *m, int32_t d_b)
{
    const int32_t wrong_b = q15_product(m->inductance_q_b, tolerance_q15(m->config));
    const int32_t least_b =
        m->saliency_b + wrong_b; /* L_d - L_q of the least and the largest L_q */
    const int32_t most_b = m->saliency_b - wrong_b;
    const int32_t turned_b = q_max(q_max(-least_b, most_b), 0);
    const int32_t by_d_b = scaled_multiply(COSINE_Q24, d_b < 0 ? least_b : most_b);
    const int32_t active_b = q_max(m->flux_b + scaled_multiply(by_d_b, d_b), 0);
    const int32_t by_x_b = wrong_b + scaled_multiply(SINE_SQUARED_Q24, turned_b);
    return q_min(scaled_ratio(scaled_multiply(SINE_Q24, active_b), q_max(by_x_b, 1)),
                 MOTOR_MODEL_MOST_CURRENT_b);
}

int32_t observer_error_torque_mNm(const feasible_side_t *side)
{
    const motor_model_t *m = side->set->model;
    motor_point_t at = {.d_b = 0, .x_b = side->sign * most_x_b(m, 0)};
    const int32_t without_d_b = motor_model_airgap_b(m, at);
    at.d_b = feasible_magnitude_mNm(side, without_d_b) < side->cap_mNm
                 ? feasible_point(side->set, without_d_b).d_b
                 : side->cap.d_b;
    at.x_b = side->sign * most_x_b(m, at.d_b);
    return feasible_magnitude_mNm(side, motor_model_airgap_b(m, at));
}

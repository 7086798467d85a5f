/* SPDX-License-Identifier: Apache-2.0 */
#include "motor/torque_uncertainty.h"

#include "core/q15.h"
#include "core/sqrt3.h"

/* Of what a limit changes of flux times current. Both are below 2^30 and 2^15. */
static int64_t square(int32_t product_b, int32_t limit_q15)
{
    const int32_t change_b = (int32_t)(((int64_t)product_b * limit_q15) >> 15);
    return (int64_t)change_b * change_b;
}

/* All terms are torques over 3/2 p. */
int32_t torque_uncertainty_mNm(const motor_model_t *model, motor_point_t at)
{
    const motor_model_t *m = model;
    const motor_constants_t *k = m->constants;
    const config_tolerance_t *limit = &m->config->tolerance;
    const int32_t d_b = q_saturate26(at.d_b + scaled_multiply(m->cross_q, at.x_b));
    const int32_t d_x_b = scaled_multiply(d_b, at.x_b);
    const int32_t reluctance_b = q_saturate27(scaled_multiply(m->saliency_b, d_b));
    const int32_t across_b = q_saturate27(scaled_multiply(m->saliency_b, at.x_b));
    const int32_t active_b = q_saturate27(m->flux_b + reluctance_b);
    const int32_t lost_b = q_saturate26(m->iron_current_b);
    const int32_t iron_b = q_saturate26(motor_model_i_q_b(m, at) - at.x_b);
    const int64_t sum =
        square(scaled_dot(m->flux_b, at.x_b, -active_b, lost_b), limit->magnet_flux_q15) +
        square(scaled_multiply(m->inductance_d_b, d_x_b), limit->inductance_q15) +
        square(scaled_multiply(m->inductance_q_b, d_x_b), limit->inductance_q15) +
        square(scaled_dot(active_b, at.x_b + lost_b, reluctance_b, at.x_b),
               limit->current_gain_q15) +
        square(scaled_dot(active_b, d_b, -across_b, at.x_b), limit->rotor_angle_rad_q15) +
        square(scaled_dot(active_b, iron_b, m->friction_b, k->torque_inverse_q24), limit->drag_q15);
    const int32_t standard_b = q15_product(scaled_root(sum), INVERSE_SQRT3_Q15);
    return scaled_shift(scaled_multiply(standard_b, k->torque_factor_q24), -k->torque_shift);
}

/* SPDX-License-Identifier: Apache-2.0 */
/*
 * current_controller.h: PI current control in the rotor frame, once per PWM period.
 *
 *     u_d = PI(i_d* - i_d) - w L_q i_q            u_q = PI(i_q* - i_q) + w L_d i_d + w psi
 *
 * Voltages are in modulation units: the voltage limit is the unit circle. The d axis has priority
 * (field weakening needs it); q gets the remaining voltage. Both integrators are updated with the
 * applied voltage. Gains for the present bus voltage and speed come from tuning.h.
 */
#ifndef FOC_CURRENT_CONTROLLER_H
#define FOC_CURRENT_CONTROLLER_H

#include <stdint.h>

#include "core/circle.h"
#include "core/frames.h"
#include "core/pi.h"
#include "core/q15.h"
#include "foc/foc.h"

enum { CURRENT_CONTROLLER_D_LIMIT_Q15 = 32256 /* 98 % of the circle: leaves 18 % for q */ };

/* Bridge off. */
static inline void current_controller_reset(current_controller_t *state)
{
    state->d.integrator_q30 = 0;
    state->q.integrator_q30 = 0;
}

/* One period. reference: inside the unit circle; i: |i| <= 1.53. */
Q_TARGET_INLINE void current_controller_step(current_controller_t *restrict state,
                                             const current_tuning_t *restrict tuning,
                                             dq_t reference, dq_t i, voltage_out_t *restrict out)
{
    const int32_t error_d = q_saturate16(reference.d - i.d);
    const int32_t forward_d_q25 = tuning->forward_d_q25 - tuning->w_l_q_q10 * i.q;
    const int32_t u_d = pi_output_q25(&state->d, &tuning->d, error_d, forward_d_q25) >> 10;
    const int32_t applied_d = q_saturate16(u_d);
    out->unsaturated_d = u_d;
    pi_update(&state->d, &tuning->d, error_d, u_d, applied_d);

    const int32_t error_q = q_saturate16(reference.q - i.q);
    const int32_t forward_q_q25 = tuning->w_l_d_q10 * i.d + tuning->forward_q_q25;
    const int32_t u_q = pi_output_q25(&state->q, &tuning->q, error_q, forward_q_q25) >> 10;
    const int32_t applied_q = q_limit(u_q, circle_other_q15(applied_d));
    out->unsaturated_q = u_q;
    pi_update(&state->q, &tuning->q, error_q, u_q, applied_q);

    out->applied.d = applied_d;
    out->applied.q = applied_q;
}

/*
 * Every fourth period while the voltage is short: reduces the d integrator by what the d axis takes
 * beyond 98 % of the circle, so that 18 % remain for q. Without this reserve a braking current can
 * escape control at high speed (README, d-axis voltage reserve).
 */
static inline void current_controller_keep_reserve(current_controller_t *state,
                                                   const voltage_out_t *last)
{
    const int32_t excess =
        last->unsaturated_d - q_limit(last->unsaturated_d, CURRENT_CONTROLLER_D_LIMIT_Q15);
    /* Both within 31 bits. */
    state->d.integrator_q30 = q_saturate31(state->d.integrator_q30 - q_saturate16(excess) * 32768);
}

#endif

/* SPDX-License-Identifier: Apache-2.0 */
/*
 * current_step.h: the current controller from a sampled current to on-times. Inline twice: in
 * foc_current_step(), and after an examination of the current sensors (sensor_isolation.h), so that
 * a period without one keeps no value across a call.
 */
#ifndef FOC_CURRENT_STEP_H
#define FOC_CURRENT_STEP_H

#include "core/angle.h"
#include "current_controller.h"
#include "current_predictor.h"
#include "modulation.h"
#include "sense.h"
#include "transforms.h"

/* Of state->period the rotor and the reference are inputs, the rest is written. */
Q_TARGET_INLINE void current_step_with(foc_state_t *restrict state,
                                       const sense_out_t *restrict sensed)
{
    foc_current_state_t *const current = &state->current;
    foc_period_t *const period = &state->period;
    period->current_sum_pu = sensed->sum_pu;
    period->i_ab_pu = sensed->i;
    const rotation_t angle = angle_rotation(period->theta_turn);
    const dq16_t i = transforms_park(sensed->i, angle);
    period->i_pu = i;
    current_controller_step(&current->controller, &current->gains, period->i_reference_pu, i,
                            &period->voltage);

    /* The voltage acts in the next period: on average 1.5 periods after the sample. */
    const rotation_t angle_applied = transforms_advance(angle, current->advance);
    const ab_t u = transforms_inverse_park(period->voltage.applied, angle_applied);
    /* Full voltage is 32 768, which a packed pair would turn round. */
    state->observer.u.v = q_pair(q_saturate16(u.alpha), q_saturate16(u.beta));
    const dq16_t predicted = current_predictor_step(&current->predictor);
    const ab_t i_applied = transforms_inverse_park(predicted, angle_applied);
    const abc_t trim = modulation_dead_time(current->slope, i_applied);
    modulation_step(&current->modulation, u, trim, current->on_q16);
}

#endif

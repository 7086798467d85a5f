/* SPDX-License-Identifier: Apache-2.0 */
/*
 * current_predictor.h: the current that will flow while the voltage of this period acts, predicted
 * from the reference and the designed closed-loop response. Free of measurement noise and of the
 * delay of a sample; used by the dead-time compensation (sign of the phase currents) and by the
 * decoupling (delay compensation). Equations: README, Current predictor.
 */
#ifndef FOC_CURRENT_PREDICTOR_H
#define FOC_CURRENT_PREDICTOR_H

#include <stdint.h>

#include "config/config.h"
#include "core/frames.h"
#include "core/q15.h"
#include "foc/state.h"
#include "foc/tuning.h"
#include "reference_prefilter.h"

/* Divides. */
void current_predictor_init(current_predictor_t *predictor, const config_t *config);

/* The reference has changed. settled: mean current once it is reached, inside the unit circle. */
void current_predictor_change(current_predictor_t *predictor, const reference_change_t *change,
                              dq_t settled);

/* Target of the delay compensation: (1 - m) i + m target is the predicted current, given the
 * sampled current i. */
dq_t current_predictor_target(const current_predictor_t *predictor,
                              const reference_change_t *change);

/* Bridge off: zero current. */
void current_predictor_reset(current_predictor_t *predictor);

/* Once per period. Returns the predicted mean current of the period in which the voltage acts, Q15,
 * |.| <= 1.007. */
Q_TARGET_INLINE dq_t current_predictor_step(current_predictor_t *predictor)
{
    const dq_t remaining = predictor->remaining_pu;
    const int32_t lag = predictor->lag_q15;
    const dq_t next = {.d = remaining.d - ((remaining.d * lag) >> 15),
                       .q = remaining.q - ((remaining.q * lag) >> 15)};
    predictor->remaining_pu = next;
    const dq_t out = {.d = predictor->settled_pu.d - remaining.d,
                      .q = predictor->settled_pu.q - remaining.q};
    return out;
}

/*
 * Delay compensation: the decoupling uses (1 - m) i + m target instead of the sampled current i.
 * tuning: from current_tuning(); target: from current_predictor_target(). The sampled current keeps
 * the weight 1 - m, so that a current that does not reach its target adds no other error.
 */
static inline void current_predictor_compensate(current_tuning_t *tuning, int32_t weight_q15,
                                                dq_t target)
{
    const int32_t share_d_q10 = (tuning->w_l_d_q10 * weight_q15) >> 15;
    const int32_t share_q_q10 = (tuning->w_l_q_q10 * weight_q15) >> 15;
    tuning->w_l_d_q10 -= share_d_q10;
    tuning->w_l_q_q10 -= share_q_q10;
    tuning->forward_d_q25 -= share_q_q10 * target.q;
    tuning->forward_q_q25 += share_d_q10 * target.d;
}

#endif

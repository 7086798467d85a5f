/* SPDX-License-Identifier: Apache-2.0 */
/*
 * current_predictor.h: the current that will flow while the voltage of this period acts, predicted
 * from the reference and the designed closed-loop response. Free of measurement noise and of the
 * delay of a sample; used by the dead-time compensation (sign of the phase currents) and by the
 * decoupling (delay compensation). Equations: DERIVATIONS.md, Current predictor.
 */
#ifndef FOC_CURRENT_PREDICTOR_H
#define FOC_CURRENT_PREDICTOR_H

#include <stdint.h>

#include "config/config.h"
#include "core/fast_messages.h"
#include "core/frames.h"
#include "core/q15.h"
#include "foc/state.h"
#include "reference_prefilter.h"

/* Divides. */
void current_predictor_init(current_predictor_t *predictor, const config_t *config);

static inline int32_t current_predictor_share(int32_t share_q15, int32_t change)
{
    return (share_q15 * change) >> 15;
}

/* A settled current moved from `last` to `settled` with a change of the reference by `total`: the
 * remaining change grows by `total`. Result and remaining change stay within 16 bits: at an end of
 * the range a changed sampling correction would take the result up to 200 LSB beyond. */
static inline int32_t current_predictor_moved(int32_t predicted, int32_t last, int32_t settled,
                                              int32_t total)
{
    return q_saturate16(settled - q_saturate16(last - predicted + total));
}

/* The reference has changed. settled: mean current once it is reached, inside the unit circle
 * (1.007). Shares of the first two periods after a change: DERIVATIONS.md, Current predictor. */
static inline void current_predictor_change(current_predictor_t *predictor,
                                            const reference_change_t *change, dq_t settled,
                                            bool in_first_periods)
{
    const dq_t last = dq_of(predictor->settled_pu);
    const dq_t predicted = dq_of(predictor->predicted_pu);
    dq_t total = change->total;
    if (in_first_periods) {
        total.d += current_predictor_share(predictor->second_q15, change->before.d) -
                   current_predictor_share(predictor->first_q15, change->now.d);
        total.q += current_predictor_share(predictor->second_q15, change->before.q) -
                   current_predictor_share(predictor->first_q15, change->now.q);
    }
    const dq_t next = {.d = current_predictor_moved(predicted.d, last.d, settled.d, total.d),
                       .q = current_predictor_moved(predicted.q, last.q, settled.q, total.q)};
    predictor->settled_pu = dq16_of(settled);
    predictor->predicted_pu = dq16_of(next);
}

/* Target of the delay compensation in the first two periods after a change, later the reference:
 * (1 - m) i + m target is the predicted current, given the sampled current i. */
static inline dq_t current_predictor_target(const current_predictor_t *predictor,
                                            const reference_change_t *change)
{
    const int32_t first_q15 = predictor->target_first_q15;
    const int32_t second_q15 = predictor->target_second_q15;
    const dq_t target = {
        .d = change->reference.d - current_predictor_share(second_q15, change->before.d) -
             current_predictor_share(first_q15, change->now.d),
        .q = change->reference.q - current_predictor_share(second_q15, change->before.q) -
             current_predictor_share(first_q15, change->now.q),
    };
    return target;
}

/* Bridge off: zero current. */
static inline void current_predictor_reset(current_predictor_t *predictor)
{
    const dq16_t zero = {.v = q_pair(0, 0)};
    predictor->settled_pu = zero;
    predictor->predicted_pu = zero;
}

/* Once per period. Returns the predicted mean current of the period in which the voltage acts, Q15,
 * |.| <= 1.007, saturated to 16 bits. */
Q_TARGET_INLINE dq16_t current_predictor_step(current_predictor_t *predictor)
{
    const dq16_t predicted = predictor->predicted_pu;
    const q_pair_t remaining =
        q_pair_difference(q_pair_load(&predictor->settled_pu.v), predicted.v);
    predictor->predicted_pu.v =
        q_pair_add(predicted.v, q_pair_scale(remaining, predictor->lag_q16));
    return predicted;
}

#endif

/* SPDX-License-Identifier: Apache-2.0 */
/*
 * reference_prefilter.h: shapes a changed current reference so that the sampled closed loop has the
 * step response of the designed first-order system (two-degree-of-freedom control). Evaluated when
 * a setpoint is applied and in the two periods after a change.
 *
 *     r'[n] = b0 r[n] + b1 r[n-1] + b2 r[n-2]          b0 + b1 + b2 = 1
 *
 * Coefficients from the bandwidth: DERIVATIONS.md, Reference prefilter.
 */
#ifndef FOC_REFERENCE_PREFILTER_H
#define FOC_REFERENCE_PREFILTER_H

#include <stdbool.h>
#include <stdint.h>

#include "config/config.h"
#include "core/frames.h"
#include "foc/state.h"

/* Smaller changes are not shaped, e.g. the steps of a torque ramp: the error is 5 % of the change,
 * below half a code of a 12-bit converter. */
enum { REFERENCE_PREFILTER_THRESHOLD_PU = 128 };

/* A reference and its change, Q15, |change| <= 2. */
typedef struct {
    dq_t reference; /* r[n] */
    dq_t total;     /* r[n] - r[n-1] */
    dq_t now;       /* the same; zero below the threshold */
    dq_t before;    /* `now` of the previous evaluation */
} reference_change_t;

/* The bandwidth is clamped to w T = 1/2; regen_table refuses larger ones. Divides. */
void reference_prefilter_init(reference_prefilter_t *prefilter, const config_t *config);

static inline int32_t reference_prefilter_threshold(int32_t change)
{
    const bool small =
        change > -REFERENCE_PREFILTER_THRESHOLD_PU && change < REFERENCE_PREFILTER_THRESHOLD_PU;
    return small ? 0 : change;
}

/* Takes the next reference r[n], inside the unit circle. */
static inline reference_change_t reference_prefilter_take(reference_prefilter_t *prefilter,
                                                          dq_t reference)
{
    const dq_t total = {.d = reference.d - prefilter->reference_pu.d,
                        .q = reference.q - prefilter->reference_pu.q};
    const reference_change_t change = {
        .reference = reference,
        .total = total,
        .now = {.d = reference_prefilter_threshold(total.d),
                .q = reference_prefilter_threshold(total.q)},
        .before = prefilter->change_pu,
    };
    prefilter->reference_pu = reference;
    prefilter->change_pu = change.now;
    prefilter->settled = (change.now.d | change.now.q | change.before.d | change.before.q) == 0;
    return change;
}

/* b0 r[n] + b1 r[n-1] + b2 r[n-2] = r[n] - (1 - b0) (r[n] - r[n-1]) - b2 (r[n-1] - r[n-2]): up to
 * 0.29 of a change beyond the reference. */
static inline dq_t reference_prefilter_output(const reference_prefilter_t *prefilter,
                                              const reference_change_t *change)
{
    const int32_t now_q15 = prefilter->one_minus_b0_q15;
    const int32_t before_q15 = prefilter->minus_b2_q15;
    const dq_t out = {
        .d = change->reference.d + ((before_q15 * change->before.d) >> 15) -
             ((now_q15 * change->now.d) >> 15),
        .q = change->reference.q + ((before_q15 * change->before.q) >> 15) -
             ((now_q15 * change->now.q) >> 15),
    };
    return out;
}

/* Bridge off: the reference is zero. */
static inline void reference_prefilter_reset(reference_prefilter_t *prefilter)
{
    const dq_t zero = {.d = 0, .q = 0};
    prefilter->reference_pu = zero;
    prefilter->change_pu = zero;
}

#endif

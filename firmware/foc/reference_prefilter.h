/* SPDX-License-Identifier: Apache-2.0 */
/*
 * reference_prefilter.h: shapes a changed current reference so that the sampled closed loop answers
 * like the designed first-order system (two-degree-of-freedom control). Evaluated when a setpoint
 * is applied and in the two periods after a change.
 *
 *     r'[n] = b0 r[n] + b1 r[n-1] + b2 r[n-2]          b0 + b1 + b2 = 1
 *
 * Coefficients from the bandwidth: README, Reference prefilter.
 */
#ifndef FOC_REFERENCE_PREFILTER_H
#define FOC_REFERENCE_PREFILTER_H

#include <stdbool.h>
#include <stdint.h>

#include "config/config.h"
#include "core/frames.h"
#include "foc/state.h"

/* Smaller changes are not shaped, e.g. the steps of a torque ramp: the error is a twentieth of the
 * change, below half a code of a 12-bit converter. */
enum { REFERENCE_PREFILTER_THRESHOLD_PU = 128 };

/* A reference and its change, Q15, |change| <= 2. */
typedef struct {
    dq_t reference; /* r[n] */
    dq_t total;     /* r[n] - r[n-1] */
    dq_t now;       /* the same; zero below the threshold */
    dq_t before;    /* `now` of the previous evaluation */
} reference_change_t;

/* A bandwidth above w T = 1/2, which regen_table refuses, counts as that. Divides. */
void reference_prefilter_init(reference_prefilter_t *prefilter, const config_t *config);

/* Takes the next reference r[n], inside the unit circle. */
reference_change_t reference_prefilter_take(reference_prefilter_t *prefilter, dq_t reference);

/* r'[n]: up to 0.29 of a change beyond the reference. */
dq_t reference_prefilter_output(const reference_prefilter_t *prefilter,
                                const reference_change_t *change);

/* Bridge off: the reference is zero. */
void reference_prefilter_reset(reference_prefilter_t *prefilter);

#endif

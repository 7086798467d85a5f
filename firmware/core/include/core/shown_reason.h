/* SPDX-License-Identifier: Apache-2.0 */
/*
 * shown_reason.h: a reason for people, at most five changes in a second. Slow loop, 1 kHz.
 *
 * Where two limits are equally tight, or a limit and the torque rate take turns at each message of
 * a rising demand, the reason changes up to each millisecond. What is shown changes at once after
 * rest, and from no reason to any, or from the torque rate to a limit; each change puts off the
 * next one of another kind by a third of a second.
 */
#ifndef CORE_SHOWN_REASON_H
#define CORE_SHOWN_REASON_H

#include <stdbool.h>
#include <stdint.h>

#include "core/q15.h"
#include "core/reason.h"

/* Three changes can follow each other at once, to no reason, the torque rate, a limit: with S of
 * these a second has 1000/S + 3, rounded down. */
enum { SHOWN_REASON_STANDS_ms = 334 };

typedef struct {
    reason_t reason;
    uint16_t left_steps; /* until any change is shown, up to 3 SHOWN_REASON_STANDS_ms */
} shown_reason_t;

static inline shown_reason_t shown_reason_init(void)
{
    const shown_reason_t out = {.reason = REASON_NONE};
    return out;
}

/* Whether b says more than a: any reason more than none, a limit more than the torque rate. */
static inline bool shown_reason_less(reason_t a, reason_t b)
{
    return b != REASON_NONE &&
           (a == REASON_NONE || (a == REASON_TORQUE_RATE && b != REASON_TORQUE_RATE));
}

static inline reason_t shown_reason_step(shown_reason_t *state, reason_t reason)
{
    if (state->left_steps > 0U) {
        state->left_steps--;
    }
    if (reason != state->reason &&
        (state->left_steps == 0U || shown_reason_less(state->reason, reason))) {
        state->reason = reason;
        state->left_steps =
            (uint16_t)q_min(state->left_steps + SHOWN_REASON_STANDS_ms, 3 * SHOWN_REASON_STANDS_ms);
    }
    return state->reason;
}

#endif

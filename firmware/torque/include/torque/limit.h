/* SPDX-License-Identifier: Apache-2.0 */
/*
 * limit.h: a bound that remembers who set it. Magnitudes >= 0: a limit can shrink a torque to
 * nothing, never flip it.
 */
#ifndef TORQUE_LIMIT_H
#define TORQUE_LIMIT_H

#include <stdint.h>

#include "core/q15.h"
#include "core/reason.h"

typedef struct {
    int32_t torque_mNm; /* >= 0 */
    reason_t reason;    /* of the tightest bound so far */
} limit_t;

static inline limit_t limit_init(int32_t torque_mNm, reason_t reason)
{
    const limit_t out = {.torque_mNm = q_max(torque_mNm, 0), .reason = reason};
    return out;
}

/* Tighten to torque_mNm (values below 0 count as 0). On a tie the earlier reason stays. */
static inline void limit_tighten(limit_t *limit, int32_t torque_mNm, reason_t reason)
{
    const int32_t bound = q_max(torque_mNm, 0);
    if (bound < limit->torque_mNm) {
        limit->torque_mNm = bound;
        limit->reason = reason;
    }
}

/* Multiply by a share in Q15; a share of one or more changes nothing. */
static inline void limit_derate(limit_t *limit, int32_t share_q15, reason_t reason)
{
    if (share_q15 < Q15_ONE) {
        limit_tighten(limit, q15_share_of(limit->torque_mNm, (int16_t)q_max(share_q15, 0)), reason);
    }
}

/* Share in Q15 that falls linearly from one at `full` to nothing at `none`; works in either
 * direction of x. full = none is a step: one up to and including it. */
static inline int32_t limit_fade_q15(int32_t x, int32_t full, int32_t none)
{
    if (full <= none) {
        return x <= full ? Q15_ONE : (x >= none ? 0 : q_scale(none - x, Q15_ONE, none - full));
    }
    return x >= full ? Q15_ONE : (x <= none ? 0 : q_scale(x - none, Q15_ONE, full - none));
}

#endif

/* SPDX-License-Identifier: Apache-2.0 */
/*
 * limit.h: a bound of the torque's magnitude together with its reason. Bounds are >= 0: a limit can
 * reduce a torque to zero but cannot change its sign.
 */
#ifndef TORQUE_LIMIT_H
#define TORQUE_LIMIT_H

#include <stdint.h>

#include "core/q15.h"
#include "core/reason.h"
#include "core/scaled.h"

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

/* Share in Q15 that falls linearly from one at `full` to zero at `none`; `full` may be below or
 * above `none`. full = none is a step: one for x <= full, else zero. */
static inline int32_t limit_fade_q15(int32_t x, int32_t full, int32_t none)
{
    if (full <= none) {
        return x <= full ? Q15_ONE : (x >= none ? 0 : scaled_ratio(none - x, none - full) >> 9);
    }
    return x >= full ? Q15_ONE : (x <= none ? 0 : scaled_ratio(x - none, full - none) >> 9);
}

#endif

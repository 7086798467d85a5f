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

#endif

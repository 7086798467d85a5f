/* SPDX-License-Identifier: Apache-2.0 */
/*
 * fade.h: a share that falls along a straight line, for derating and blend-out. Slow loop: divides.
 */
#ifndef CORE_FADE_H
#define CORE_FADE_H

#include <stdint.h>

#include "core/q15.h"
#include "core/scaled.h"

/* Share in Q15 that falls linearly from one at `full` to zero at `none`; `full` may be below or
 * above `none`. full = none is a step: one for x <= full, else zero. */
static inline int32_t fade_q15(int32_t x, int32_t full, int32_t none)
{
    if (full <= none) {
        return x <= full ? Q15_ONE : (x >= none ? 0 : scaled_ratio(none - x, none - full) >> 9);
    }
    return x >= full ? Q15_ONE : (x <= none ? 0 : scaled_ratio(x - none, full - none) >> 9);
}

#endif

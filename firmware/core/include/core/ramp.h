/* SPDX-License-Identifier: Apache-2.0 */
/*
 * ramp.h: rate limiter.
 */
#ifndef CORE_RAMP_H
#define CORE_RAMP_H

#include <stdint.h>

#include "core/q15.h"

/* Returns the value after one step: `value` moved towards the target by at most `step` (>= 0),
 * never past it. Differences saturate, so any pair of int32_t values is allowed. */
static inline int32_t ramp_step(int32_t value, int32_t target, int32_t step)
{
    const int64_t distance = (int64_t)target - value;
    if (distance > step) {
        return (int32_t)((int64_t)value + step);
    }
    if (distance < -(int64_t)step) {
        return (int32_t)((int64_t)value - step);
    }
    return target;
}

#endif

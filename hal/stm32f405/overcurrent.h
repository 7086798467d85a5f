/* SPDX-License-Identifier: Apache-2.0 */
/* overcurrent.h: this chip has no comparators; the gate driver trips (README, Gate driver). */
#ifndef STM32F405_OVERCURRENT_H
#define STM32F405_OVERCURRENT_H

#include <stdbool.h>

#define OVERCURRENT_BREAK 0U
#define OVERCURRENT_FLAG 0U

static inline void overcurrent_connect(void) {}

static inline bool overcurrent_start(void)
{
    return true;
}

#endif

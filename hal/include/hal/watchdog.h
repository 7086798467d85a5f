/* SPDX-License-Identifier: Apache-2.0 */
/*
 * watchdog.h: resets the core, which switches the bridge off, unless it is fed in time. It cannot
 * be stopped.
 */
#ifndef HAL_WATCHDOG_H
#define HAL_WATCHDOG_H

#include <stdbool.h>
#include <stdint.h>

/* timeout_ms: 1 to 4000. The watchdog has an oscillator of its own, which may be up to 47 % fast or
 * slow, so the real timeout lies between two thirds and twice this value. */
void watchdog_start(uint32_t timeout_ms);

void watchdog_feed(void);

/* True if the watchdog caused the last reset; constant until the next reset. */
bool watchdog_caused_reset(void);

#endif

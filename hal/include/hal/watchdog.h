/* SPDX-License-Identifier: Apache-2.0 */
/*
 * watchdog.h: resets the core, which switches the bridge off, unless it is fed in time. It cannot
 * be stopped.
 */
#ifndef HAL_WATCHDOG_H
#define HAL_WATCHDOG_H

#include <stdbool.h>
#include <stdint.h>

/* timeout_ms 1 .. 4000, made by an oscillator of its own, which may be 47 % fast or slow: between
 * two thirds of that time and twice as long. */
void watchdog_start(uint32_t timeout_ms);

void watchdog_feed(void);

/* Did the watchdog cause the last reset? Constant until the next one. */
bool watchdog_caused_reset(void);

#endif

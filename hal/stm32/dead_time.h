/* SPDX-License-Identifier: Apache-2.0 */
/*
 * dead_time.h: the dead-time generator's code (DTG of TIM1_BDTR, RM0090 section 17.4.18,
 * RM0440 section 28.6.20).
 *
 *     0xxxxxxx   x                1 clock a step     0 .. 127 clocks
 *     10xxxxxx   64 + x           2 clocks a step    128 .. 254
 *     110xxxxx   32 + x           8 clocks a step    256 .. 504
 *     111xxxxx   32 + x          16 clocks a step    512 .. 1008
 *
 * Pure; tested on the host.
 */
#ifndef STM32_DEAD_TIME_H
#define STM32_DEAD_TIME_H

#include <stdbool.h>
#include <stdint.h>

enum { DEAD_TIME_MAX_CLOCKS = 1008 };

/* The shortest dead time that is not shorter than dead_time_ns at a timer clock of clock_Hz. False,
 * and *code untouched, if the generator cannot make one so long. */
bool dead_time_encode(uint32_t dead_time_ns, uint32_t clock_Hz, uint8_t *code);

/* What a code means, in timer clocks. */
uint32_t dead_time_clocks(uint8_t code);

#endif

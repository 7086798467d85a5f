/* SPDX-License-Identifier: Apache-2.0 */
/*
 * wait.h: every wait for hardware in this port is bounded by a number of polls, so that a missing
 * crystal, a shorted bus or an emulator without the peripheral leads to a report instead of a hang.
 *
 * One poll takes at least five cycles (load, compare, count, branch): 0.3 us on the 16 MHz internal
 * oscillator that the core starts with, 30 ns at 168 MHz. On a register of the slowest bus, APB1 at
 * a quarter of the core's clock, it takes four times as long: up to four cycles to fall in step,
 * eight for the two of the access, and the loop's own.
 */
#ifndef STM32_WAIT_H
#define STM32_WAIT_H

#include <stdbool.h>
#include <stdint.h>

enum { WAIT_POLL_CYCLES_MOST = 20 };

/* True as soon as (*reg & mask) == value; false after `polls` polls. */
static inline bool wait_for(const volatile uint32_t *reg, uint32_t mask, uint32_t value,
                            uint32_t polls)
{
    while (polls > 0) {
        if ((*reg & mask) == value) {
            return true;
        }
        polls--;
    }
    return false;
}

#endif

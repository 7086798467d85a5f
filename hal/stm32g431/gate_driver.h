/* SPDX-License-Identifier: Apache-2.0 */
/*
 * gate_driver.h: the L6387 has inputs only, no enable, no fault line and no bus, so there is
 * nothing to start, to watch or to recover (inverter.c).
 */
#ifndef STM32G431_GATE_DRIVER_H
#define STM32G431_GATE_DRIVER_H

#include <stdbool.h>
#include <stdint.h>

static inline bool gate_driver_start(void)
{
    return true;
}

static inline void gate_driver_watch(void) {}

static inline void gate_driver_acknowledge(void) {}

static inline bool gate_driver_recover(uint32_t *status)
{
    *status = 0;
    return true;
}

static inline void gate_driver_release(void) {}

static inline bool gate_driver_pulls_fault(void)
{
    return false;
}

#endif

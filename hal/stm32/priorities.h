/* SPDX-License-Identifier: Apache-2.0 */
/*
 * priorities.h: who may interrupt whom. Smaller numbers win; the core implements sixteen levels.
 *
 *     0   the chip's supply falls: a fault; the gate driver reports a fault
 *     1   the PWM period: ADC, end of the injected conversions
 *     8   the millisecond: SysTick
 *
 * The core's own faults have priority 0, too; the hard fault and the non-maskable interrupt stand
 * above all of them.
 */
#ifndef STM32_PRIORITIES_H
#define STM32_PRIORITIES_H

#include <stdint.h>

enum {
    PRIORITY_SUPPLY = 0,
    PRIORITY_DRIVER_FAULT = 0,
    PRIORITY_PWM_PERIOD = 1,
    PRIORITY_MILLISECOND = 8
};
void interrupts_enable(uint32_t number, uint32_t priority);

/* Priority of SysTick. */
void interrupts_set_millisecond_priority(void);

#endif

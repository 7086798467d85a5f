/* SPDX-License-Identifier: Apache-2.0 */
/* syscfg.h: system configuration, RM0440 section 10.2: which memory is at address 0. */
#ifndef STM32G431_REGISTERS_SYSCFG_H
#define STM32G431_REGISTERS_SYSCFG_H

#include <stdint.h>

typedef struct {
    volatile uint32_t MEMRMP;
} syscfg_registers_t;

#define SYSCFG ((syscfg_registers_t *)0x40010000U)

#endif

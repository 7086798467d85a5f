/* SPDX-License-Identifier: Apache-2.0 */
/* syscfg.h: system configuration, RM0090 section 9.2 (STM32F405xx): which port an external
 * interrupt listens to, four lines a register. */
#ifndef STM32F405_REGISTERS_SYSCFG_H
#define STM32F405_REGISTERS_SYSCFG_H

#include <stdint.h>

typedef struct {
    volatile uint32_t MEMRM;
    volatile uint32_t PMC;
    volatile uint32_t EXTICR1; /* 9.2.3 */
    volatile uint32_t EXTICR2;
    volatile uint32_t EXTICR3;
    volatile uint32_t EXTICR4;
} syscfg_registers_t;

#define SYSCFG ((syscfg_registers_t *)0x40013800U)

#endif

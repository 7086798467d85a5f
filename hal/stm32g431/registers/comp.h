/* SPDX-License-Identifier: Apache-2.0 */
/* comp.h: comparators; RM0440 section 24.5. */
#ifndef STM32G431_REGISTERS_COMP_H
#define STM32G431_REGISTERS_COMP_H

#include <stdint.h>

typedef struct {
    volatile uint32_t C1CSR;
    volatile uint32_t C2CSR;
    volatile uint32_t C3CSR;
    volatile uint32_t C4CSR;
} comp_registers_t;

#define COMP ((comp_registers_t *)0x40010200U)

/* The same for all four. */
#define COMP_C1CSR_EN (1U << 0)
#define COMP_C1CSR_INMSEL_Pos 4
#define COMP_C1CSR_INMSEL (0x7U << 4)
#define COMP_C1CSR_VALUE (1U << 30)
#define COMP_C1CSR_LOCK (1U << 31)

#endif

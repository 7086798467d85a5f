/* SPDX-License-Identifier: Apache-2.0 */
/* power.h: power control, RM0090 section 5.4 (STM32F405xx), and external interrupts, section 12.3.
 */
#ifndef STM32F405_REGISTERS_POWER_H
#define STM32F405_REGISTERS_POWER_H

#include <stdint.h>

typedef struct {
    volatile uint32_t CR;  /* 5.4.1 */
    volatile uint32_t CSR; /* 5.4.2 */
} pwr_registers_t;

#define PWR ((pwr_registers_t *)0x40007000U)

#define PWR_CR_PVDE (1U << 4)
#define PWR_CR_PLS_Pos 5
#define PWR_CR_PLS (0x7U << 5)
#define PWR_CSR_PVDO (1U << 2)

typedef struct {
    volatile uint32_t IMR;  /* 12.3.1 */
    volatile uint32_t EMR;  /* 12.3.2 */
    volatile uint32_t RTSR; /* 12.3.3 */
    volatile uint32_t FTSR; /* 12.3.4 */
    volatile uint32_t SWIER;
    volatile uint32_t PR; /* 12.3.6 */
} exti_registers_t;

#define EXTI ((exti_registers_t *)0x40013C00U)

/* Line 16 is the voltage detector's. */
#define EXTI_IMR_MR16 (1U << 16)
#define EXTI_RTSR_TR16 (1U << 16)
#define EXTI_PR_PR16 (1U << 16)

#endif

/* SPDX-License-Identifier: Apache-2.0 */
/* power.h: power control, RM0440 section 6.4, and external interrupts, section 16.5. */
#ifndef STM32G431_REGISTERS_POWER_H
#define STM32G431_REGISTERS_POWER_H

#include <stdint.h>

typedef struct {
    volatile uint32_t CR1;
    volatile uint32_t CR2;
    volatile uint32_t CR3;
    volatile uint32_t CR4;
    volatile uint32_t SR1;
    volatile uint32_t SR2;
    volatile uint32_t SCR;
    uint32_t reserved_1C[25];
    volatile uint32_t CR5;
} pwr_registers_t;

#define PWR ((pwr_registers_t *)0x40007000U)

#define PWR_CR2_PVDE (1U << 0)
#define PWR_CR2_PLS_Pos 1
#define PWR_CR2_PLS (0x7U << 1)
#define PWR_CR3_UCPD1_DBDIS (1U << 14)
#define PWR_SR2_PVDO (1U << 11)
#define PWR_CR5_R1MODE (1U << 8) /* 0: boost */

typedef struct {
    volatile uint32_t IMR1;
    volatile uint32_t EMR1;
    volatile uint32_t RTSR1;
    volatile uint32_t FTSR1;
    volatile uint32_t SWIER1;
    volatile uint32_t PR1;
} exti_registers_t;

#define EXTI ((exti_registers_t *)0x40010400U)

/* Line 16 is the voltage detector's. */
#define EXTI_IMR1_IM16 (1U << 16)
#define EXTI_RTSR1_RT16 (1U << 16)
#define EXTI_PR1_PIF16 (1U << 16)

#endif

/* SPDX-License-Identifier: Apache-2.0 */
/* tim.h: timers; RM0440 sections 28.6 (advanced, TIM1, TIM8) and 29.5 (general purpose, TIM4: no
 * RCR, no BDTR). */
#ifndef STM32G431_REGISTERS_TIM_H
#define STM32G431_REGISTERS_TIM_H

#include "registers/tim_layout.h"

#define TIM1 ((tim_registers_t *)0x40012C00U)
#define TIM8 ((tim_registers_t *)0x40013400U)
#define TIM4 ((tim_registers_t *)0x40000800U)

/* What the layout that both chips have ends before. */
typedef struct {
    uint32_t reserved_00[25];
    volatile uint32_t AF2;
} tim_further_registers_t;

#define TIM1_FURTHER ((tim_further_registers_t *)0x40012C00U)

/* The second break input (28.6.20, 28.6.26). */
#define TIM_SR_B2IF (1U << 8)
#define TIM_BDTR_BK2F_Pos 20
#define TIM_BDTR_BK2F (0xFU << 20)
#define TIM_BDTR_BK2E (1U << 24)
#define TIM_BDTR_BK2P (1U << 25)
#define TIM_AF2_BK2CMP1E (1U << 1)
#define TIM_AF2_BK2CMP2E (1U << 2)
#define TIM_AF2_BK2CMP4E (1U << 4)

#endif

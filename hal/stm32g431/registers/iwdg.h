/* SPDX-License-Identifier: Apache-2.0 */
/* iwdg.h: independent watchdog, RM0440 section 44.4; and the debug freeze bits, section 47.16. */
#ifndef STM32G431_REGISTERS_IWDG_H
#define STM32G431_REGISTERS_IWDG_H

#include "registers/iwdg_layout.h"

#define IWDG ((iwdg_registers_t *)0x40003000U)

typedef struct {
    volatile uint32_t IDCODE;
    volatile uint32_t CR;
    volatile uint32_t APB1_FZ;
    volatile uint32_t APB1H_FZ;
    volatile uint32_t APB2_FZ;
} dbgmcu_registers_t;

#define DBGMCU ((dbgmcu_registers_t *)0xE0042000U)
#define DBGMCU_APB1_FZ_IWDG_STOP (1U << 12)
#define DBGMCU_APB2_FZ_TIM1_STOP (1U << 11)

#endif

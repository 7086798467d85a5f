/* SPDX-License-Identifier: Apache-2.0 */
/* iwdg.h: independent watchdog, RM0090 section 21.4; and the debug freeze bits, section 38.16. */
#ifndef STM32F405_REGISTERS_IWDG_H
#define STM32F405_REGISTERS_IWDG_H

#include "registers/iwdg_layout.h"

#define IWDG ((iwdg_registers_t *)0x40003000U)

typedef struct {
    volatile uint32_t IDCODE;
    volatile uint32_t CR;
    volatile uint32_t APB1_FZ;
    volatile uint32_t APB2_FZ;
} dbgmcu_registers_t;

#define DBGMCU ((dbgmcu_registers_t *)0xE0042000U)
#define DBGMCU_APB1_FZ_IWDG_STOP (1U << 12)
#define DBGMCU_APB2_FZ_TIM1_STOP (1U << 0)

#endif

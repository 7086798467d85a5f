/* SPDX-License-Identifier: Apache-2.0 */
/* iwdg.h: independent watchdog, RM0090 section 21.4; and the debug freeze bits, section 38.16. */
#ifndef STM32F405_REGISTERS_IWDG_H
#define STM32F405_REGISTERS_IWDG_H

#include <stdint.h>

typedef struct {
    volatile uint32_t KR;
    volatile uint32_t PR;
    volatile uint32_t RLR;
    volatile uint32_t SR;
} iwdg_registers_t;

#define IWDG ((iwdg_registers_t *)0x40003000U)

#define IWDG_KR_KEY 0xFFFFU
#define IWDG_KR_KEY_RELOAD 0xAAAAU
#define IWDG_KR_KEY_ENABLE_ACCESS 0x5555U
#define IWDG_KR_KEY_START 0xCCCCU
#define IWDG_PR_PR 0x7U
#define IWDG_RLR_RL 0xFFFU
#define IWDG_SR_PVU (1U << 0)
#define IWDG_SR_RVU (1U << 1)

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

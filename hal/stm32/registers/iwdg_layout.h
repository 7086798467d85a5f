/* SPDX-License-Identifier: Apache-2.0 */
/* iwdg_layout.h: the independent watchdog of both chips; RM0090 section 21.4, RM0440 section 44.4.
 */
#ifndef STM32_REGISTERS_IWDG_LAYOUT_H
#define STM32_REGISTERS_IWDG_LAYOUT_H

#include <stdint.h>

typedef struct {
    volatile uint32_t KR;
    volatile uint32_t PR;
    volatile uint32_t RLR;
    volatile uint32_t SR;
} iwdg_registers_t;

#define IWDG_KR_KEY 0xFFFFU
#define IWDG_KR_KEY_RELOAD 0xAAAAU
#define IWDG_KR_KEY_ENABLE_ACCESS 0x5555U
#define IWDG_KR_KEY_START 0xCCCCU
#define IWDG_PR_PR 0x7U
#define IWDG_RLR_RL 0xFFFU
#define IWDG_SR_PVU (1U << 0)
#define IWDG_SR_RVU (1U << 1)

#endif

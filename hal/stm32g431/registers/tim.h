/* SPDX-License-Identifier: Apache-2.0 */
/* tim.h: timers; RM0440 sections 28.6 (advanced, TIM1) and 29.5 (general purpose, TIM4: no RCR, no
 * BDTR). */
#ifndef STM32G431_REGISTERS_TIM_H
#define STM32G431_REGISTERS_TIM_H

#include "registers/tim_layout.h"

#define TIM1 ((tim_registers_t *)0x40012C00U)
#define TIM4 ((tim_registers_t *)0x40000800U)

#endif

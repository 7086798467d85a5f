/* SPDX-License-Identifier: Apache-2.0 */
/* tim.h: timers; RM0090 sections 17.4 (advanced, TIM1, TIM8) and 18.4 (general purpose, TIM3: no
 * RCR, no BDTR). */
#ifndef STM32F405_REGISTERS_TIM_H
#define STM32F405_REGISTERS_TIM_H

#include "registers/tim_layout.h"

#define TIM1 ((tim_registers_t *)0x40010000U)
#define TIM8 ((tim_registers_t *)0x40010400U)
#define TIM3 ((tim_registers_t *)0x40000400U)

#endif

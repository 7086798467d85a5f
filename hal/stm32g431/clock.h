/* SPDX-License-Identifier: Apache-2.0 */
/*
 * clock.h: the frequencies that clock_start() arrived at: 170 MHz from the crystal, or the 16 MHz
 * internal oscillator. Both buses run at the core's frequency.
 */
#ifndef STM32G431_CLOCK_H
#define STM32G431_CLOCK_H

#include <stdbool.h>
#include <stdint.h>

#include "registers/rcc.h"

enum { CLOCK_INTERNAL_Hz = 16000000, CLOCK_CORE_Hz = 170000000, CLOCK_TIMER1_Hz = CLOCK_CORE_Hz };

/* False: the core runs on its internal oscillator. Background context, once. */
bool clock_start(void);

uint32_t clock_core_Hz(void);

/* Of the pins' ports. The clock is on two cycles after the write; the read takes longer. */
static inline void clock_start_pins(void)
{
    RCC->AHB2ENR |=
        RCC_AHB2ENR_GPIOAEN | RCC_AHB2ENR_GPIOBEN | RCC_AHB2ENR_GPIOCEN | RCC_AHB2ENR_GPIOFEN;
    (void)RCC->AHB2ENR;
}

/* Of the timer that counts an encoder. */
static inline void clock_start_encoder(void)
{
    RCC->APB1ENR1 |= RCC_APB1ENR1_TIM4EN;
    (void)RCC->APB1ENR1;
}

#endif

/* SPDX-License-Identifier: Apache-2.0 */
/*
 * clock.h: the frequencies that clock_start() arrived at: 168 MHz from the crystal, or the 16 MHz
 * internal oscillator.
 */
#ifndef STM32F405_CLOCK_H
#define STM32F405_CLOCK_H

#include <stdbool.h>
#include <stdint.h>

#include "registers/rcc.h"

enum {
    CLOCK_INTERNAL_Hz = 16000000,
    CLOCK_CORE_Hz = 168000000,
    CLOCK_APB1_DIVIDER = 4,
    CLOCK_APB2_DIVIDER = 2,
    CLOCK_TIMER1_Hz =
        CLOCK_CORE_Hz /* timers on a divided bus run at twice the bus clock: 2 x 84 MHz */
};

/* False: the core runs on its internal oscillator, the buses undivided. Background context, once.
 */
bool clock_start(void);

uint32_t clock_core_Hz(void);
uint32_t clock_apb1_Hz(void);

/* Of the pins' ports. The clock is on two cycles after the write; the read takes longer (errata
 * 2.1.13). */
static inline void clock_start_pins(void)
{
    RCC->AHB1ENR |=
        RCC_AHB1ENR_GPIOAEN | RCC_AHB1ENR_GPIOBEN | RCC_AHB1ENR_GPIOCEN | RCC_AHB1ENR_GPIODEN;
    (void)RCC->AHB1ENR;
}

/* Of the timer that counts an encoder. */
static inline void clock_start_encoder(void)
{
    RCC->APB1ENR |= RCC_APB1ENR_TIM3EN;
    (void)RCC->APB1ENR;
}

#endif

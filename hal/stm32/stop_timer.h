/* SPDX-License-Identifier: Apache-2.0 */
/*
 * stop_timer.h: takes all gates when the compare values are no longer renewed, without the core.
 *
 *     inverter_set() --count = 0--> TIM8 --overflow, 1.5 PWM periods--> DMA --> TIM1_BDTR, MOE = 0
 *
 * No timer is connected to TIM1's break input in these chips (RM0090 section 17.3.12: pin and clock
 * failure; RM0440 section 28.3.16: pins, comparators and failures of the chip), and an
 * interrupt needs a core that is not stuck. So a transfer writes what switch_off() of inverter.c
 * writes: the outputs take their idle levels, all gates low. It needs TIM8, the DMA controller and
 * their bus, and one word of RAM; stop_route.h of the chip has the way.
 *
 * A short circuit by equal compare values goes on as it is, so the timer stands meanwhile.
 */
#ifndef STM32_STOP_TIMER_H
#define STM32_STOP_TIMER_H

#include <stdbool.h>
#include <stdint.h>

#include "registers/rcc.h"
#include "registers/tim.h"

/* Background context, once, after TIM1's BDTR is written and locked. top_counts: of a PWM period,
 * which is twice that. */
void stop_timer_init(uint32_t top_counts);

/* The outputs are on and follow compare values, which will be renewed from now on. */
static inline void stop_timer_run(void)
{
    TIM8->CNT = 0;
    TIM8->CR1 = TIM_CR1_OPM | TIM_CR1_URS | TIM_CR1_CEN;
}

/* False after its end, as after stop_timer_stop(). */
static inline bool stop_timer_runs(void)
{
    return (TIM8->CR1 & TIM_CR1_CEN) != 0;
}

/* They are off, or need no renewal. Before inverter_init() the timer has no clock. */
static inline void stop_timer_stop(void)
{
    if ((RCC->APB2ENR & RCC_APB2ENR_TIM8EN) != 0U) {
        TIM8->CR1 = TIM_CR1_OPM | TIM_CR1_URS;
    }
}

/* The compare values are renewed. One store. */
static inline void stop_timer_renew(void)
{
    TIM8->CNT = 0;
}

/* True once after it has taken the gates. */
static inline bool stop_timer_acted(void)
{
    const bool acted = (TIM8->SR & TIM_SR_UIF) != 0;
    if (acted) {
        TIM8->SR = 0;
    }
    return acted;
}

#endif

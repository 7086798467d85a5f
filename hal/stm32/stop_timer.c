/* SPDX-License-Identifier: Apache-2.0 */
/* TIM8 (RM0090 section 17.4, RM0440 section 28.6) counts up to 1.5 PWM periods and requests a
 * transfer at its overflow (DIER, UDE). */
#include "stop_timer.h"

#include "registers/rcc.h"
#include "stop_route.h"

#define COLD __attribute__((cold)) /* optimised for size */

enum { HALF_PERIODS = 3 };

/* What the transfer writes. */
static volatile uint32_t outputs_off;

COLD void stop_timer_init(uint32_t top_counts)
{
    outputs_off = TIM1->BDTR & ~(uint32_t)TIM_BDTR_MOE;
    TIM8->CR1 = TIM_CR1_OPM | TIM_CR1_URS;
    TIM8->ARR = HALF_PERIODS * top_counts - 1U;
    TIM8->SR = 0;
    stop_route_start(&outputs_off, &TIM1->BDTR);
    TIM8->DIER = TIM_DIER_UDE;
}

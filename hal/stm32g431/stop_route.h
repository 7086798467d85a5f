/* SPDX-License-Identifier: Apache-2.0 */
/* stop_route.h: from an update of TIM8 to a register, for stop_timer.c: a channel of DMA1 (RM0440
 * section 12.4), connected to every bus. */
#ifndef STM32G431_STOP_ROUTE_H
#define STM32G431_STOP_ROUTE_H

#include <stdint.h>

#include "registers/dma.h"
#include "registers/rcc.h"

enum { /* index of the channel, which is the multiplexer's as well */
       STOP_CHANNEL = 2,
       STOP_REQUEST = 53, /* TIM8_UP, RM0440 table 91 */
       STOP_WORDS = 2     /* PSIZE, MSIZE */
};

/* At each request the word goes to the register. */
static inline void stop_route_start(const volatile uint32_t *word, volatile uint32_t *to)
{
    dma_channel_t *const channel = &DMA1->channel[STOP_CHANNEL];
    RCC->AHB1ENR |= RCC_AHB1ENR_DMA1EN | RCC_AHB1ENR_DMAMUXEN;
    (void)RCC->AHB1ENR;
    DMAMUX->CCR[STOP_CHANNEL] = STOP_REQUEST;
    channel->CPAR = (uint32_t)(uintptr_t)to;
    channel->CMAR = (uint32_t)(uintptr_t)word;
    channel->CNDTR = 1;
    channel->CCR = (uint32_t)STOP_WORDS << DMA_CCR1_PSIZE_Pos |
                   (uint32_t)STOP_WORDS << DMA_CCR1_MSIZE_Pos | DMA_CCR1_DIR | DMA_CCR1_CIRC |
                   DMA_CCR1_EN;
}

#endif

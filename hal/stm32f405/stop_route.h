/* SPDX-License-Identifier: Apache-2.0 */
/* stop_route.h: from an update of TIM8 to a register, for stop_timer.c: DMA2 (RM0090 section 10.3),
 * the only one of the two controllers connected to TIM1's bus (2.1.4). */
#ifndef STM32F405_STOP_ROUTE_H
#define STM32F405_STOP_ROUTE_H

#include <stdint.h>

#include "registers/dma.h"
#include "registers/rcc.h"

enum { /* RM0090 table 43 */
       STOP_STREAM = 1,
       STOP_CHANNEL = 7,
       STOP_FROM_MEMORY = 1,
       STOP_WORDS = 2 /* PSIZE, MSIZE */
};

/* At each request the word goes to the register. */
static inline void stop_route_start(const volatile uint32_t *word, volatile uint32_t *to)
{
    dma_stream_t *const stream = &DMA2->stream[STOP_STREAM];
    RCC->AHB1ENR |= RCC_AHB1ENR_DMA2EN;
    (void)RCC->AHB1ENR;
    stream->PAR = (uint32_t)(uintptr_t)to;
    stream->M0AR = (uint32_t)(uintptr_t)word;
    stream->NDTR = 1;
    stream->CR = (uint32_t)STOP_CHANNEL << DMA_S0CR_CHSEL_Pos |
                 (uint32_t)STOP_WORDS << DMA_S0CR_PSIZE_Pos |
                 (uint32_t)STOP_WORDS << DMA_S0CR_MSIZE_Pos |
                 (uint32_t)STOP_FROM_MEMORY << DMA_S0CR_DIR_Pos | DMA_S0CR_CIRC;
    stream->CR |= DMA_S0CR_EN;
}

#endif

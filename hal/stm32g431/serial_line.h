/* SPDX-License-Identifier: Apache-2.0 */
/* serial_line.h: USART2 (RM0440 section 37.5) with two channels of DMA1 (12.4), for serial.c. */
#ifndef STM32G431_SERIAL_LINE_H
#define STM32G431_SERIAL_LINE_H

#include <stdbool.h>
#include <stdint.h>

#include "clock.h"
#include "registers/dma.h"
#include "registers/rcc.h"
#include "registers/usart.h"

enum { /* index of the channel, which is the multiplexer's as well */
       SERIAL_CHANNEL_RECEIVE = 0,
       SERIAL_CHANNEL_TRANSMIT = 1,
       /* RM0440 table 91 */
       SERIAL_REQUEST_RECEIVE = 26,
       SERIAL_REQUEST_TRANSMIT = 27
};

/* Bytes go to and from these two buffers; received ones begin again at the first. */
static inline void serial_line_start(uint32_t bit_rate, volatile uint8_t *incoming, uint32_t size,
                                     const uint8_t *outgoing)
{
    dma_channel_t *const receive = &DMA1->channel[SERIAL_CHANNEL_RECEIVE];
    dma_channel_t *const transmit = &DMA1->channel[SERIAL_CHANNEL_TRANSMIT];
    RCC->AHB1ENR |= RCC_AHB1ENR_DMA1EN | RCC_AHB1ENR_DMAMUXEN;
    RCC->APB1ENR1 |= RCC_APB1ENR1_USART2EN;
    (void)RCC->APB1ENR1;
    DMAMUX->CCR[SERIAL_CHANNEL_RECEIVE] = SERIAL_REQUEST_RECEIVE;
    DMAMUX->CCR[SERIAL_CHANNEL_TRANSMIT] = SERIAL_REQUEST_TRANSMIT;
    receive->CPAR = (uint32_t)(uintptr_t)&USART2->RDR;
    receive->CMAR = (uint32_t)(uintptr_t)incoming;
    receive->CNDTR = size;
    receive->CCR = DMA_CCR1_MINC | DMA_CCR1_CIRC | DMA_CCR1_EN;
    transmit->CPAR = (uint32_t)(uintptr_t)&USART2->TDR;
    transmit->CMAR = (uint32_t)(uintptr_t)outgoing;
    USART2->BRR = (clock_core_Hz() + bit_rate / 2U) / bit_rate; /* 37.5.8, 16 samples a bit */
    USART2->CR3 = USART_CR3_DMAR | USART_CR3_DMAT;
    USART2->CR1 = USART_CR1_TE | USART_CR1_RE | USART_CR1_UE;
}

/* Received bytes that are still to come until the first place of the buffer is next: 1 to size. */
static inline uint32_t serial_line_receive_left(void)
{
    return DMA1->channel[SERIAL_CHANNEL_RECEIVE].CNDTR;
}

/* The bytes of the latest serial_line_send() are with the line. */
static inline bool serial_line_is_free(void)
{
    return DMA1->channel[SERIAL_CHANNEL_TRANSMIT].CNDTR == 0;
}

/* Sends the first bytes of the buffer; only while serial_line_is_free(). */
static inline void serial_line_send(uint32_t count)
{
    /* The count can be written only while the channel is off, which it does not become by itself
     * (12.6.4). */
    DMA1->channel[SERIAL_CHANNEL_TRANSMIT].CCR = DMA_CCR1_MINC | DMA_CCR1_DIR;
    DMA1->channel[SERIAL_CHANNEL_TRANSMIT].CNDTR = count;
    DMA1->channel[SERIAL_CHANNEL_TRANSMIT].CCR = DMA_CCR1_MINC | DMA_CCR1_DIR | DMA_CCR1_EN;
}

#endif

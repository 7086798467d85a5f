/* SPDX-License-Identifier: Apache-2.0 */
/* serial_line.h: USART3 (RM0090 section 30.3) with two streams of DMA1 (10.3), for serial.c. */
#ifndef STM32F405_SERIAL_LINE_H
#define STM32F405_SERIAL_LINE_H

#include <stdbool.h>
#include <stdint.h>

#include "clock.h"
#include "registers/dma.h"
#include "registers/rcc.h"
#include "registers/usart.h"

enum { /* RM0090 table 42 */
       SERIAL_STREAM_RECEIVE = 1,
       SERIAL_STREAM_TRANSMIT = 3,
       SERIAL_CHANNEL = 4, /* of both */
       SERIAL_FROM_MEMORY = 1
};

/* Bytes go to and from these two buffers; received ones begin again at the first. */
static inline void serial_line_start(uint32_t bit_rate, volatile uint8_t *incoming, uint32_t size,
                                     const uint8_t *outgoing)
{
    dma_stream_t *const receive = &DMA1->stream[SERIAL_STREAM_RECEIVE];
    dma_stream_t *const transmit = &DMA1->stream[SERIAL_STREAM_TRANSMIT];
    const uint32_t settings = (uint32_t)SERIAL_CHANNEL << DMA_S0CR_CHSEL_Pos | DMA_S0CR_MINC;
    RCC->AHB1ENR |= RCC_AHB1ENR_DMA1EN;
    RCC->APB1ENR |= RCC_APB1ENR_USART3EN;
    (void)RCC->APB1ENR;
    receive->PAR = (uint32_t)(uintptr_t)&USART3->DR;
    receive->M0AR = (uint32_t)(uintptr_t)incoming;
    receive->NDTR = size;
    receive->CR = settings | DMA_S0CR_CIRC;
    receive->CR |= DMA_S0CR_EN;
    transmit->PAR = (uint32_t)(uintptr_t)&USART3->DR;
    transmit->M0AR = (uint32_t)(uintptr_t)outgoing;
    transmit->CR = settings | (uint32_t)SERIAL_FROM_MEMORY << DMA_S0CR_DIR_Pos;
    /* 16 samples a bit: the register holds the divider in sixteenths, which is clock / rate
     * (30.3.4). */
    USART3->BRR = (clock_apb1_Hz() + bit_rate / 2U) / bit_rate;
    USART3->CR3 = USART_CR3_DMAR | USART_CR3_DMAT;
    USART3->CR1 = USART_CR1_UE | USART_CR1_TE | USART_CR1_RE;
}

/* Received bytes that are still to come until the first place of the buffer is next: 1 to size. */
static inline uint32_t serial_line_receive_left(void)
{
    return DMA1->stream[SERIAL_STREAM_RECEIVE].NDTR;
}

/* The bytes of the latest serial_line_send() are with the line. */
static inline bool serial_line_is_free(void)
{
    return (DMA1->stream[SERIAL_STREAM_TRANSMIT].CR & DMA_S0CR_EN) == 0;
}

/* Sends the first bytes of the buffer; only while serial_line_is_free(). */
static inline void serial_line_send(uint32_t count)
{
    /* A stream does not start with flags of its last transfer (10.3.17). */
    DMA1->LIFCR = DMA_LIFCR_CFEIF3 | DMA_LIFCR_CDMEIF3 | DMA_LIFCR_CTEIF3 | DMA_LIFCR_CHTIF3 |
                  DMA_LIFCR_CTCIF3;
    DMA1->stream[SERIAL_STREAM_TRANSMIT].NDTR = count;
    DMA1->stream[SERIAL_STREAM_TRANSMIT].CR |= DMA_S0CR_EN;
}

#endif

/* SPDX-License-Identifier: Apache-2.0 */
/* serial_line.h: USART3 (RM0090 section 30.3), one byte at a time, for serial.c. */
#ifndef STM32F405_SERIAL_LINE_H
#define STM32F405_SERIAL_LINE_H

#include <stdbool.h>
#include <stdint.h>

#include "clock.h"
#include "registers/rcc.h"
#include "registers/usart.h"

enum { SERIAL_LINE_HOLDS = 1 }; /* received bytes */

static inline void serial_line_start(uint32_t bit_rate)
{
    RCC->APB1ENR |= RCC_APB1ENR_USART3EN;
    (void)RCC->APB1ENR;
    /* 16 samples a bit: the register holds the divider in sixteenths, which is clock / rate
     * (30.3.4). */
    USART3->BRR = (clock_apb1_Hz() + bit_rate / 2U) / bit_rate;
    USART3->CR1 = USART_CR1_UE | USART_CR1_TE | USART_CR1_RE | USART_CR1_RXNEIE;
}

/* False: there is none. Reading clears an overrun as well. */
static inline bool serial_line_receive(uint8_t *byte)
{
    if ((USART3->SR & (USART_SR_RXNE | USART_SR_ORE)) == 0) {
        return false;
    }
    *byte = (uint8_t)USART3->DR;
    return true;
}

static inline bool serial_line_is_free(void)
{
    return (USART3->SR & USART_SR_TXE) != 0;
}

static inline void serial_line_send(uint8_t byte)
{
    USART3->DR = byte;
}

#endif

/* SPDX-License-Identifier: Apache-2.0 */
/* serial_line.h: USART2 with its FIFO of eight bytes either way (RM0440 section 37.5), for
 * serial.c. */
#ifndef STM32G431_SERIAL_LINE_H
#define STM32G431_SERIAL_LINE_H

#include <stdbool.h>
#include <stdint.h>

#include "clock.h"
#include "registers/rcc.h"
#include "registers/usart.h"

enum { SERIAL_LINE_HOLDS = 8 }; /* received bytes */

static inline void serial_line_start(uint32_t bit_rate)
{
    RCC->APB1ENR1 |= RCC_APB1ENR1_USART2EN;
    (void)RCC->APB1ENR1;
    USART2->BRR = (clock_core_Hz() + bit_rate / 2U) / bit_rate; /* 37.5.8, 16 samples a bit */
    USART2->CR1 = USART_CR1_FIFOEN | USART_CR1_TE | USART_CR1_RE | USART_CR1_RXNEIE;
    USART2->CR1 |= USART_CR1_UE;
}

/* False: there is none. An overrun is cleared: without that its interrupt would come for ever. */
static inline bool serial_line_receive(uint8_t *byte)
{
    USART2->ICR = USART_ICR_ORECF;
    if ((USART2->ISR & USART_ISR_RXNE) == 0) {
        return false;
    }
    *byte = (uint8_t)USART2->RDR;
    return true;
}

static inline bool serial_line_is_free(void)
{
    return (USART2->ISR & USART_ISR_TXE) != 0;
}

static inline void serial_line_send(uint8_t byte)
{
    USART2->TDR = byte;
}

#endif

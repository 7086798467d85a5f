/* SPDX-License-Identifier: Apache-2.0 */
/* usart.h: serial line; RM0440 section 37.8. */
#ifndef STM32G431_REGISTERS_USART_H
#define STM32G431_REGISTERS_USART_H

#include <stdint.h>

typedef struct {
    volatile uint32_t CR1;
    volatile uint32_t CR2;
    volatile uint32_t CR3;
    volatile uint32_t BRR;
    volatile uint32_t GTPR;
    volatile uint32_t RTOR;
    volatile uint32_t RQR;
    volatile uint32_t ISR;
    volatile uint32_t ICR;
    volatile uint32_t RDR;
    volatile uint32_t TDR;
    volatile uint32_t PRESC;
} usart_registers_t;

#define USART2 ((usart_registers_t *)0x40004400U)

#define USART_CR1_UE (1U << 0)
#define USART_CR1_RE (1U << 2)
#define USART_CR1_TE (1U << 3)
#define USART_CR3_DMAR (1U << 6)
#define USART_CR3_DMAT (1U << 7)

#endif

/* SPDX-License-Identifier: Apache-2.0 */
/* usart.h: serial line; RM0090 section 30.6. */
#ifndef STM32F405_REGISTERS_USART_H
#define STM32F405_REGISTERS_USART_H

#include <stdint.h>

typedef struct {
    volatile uint32_t SR;  /* 30.6.1 */
    volatile uint32_t DR;  /* 30.6.2 */
    volatile uint32_t BRR; /* 30.6.3 */
    volatile uint32_t CR1; /* 30.6.4 */
    volatile uint32_t CR2;
    volatile uint32_t CR3;
    volatile uint32_t GTPR;
} usart_registers_t;

#define USART3 ((usart_registers_t *)0x40004800U)

#define USART_CR1_RE (1U << 2)
#define USART_CR1_TE (1U << 3)
#define USART_CR1_UE (1U << 13)
#define USART_CR3_DMAR (1U << 6)
#define USART_CR3_DMAT (1U << 7)

#endif

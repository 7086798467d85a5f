/* SPDX-License-Identifier: Apache-2.0 */
/* gpio_layout.h: a port of general-purpose input and output on both chips; RM0090 section 8.4
 * (numbers below), RM0440 section 9.4. Two bits a pin in MODER, OSPEEDR and PUPDR, four in AFR. */
#ifndef STM32_REGISTERS_GPIO_LAYOUT_H
#define STM32_REGISTERS_GPIO_LAYOUT_H

#include <stdint.h>

typedef struct {
    volatile uint32_t MODER;   /* 8.4.1 */
    volatile uint32_t OTYPER;  /* 8.4.2 */
    volatile uint32_t OSPEEDR; /* 8.4.3 */
    volatile uint32_t PUPDR;   /* 8.4.4 */
    volatile uint32_t IDR;     /* 8.4.5 */
    volatile uint32_t ODR;     /* 8.4.6 */
    volatile uint32_t BSRR;    /* 8.4.7 */
    volatile uint32_t LCKR;
    volatile uint32_t AFRL; /* 8.4.9: pins 0 .. 7 */
    volatile uint32_t AFRH; /* 8.4.10: pins 8 .. 15 */
} gpio_registers_t;

#endif

/* SPDX-License-Identifier: Apache-2.0 */
/* gpio.h: the ports of general-purpose input and output; RM0090 table 1. */
#ifndef STM32F405_REGISTERS_GPIO_H
#define STM32F405_REGISTERS_GPIO_H

#include "registers/gpio_layout.h"

#define GPIOA ((gpio_registers_t *)0x40020000U)
#define GPIOB ((gpio_registers_t *)0x40020400U)
#define GPIOC ((gpio_registers_t *)0x40020800U)
#define GPIOD ((gpio_registers_t *)0x40020C00U)

#endif

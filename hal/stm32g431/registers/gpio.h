/* SPDX-License-Identifier: Apache-2.0 */
/* gpio.h: the ports of general-purpose input and output; RM0440 table 3. */
#ifndef STM32G431_REGISTERS_GPIO_H
#define STM32G431_REGISTERS_GPIO_H

#include "registers/gpio_layout.h"

#define GPIOA ((gpio_registers_t *)0x48000000U)
#define GPIOB ((gpio_registers_t *)0x48000400U)
#define GPIOC ((gpio_registers_t *)0x48000800U)
#define GPIOF ((gpio_registers_t *)0x48001400U)

#endif

/* SPDX-License-Identifier: Apache-2.0 */
/*
 * gpio.h: pins as values. Background context; gpio_read() and gpio_write() from any.
 */
#ifndef STM32_GPIO_H
#define STM32_GPIO_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "registers/gpio.h"

typedef struct {
    gpio_registers_t *port; /* NULL: the board has no such pin */
    uint8_t number;         /* 0 .. 15 */
} pin_t;

#define PIN_NONE ((pin_t){NULL, 0})

static inline bool pin_is_wired(pin_t pin)
{
    return pin.port != NULL;
}

typedef enum { GPIO_PULL_NONE = 0, GPIO_PULL_UP = 1, GPIO_PULL_DOWN = 2 } gpio_pull_t;

/* Clocks of the ports that the board uses; before any other function here. */
void gpio_init(void);

void gpio_make_analog(pin_t pin);
void gpio_make_input(pin_t pin, gpio_pull_t pull);
void gpio_make_output(pin_t pin, bool level);
/* function: number of the alternate function, 0 .. 15. Push-pull, fast edges. */
void gpio_make_alternate(pin_t pin, uint32_t function, gpio_pull_t pull);

bool gpio_read(pin_t pin);
void gpio_write(pin_t pin, bool level);

#endif

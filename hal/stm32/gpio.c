/* SPDX-License-Identifier: Apache-2.0 */
#include "gpio.h"

#include "clock.h"

enum { MODE_INPUT = 0, MODE_OUTPUT = 1, MODE_ALTERNATE = 2, MODE_ANALOG = 3 };
enum { SPEED_LOW = 0, SPEED_HIGH = 2 };

static void set_two_bits(volatile uint32_t *reg, pin_t pin, uint32_t value)
{
    const uint32_t shift = 2U * pin.number;
    *reg = (*reg & ~(3U << shift)) | (value << shift);
}

void gpio_init(void)
{
    clock_start_pins();
}

void gpio_make_analog(pin_t pin)
{
    set_two_bits(&pin.port->PUPDR, pin, GPIO_PULL_NONE);
    set_two_bits(&pin.port->MODER, pin, MODE_ANALOG);
}

void gpio_make_input(pin_t pin, gpio_pull_t pull)
{
    set_two_bits(&pin.port->PUPDR, pin, (uint32_t)pull);
    set_two_bits(&pin.port->MODER, pin, MODE_INPUT);
}

void gpio_make_output(pin_t pin, bool level)
{
    gpio_write(pin, level); /* first, so that the pin never shows the other level */
    set_two_bits(&pin.port->OSPEEDR, pin, SPEED_LOW);
    set_two_bits(&pin.port->MODER, pin, MODE_OUTPUT);
}

void gpio_make_alternate(pin_t pin, uint32_t function, gpio_pull_t pull)
{
    volatile uint32_t *const select = pin.number < 8 ? &pin.port->AFRL : &pin.port->AFRH;
    const uint32_t shift = 4U * (pin.number & 7U);
    *select = (*select & ~(0xFU << shift)) | (function << shift);
    set_two_bits(&pin.port->PUPDR, pin, (uint32_t)pull);
    set_two_bits(&pin.port->OSPEEDR, pin, SPEED_HIGH);
    set_two_bits(&pin.port->MODER, pin, MODE_ALTERNATE);
}

bool gpio_read(pin_t pin)
{
    return ((pin.port->IDR >> pin.number) & 1U) != 0;
}

void gpio_write(pin_t pin, bool level)
{
    pin.port->BSRR = 1U << (pin.number + (level ? 0U : 16U));
}

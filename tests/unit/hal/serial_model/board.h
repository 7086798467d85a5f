/* SPDX-License-Identifier: Apache-2.0 */
/* board.h: pins for hal/stm32/serial.c on the host, which does nothing with them. */
#ifndef SERIAL_MODEL_BOARD_H
#define SERIAL_MODEL_BOARD_H

enum { BOARD_SERIAL_TRANSMIT, BOARD_SERIAL_RECEIVE, BOARD_AF_SERIAL = 7, GPIO_PULL_UP = 1 };

static inline void gpio_init(void) {}

static inline void gpio_make_alternate(int pin, int function, int pull)
{
    (void)pin;
    (void)function;
    (void)pull;
}

#endif

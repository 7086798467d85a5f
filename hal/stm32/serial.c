/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The shell's line (serial_line.h of the chip). Received bytes come by interrupt into a ring; bytes
 * to send are handed over as the line takes them, because their source is the background's own
 * buffer.
 */
#include "hal/serial.h"

#include "board.h"
#include "interrupts.h"
#include "ring.h"
#include "serial_line.h"
#include "vectors.h"

static ring_t incoming;

void serial_init(uint32_t bit_rate)
{
    gpio_init();
    gpio_make_alternate(BOARD_SERIAL_TRANSMIT, BOARD_AF_SERIAL, GPIO_PULL_UP);
    gpio_make_alternate(BOARD_SERIAL_RECEIVE, BOARD_AF_SERIAL, GPIO_PULL_UP);
    serial_line_start(bit_rate);
    interrupts_enable(INTERRUPT_SERIAL, PRIORITY_SERIAL);
}

void serial_handler(void)
{
    uint8_t byte;
    for (int i = 0; i < SERIAL_LINE_HOLDS && serial_line_receive(&byte); i++) {
        (void)ring_put(&incoming, byte);
    }
}

uint32_t serial_write(const char *bytes, uint32_t size)
{
    uint32_t accepted = 0;
    while (accepted < size && serial_line_is_free()) {
        serial_line_send((uint8_t)bytes[accepted]);
        accepted++;
    }
    return accepted;
}

bool serial_read(uint8_t *byte)
{
    return ring_get(&incoming, byte);
}

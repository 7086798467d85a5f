/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The shell's line (serial_line.h of the chip). DMA moves every byte between the line and two
 * buffers, so that no byte costs an interrupt, and none is lost while the core waits for the flash.
 */
#include "hal/serial.h"

#include <stdatomic.h>

#include "board.h"
#include "serial_line.h"

/* INCOMING_BYTES: 22 ms at 115 200 bit/s. Whatever the background leaves longer is overwritten. */
enum { INCOMING_BYTES = 256, OUTGOING_BYTES = 64 };

static volatile uint8_t incoming[INCOMING_BYTES];
static uint8_t outgoing[OUTGOING_BYTES];
static uint32_t delivered; /* index of the next byte of incoming[] to be delivered */

void serial_init(uint32_t bit_rate)
{
    gpio_init();
    gpio_make_alternate(BOARD_SERIAL_TRANSMIT, BOARD_AF_SERIAL, GPIO_PULL_UP);
    gpio_make_alternate(BOARD_SERIAL_RECEIVE, BOARD_AF_SERIAL, GPIO_PULL_UP);
    serial_line_start(bit_rate, incoming, INCOMING_BYTES, outgoing);
}

uint32_t serial_write(const char *bytes, uint32_t size)
{
    if (size == 0 || !serial_line_is_free()) {
        return 0;
    }
    const uint32_t accepted = size < OUTGOING_BYTES ? size : OUTGOING_BYTES;
    for (uint32_t i = 0; i < accepted; i++) {
        outgoing[i] = (uint8_t)bytes[i];
    }
    atomic_thread_fence(memory_order_release); /* the bytes are in memory before DMA reads them */
    serial_line_send(accepted);
    return accepted;
}

bool serial_read(uint8_t *byte)
{
    if ((delivered + serial_line_receive_left()) % INCOMING_BYTES == 0) {
        return false;
    }
    *byte = incoming[delivered];
    delivered = (delivered + 1U) % INCOMING_BYTES;
    return true;
}

/* SPDX-License-Identifier: Apache-2.0 */
/*
 * serial.h: one asynchronous serial line, 8 data bits, no parity, for banner, status and shell.
 *
 * Never blocks. Background context only.
 */
#ifndef HAL_SERIAL_H
#define HAL_SERIAL_H

#include <stdbool.h>
#include <stdint.h>

/* Works also after time_init() failed: the bit rate is made from the clock that really runs. */
void serial_init(uint32_t bit_rate);

/* Queues up to `size` bytes and returns how many were taken; the caller offers the rest again
 * or drops it. */
uint32_t serial_write(const char *bytes, uint32_t size);

/* The oldest received byte not yet delivered; false if there is none. Bytes are lost when
 * the buffer is full. */
bool serial_read(uint8_t *byte);

#endif

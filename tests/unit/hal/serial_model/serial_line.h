/* SPDX-License-Identifier: Apache-2.0 */
/* serial_line.h: instead of a chip's: what its DMA is told, for test_serial.c. */
#ifndef SERIAL_MODEL_SERIAL_LINE_H
#define SERIAL_MODEL_SERIAL_LINE_H

#include <stdbool.h>
#include <stdint.h>

typedef struct {
    uint32_t bit_rate;
    volatile uint8_t *incoming;
    uint32_t size, left; /* of incoming[] */
    const uint8_t *outgoing;
    uint32_t sending; /* bytes; 0: the line is free */
} serial_model_t;

extern serial_model_t line;

static inline void serial_line_start(uint32_t bit_rate, volatile uint8_t *incoming, uint32_t size,
                                     const uint8_t *outgoing)
{
    const serial_model_t started = {.bit_rate = bit_rate,
                                    .incoming = incoming,
                                    .size = size,
                                    .left = size,
                                    .outgoing = outgoing};
    line = started;
}

static inline uint32_t serial_line_receive_left(void)
{
    return line.left;
}

static inline bool serial_line_is_free(void)
{
    return line.sending == 0;
}

static inline void serial_line_send(uint32_t count)
{
    line.sending = count;
}

#endif

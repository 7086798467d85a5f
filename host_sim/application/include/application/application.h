/* SPDX-License-Identifier: Apache-2.0 */
/*
 * application.h: the whole application on its simulated board as a library, one wheel a copy.
 *
 * The application's data are static, because interrupts have no other way to find them; each copy
 * of the library that is loaded has its own (loader.c). Only application_entry() can be seen from
 * outside.
 */
#ifndef APPLICATION_APPLICATION_H
#define APPLICATION_APPLICATION_H

#include <stdint.h>

#include "application/recording.h"
#include "bench/board.h"

/* Of what crosses the border: library and engine must be of the same sources. */
typedef struct {
    uint32_t config, fast_input, fast_output, slow_input, slow_output, step;
} application_sizes_t;

#define APPLICATION_SIZES                                                                          \
    {                                                                                              \
        sizeof(config_t), sizeof(fast_input_t), sizeof(fast_output_t), sizeof(slow_input_t),       \
            sizeof(slow_output_t), sizeof(hubsim_step_t)                                           \
    }

typedef struct {
    application_sizes_t sizes;
    board_t *board;            /* the copy's own */
    wheel_coupling_t coupling; /* for wheel_t.coupling */
    recording_t *recording;    /* of its steps */
    /* Power on with this configuration and a motor at rest. */
    void (*start)(board_t *board, const config_t *config);
    /* A frame of another node on the bus, the serial line, and packets of the service protocol
     * (host/port.h). */
    void (*can_send)(const can_frame_t *frame);
    uint32_t (*serial_take)(char *bytes, uint32_t size);
    void (*serial_put)(const char *bytes, uint32_t size);
    bool (*packet_send)(const packet_t *packet);
    bool (*packet_receive)(packet_t *packet);
} application_t;

const application_t *application_entry(void);

#endif

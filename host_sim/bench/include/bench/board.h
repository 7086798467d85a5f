/* SPDX-License-Identifier: Apache-2.0 */
/*
 * board.h: the whole application on its simulated board (hal/host) as the controller of one wheel.
 *
 *     wheel's plant -> host_sample_t -> hal/ -> interrupts, double buffers -> controller -> hal/
 *         -> wheel's bridge
 *     demand, battery limits -> CAN frames in -> main loop -> CAN frames out -> hydraulic brake,
 *         mode, reasons
 *
 * Bridge and sensors are connected as the two steps are: sampled at the top, acting from the next
 * one on. What comes by CAN is what a vehicle has: whole steps of hubfoc.dbc, in the messages'
 * cycles, end-to-end protected. A demand older than its message's cycle is not sent. Of
 * slow_output_t only what is on CAN is known; the rest stays zero.
 *
 * The application is one a process (interrupts have no other way to find their data), so is the
 * board.
 */
#ifndef BENCH_BOARD_H
#define BENCH_BOARD_H

#include "bench/wheel.h"
#include "comms/messages.h"
#include "hal/can.h"
#include "host/port.h"

enum { BOARD_QUEUED_MAX = 4 };

typedef struct {
    messages_wheel_t wheel;
    host_sample_t sample;   /* what the sensors see at this top */
    fast_output_t active;   /* what the bridge does from this top on */
    slow_output_t received; /* last output received from the wheel */
    e2e_receiver_t state_link, brake_link;
    uint32_t now_ms;
    uint8_t demand_counter, battery_counter, peak_counter, hydraulic_counter;
    can_frame_t queued[BOARD_QUEUED_MAX]; /* to the wheel in this millisecond */
    uint32_t queued_count;
} board_t;

/* Boots the application with this configuration and a motor at rest. */
void board_start(board_t *board, const config_t *config);

/* For wheel_t.coupling. `board` has to stay where it is. */
wheel_coupling_t board_coupling(board_t *board);

#endif

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
 * one on.
 *
 * The application is one a process (interrupts have no other way to find their data), so is the
 * board.
 */
#ifndef BENCH_BOARD_H
#define BENCH_BOARD_H

#include "bench/vehicle_can.h"
#include "bench/wheel.h"
#include "host/port.h"

enum { BOARD_TAPPED_MAX = 64 };

typedef struct {
    host_sample_t sample; /* what the sensors see at this top */
    fast_output_t active; /* what the bridge does from this top on */
    vehicle_can_t vehicle;
    fault_params_t fault; /* of the program and of the bus, all zero: none */
    bool has_restarted;   /* for the fault of that name */
    uint32_t reset_ms;    /* left of a restart */
    /* What was on this wheel's bus, from both sides, until somebody reads it; the rest is lost. */
    can_frame_t tapped[BOARD_TAPPED_MAX];
    uint32_t tapped_count;
    double bus_free_s; /* of the bus's time until now, that the wheel's frames may take */
} board_t;

/* Boots the application with this configuration and a motor at rest. */
void board_start(board_t *board, const config_t *config);

/* A reset of the core, which boots after duration_ms: until then bridge off and nothing sent.
 * Retained memory keeps its content unless the supply was away (RESET_POWER). */
void board_restart(board_t *board, reset_cause_t cause, uint32_t duration_ms);

/* For wheel_t.coupling. `board` has to stay where it is. */
wheel_coupling_t board_coupling(board_t *board);

#endif

/* SPDX-License-Identifier: Apache-2.0 */
/*
 * link.h: faults of the frames that a wheel receives. Between the vehicle and the wheel's slow step
 * lie the frames of hubfoc.dbc with their protection, sent by vehicle_can.h and received by the
 * node of comms/node.h, as in the application.
 *
 * Without such a fault the bench hands the values over directly, unrounded and without a delay; a
 * fault begins with a link on which all was well before.
 */
#ifndef BENCH_LINK_H
#define BENCH_LINK_H

#include <stdbool.h>
#include <stdint.h>

#include "bench/vehicle_can.h"
#include "comms/node.h"
#include "config/config.h"
#include "core/slow_messages.h"
#include "plant/fault.h"
#include "plant/random.h"

/* Frames within the longest delay: a Demand and a feedback every 10 ms, others every 100 ms. */
enum { LINK_FRAMES = 320 };

typedef struct {
    messages_frame_t frame;
    uint32_t sent_ms;
} link_sent_t;

/* All zero: no fault yet. */
typedef struct {
    bool active;
    uint32_t began_ms; /* on the clock of `can` */
    vehicle_can_t can;
    node_t node;
    link_sent_t sent[LINK_FRAMES];
    uint32_t first, count;          /* of `sent`: what is on its way, or recorded */
    messages_frame_t latest_demand; /* before the fault */
    uint32_t replayed;              /* index of the recorded frame that comes next */
    random_t random;
} link_t;

bool link_fault_present(const fault_params_t *params);

/* What the application's node is configured with, and its place on the bus. */
node_limits_t link_limits(const config_t *config);
messages_address_t link_address(const config_t *config);

/* Once per millisecond: in is what the vehicle would send now, and becomes what the wheel knows. */
void link_step(const fault_params_t *params, link_t *link, const config_t *config,
               slow_input_t *in);

/* Forgets the fault. */
void link_reset(link_t *link);

#endif

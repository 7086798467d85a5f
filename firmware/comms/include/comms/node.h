/* SPDX-License-Identifier: Apache-2.0 */
/*
 * node.h: one wheel's place on the bus: what the vehicle wants of it, and what it has to say when.
 * Pure: frames and time in, frames out; app/ carries them to and from the CAN controller.
 *
 * Hearing: a frame that is damaged, implausible, repeated, out of sequence or not yet trusted
 * (e2e.h) is counted and changes nothing. In particular it does not refresh wish.demand_time_ms, so
 * the demand grows old and config.brake.demand_timeout_ms does the rest: torque ramps down, nothing
 * is held. A pack whose battery management has never been heard is limited by the configuration;
 * once it was heard and falls silent, no charge goes back into it.
 *
 * Saying: each message in its cycle (hubfoc.dbc), the urgent ones first, one at a time, with the
 * newest values, as long as the CAN controller takes them. What finds no room stays due; nothing
 * queues up, and a counter moves only with a frame that left, so that on the other side a gap in it
 * means a frame lost on the bus.
 */
#ifndef COMMS_NODE_H
#define COMMS_NODE_H

#include <stdbool.h>
#include <stdint.h>

#include "comms/e2e.h"
#include "comms/messages.h"

enum {
    NODE_TIMEOUT_CYCLES = 5, /* of silence, then a sender has to qualify again */
    NODE_DEMAND_FORGOTTEN_ms =
        10000 /* longer than any timeout of the controller, shorter than the clock's wrap */
};

/* What the vehicle wants, for the slow step. */
typedef struct {
    messages_demand_t demand;
    messages_battery_t battery;
    uint32_t demand_time_ms; /* when the demand arrived */
    bool demand_known;       /* heard, and not so long ago that its time means nothing */
} node_wish_t;

typedef struct {
    messages_wheel_t wheel;
    node_wish_t wish;
    messages_battery_t pack; /* limits while no battery management has ever been heard */
    e2e_receiver_t demand;
    e2e_receiver_t battery;
    uint32_t foreign; /* frames under identifiers that are not for us */
    uint32_t due_ms[MESSAGES_SENT];
    uint8_t counter[MESSAGES_SENT];
    messages_kind_t offered; /* by the last node_next() */
} node_t;

/* pack: the configuration's limits of the whole pack. */
void node_init(node_t *node, messages_wheel_t wheel, messages_battery_t pack, uint32_t now_ms);

/* What a receive filter has to let through. */
void node_accepted(messages_wheel_t wheel, uint16_t identifiers[MESSAGES_HEARD]);

/* Background, often, also when nothing arrives. True if the wish has changed. */
bool node_tick(node_t *node, uint32_t now_ms);

/* One received frame. True if the wish has changed. */
bool node_hear(node_t *node, const messages_frame_t *frame, uint32_t now_ms);

/* The most urgent frame that is due; false if there is none. The same one again until node_sent().
 * The links' states and errors in `output` are filled in here. */
bool node_next(node_t *node, uint32_t now_ms, const messages_output_t *output,
               messages_frame_t *frame);

/* The frame of the last node_next() has found room. */
void node_sent(node_t *node, uint32_t now_ms);

/* Age of the demand for the controller; UINT32_MAX if there is none. */
uint32_t node_demand_age_ms(const node_wish_t *wish, uint32_t now_ms);

#endif

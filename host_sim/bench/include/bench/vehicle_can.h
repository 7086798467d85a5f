/* SPDX-License-Identifier: Apache-2.0 */
/*
 * vehicle_can.h: the vehicle's side of a wheel's CAN bus, for a controller that is reached by
 * frames only: the whole application, on its simulated board or in the flashable image.
 *
 * What comes by CAN is what a vehicle has: whole steps of hubfoc.dbc, in the messages' cycles,
 * end-to-end protected. A demand older than its message's cycle is not sent. Of slow_output_t only
 * what is on CAN is known; the rest stays zero.
 */
#ifndef BENCH_VEHICLE_CAN_H
#define BENCH_VEHICLE_CAN_H

#include <stdint.h>

#include "comms/messages.h"
#include "core/slow_messages.h"

enum { VEHICLE_CAN_QUEUED_MAX = 4 };

typedef struct {
    messages_address_t address;
    /* What was last received from the wheel, at first mode BOOT; without WheelBrake for five cycles
     * hydraulic_valid is false. */
    slow_output_t received;
    e2e_receiver_t link[MESSAGES_KINDS]; /* of what it sends */
    uint32_t now_ms;                     /* counted by the caller */
    uint8_t demand_counter, battery_counter, peak_counter, hydraulic_counter;
    messages_frame_t queued[VEHICLE_CAN_QUEUED_MAX]; /* to the wheel in this millisecond */
    uint32_t queued_count;
} vehicle_can_t;

void vehicle_can_init(vehicle_can_t *can, messages_address_t address);

/* Puts the messages of the vehicle and of the battery that are due at now_ms into `queued`. */
void vehicle_can_send(vehicle_can_t *can, const slow_input_t *in);

/* A frame that was on the bus; what does not come from the wheel, or damaged, changes nothing. */
void vehicle_can_receive(vehicle_can_t *can, const messages_frame_t *frame);

/* Once a millisecond: what has not come for five cycles is void. */
void vehicle_can_expire(vehicle_can_t *can);

#endif

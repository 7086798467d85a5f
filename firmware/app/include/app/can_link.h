/* SPDX-License-Identifier: Apache-2.0 */
/*
 * can_link.h: the pump between the CAN controller and this wheel's place on the bus. Background
 * context.
 *
 * What a frame means, whether it is to be trusted and when what is to be said is comms/node.h's
 * business; here frames are only carried, and the controller's outputs handed over.
 */
#ifndef APP_CAN_LINK_H
#define APP_CAN_LINK_H

#include <stdbool.h>
#include <stdint.h>

#include "comms/node.h"
#include "controller/controller.h"

typedef struct {
    node_t node;
} can_link_t;

/* pack: the configuration's limits, of the whole pack. False if the CAN controller is not on the
 * bus yet: nothing comes and nothing goes until it is, however late. */
bool can_link_init(can_link_t *link, messages_wheel_t wheel, messages_battery_t pack,
                   uint32_t now_ms);

/* Takes what has arrived; true if link->node.command has changed. */
bool can_link_receive(can_link_t *link, uint32_t now_ms);

/* Sends what is due, as far as there is room. */
void can_link_transmit(can_link_t *link, uint32_t now_ms, const messages_output_t *output);

/* What the wheel has to say; temperatures as the ports report them. */
messages_output_t can_link_output(const slow_output_t *output, int32_t winding_temperature_cC,
                                  int32_t switch_temperature_cC);

#endif

/* SPDX-License-Identifier: Apache-2.0 */
/*
 * can_link.h: moves frames between the CAN controller (hal/can.h) and the node (comms/node.h).
 * Background context, every pass. It does not look into frames.
 */
#ifndef APP_CAN_LINK_H
#define APP_CAN_LINK_H

#include <stdbool.h>
#include <stdint.h>

#include "comms/node.h"
#include "config/config.h"
#include "hal/can.h"

typedef struct {
    node_t node;
    bool has_service; /* XCP is on this bus */
    uint16_t service_identifier;
    bool service_received;
    can_frame_t service_command; /* the latest, not handed over yet */
} can_link_t;

/* Where a wheel of this vehicle is on the bus. */
messages_address_t can_link_address(const config_t *config, int32_t wheel);

/* What the configuration says about the messages. */
node_limits_t can_link_limits(const config_t *config);

/* service: the identifier of XCP commands, NULL: none. False if the CAN controller is not on the
 * bus yet; frames are exchanged as soon as it is. */
bool can_link_init(can_link_t *link, const config_t *config, const uint16_t *service,
                   uint32_t now_ms);

/* Processes received frames, at most eight a call, and what became of those sent; true if
 * link->node.command has changed. */
bool can_link_receive(can_link_t *link, uint32_t now_ms);

/* Once, an XCP command that came, valid until the next can_link_receive(); NULL: there is none. */
const can_frame_t *can_link_service(can_link_t *link);

/* Sends the frames that are due but for WheelEnergy, as many as the CAN controller takes. */
void can_link_transmit(can_link_t *link, uint32_t now_ms, const slow_output_t *output,
                       const wheel_temperatures_t *temperature);

/* Sends WheelEnergy, if it is due (node_energy_is_due()). */
void can_link_transmit_energy(can_link_t *link, uint32_t now_ms,
                              const messages_energy_t *since_start,
                              const messages_energy_t *for_life);

/* Sends WheelState alone, if it is due: of a slow loop that stands still. */
void can_link_transmit_state(can_link_t *link, uint32_t now_ms, const slow_output_t *output,
                             const wheel_temperatures_t *temperature);

/* Sends what a wheel without control says, if it is due: BOOT, and what it waits for. */
void can_link_transmit_boot(can_link_t *link, uint32_t now_ms, waits_for_t waits_for);

#endif

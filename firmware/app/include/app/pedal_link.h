/* SPDX-License-Identifier: Apache-2.0 */
/*
 * pedal_link.h: pedals wired to this controller: converter codes to the demand of this wheel
 * (pedals/pedals.h), and the message Demand to the other wheels of pedals.other_wheels.
 *
 * Without wired channels no function is called.
 */
#ifndef APP_PEDAL_LINK_H
#define APP_PEDAL_LINK_H

#include <stdbool.h>
#include <stdint.h>

#include "pedals/pedals.h"

/* Of the millisecond. */
typedef struct {
    pedals_state_t state;
    pedals_input_t in;
    pedals_output_t out; /* of the last step, wheel of share 1 */
} pedal_link_t;

/* Of the background. */
typedef struct {
    uint32_t sent_ms[CONFIG_WHEELS];
    uint8_t counter[CONFIG_WHEELS];
    bool pending[CONFIG_WHEELS]; /* the CAN controller has the frame */
} pedal_sender_t;

void pedal_link_init(pedal_link_t *link);

/* Millisecond context. in: demand and age as received by CAN; replaced by those of the pedals. */
void pedal_link_step(pedal_link_t *link, const config_t *config, slow_input_t *in);

void pedal_sender_init(pedal_sender_t *sender, uint32_t now_ms);

/* Background context: the frames that are due, as many as the CAN controller takes. A lost demand
 * is not sent; the other wheels then lose it as well. */
void pedal_sender_transmit(pedal_sender_t *sender, const config_t *config,
                           const pedals_output_t *pedals, uint32_t now_ms);

#endif

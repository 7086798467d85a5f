/* SPDX-License-Identifier: Apache-2.0 */
/*
 * service.h: moves XCP packets between CAN and the slave (comms/xcp.h), gives it the table of
 * signals (core/signals.h) and fresh seeds. Background context, every pass.
 *
 *     service.c         the protocol
 *     service_absent.c  for a port whose flash has no space for it: no identifier is received
 */
#ifndef APP_SERVICE_H
#define APP_SERVICE_H

#include <stdbool.h>
#include <stdint.h>

#include "comms/xcp.h"
#include "config/config.h"
#include "core/slow_messages.h"
#include "hal/can.h"

/* From SET_REQUEST's answer until the page is stored at the latest, whether it left or not. */
enum { SERVICE_ANSWER_ms = 100 };

typedef struct {
    xcp_t slave;
    uint16_t command_identifier;
    uint16_t answer_identifier;
    bool on_can;
    can_frame_t answer;
    bool answers;   /* the CAN controller has not taken it yet */
    bool under_way; /* it has one */
    bool stores;    /* the staging page, when the answer has left */
    uint32_t stores_since_ms;
} service_t;

/* What a tool measures and changes: of the latest slow step, and the pages. */
typedef struct {
    const slow_output_t *output;
    const slow_input_t *input;
    const config_t *in_force;
    config_t *staging; /* NULL: another uses its memory */
} service_view_t;

void service_init(service_t *service, const config_t *config);

/* True, with the identifier that the CAN controller is to accept, if there is XCP on CAN. */
bool service_accepts(const service_t *service, uint16_t *identifier);

/* One frame with that identifier. */
void service_receive(service_t *service, const service_view_t *view, const can_frame_t *frame,
                     uint32_t now_ms);

/* Timeouts, a fresh seed, the answer to the bus. */
void service_step(service_t *service, const service_view_t *view, uint32_t now_ms);

/* True until service_store(): the tool wants the staging page stored and used. */
bool service_wants_store(const service_t *service);

/* The caller's decision: an error, or it will do so as soon as service_store_is_due(). */
void service_store(service_t *service, xcp_error_t error, uint32_t now_ms);

/* True once, when the answer has left. */
bool service_store_is_due(service_t *service, uint32_t now_ms);

#endif

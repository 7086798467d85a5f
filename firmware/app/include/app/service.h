/* SPDX-License-Identifier: Apache-2.0 */
/*
 * service.h: moves XCP packets between CAN, a line of its own (hal/packets.h) or the console's
 * serial line, and the slave (comms/xcp.h), gives it the table of signals (core/signals.h) and
 * fresh seeds. Background context, every pass, but for the two steps.
 *
 * The latest CONNECT decides which of the three lines has the session; the others' commands are
 * not answered. On the serial line there is no DAQ. On CAN answers and DAQ share one identifier and
 * one place of the CAN controller, and DAQ has one packet a millisecond, 0.27 ms of the bus at
 * most.
 *
 *     service.c         the protocol; lists and scope are its own, one a program
 *     service_absent.c  for a port whose flash has no space for it: no identifier is received
 */
#ifndef APP_SERVICE_H
#define APP_SERVICE_H

#include <stdbool.h>
#include <stdint.h>

#include "comms/xcp.h"
#include "config/config.h"
#include "controller/controller.h"
#include "core/findings.h"
#include "core/slow_messages.h"
#include "hal/can.h"

/* From SET_REQUEST's answer until the page is stored at the latest, whether it left or not. */
enum { SERVICE_ANSWER_ms = 100 };

typedef enum { SERVICE_CAN, SERVICE_PACKETS, SERVICE_SERIAL, SERVICE_LINES } service_line_t;

/* What it reads besides the slow step's messages, and whom it tells what to do in a PWM period. */
typedef struct {
    const controller_fast_t *fast;
    const fast_input_t *fast_input;
    const findings_t *findings;
    /* What service_fast_step() is to be called with in each PWM period; NULL: it is not to be
     * called. */
    scope_t *volatile *recording;
} service_link_t;

typedef struct {
    xcp_t slave;
    uint16_t command_identifier;
    uint16_t answer_identifier;
    bool on_can;
    service_line_t line; /* of the session */
    const service_link_t *link;
    volatile uint16_t slow_steps; /* since the start, wrapping */
    volatile bool samples;        /* daq_slow_step() is to be called */
    can_frame_t answer;
    bool answers;         /* the CAN controller has not taken it yet */
    can_frame_t measured; /* of DAQ */
    bool measures;        /* likewise */
    bool under_way;       /* it has one */
    bool under_way_is_measured;
    uint8_t serial_answer[XCP_PACKET_BYTES];
    uint32_t serial_answer_bytes; /* 0: there is none */
    bool stores;                  /* the staging page, when the answer has left */
    uint32_t stores_since_ms;
} service_t;

/* What a tool measures and changes: of the latest slow step, and the pages. */
typedef struct {
    const slow_output_t *output;
    const slow_input_t *input;
    const config_t *in_force;
    config_t *staging; /* NULL: another uses its memory */
} service_view_t;

/* The memory of recordings (hal/memory.h) is the service's. link: stays where it is. */
void service_init(service_t *service, const config_t *config, const service_link_t *link);

/* Millisecond, after the slow step. */
void service_slow_step(service_t *service, const slow_output_t *output, const slow_input_t *input);

/* PWM period, after the fast step. */
void service_fast_step(scope_t *recording, const controller_fast_t *fast);

/* True, with the identifier that the CAN controller is to accept, if there is XCP on CAN. */
bool service_accepts(const service_t *service, uint16_t *identifier);

/* One frame with that identifier. */
void service_receive(service_t *service, const service_view_t *view, const can_frame_t *frame,
                     uint32_t now_ms);

/* One packet from the serial line. */
void service_receive_serial(service_t *service, const service_view_t *view, const uint8_t *packet,
                            uint32_t length, uint32_t now_ms);

/* Once, the answer to it; returns its bytes, 0: there is none. */
uint32_t service_serial_answer(service_t *service, const uint8_t **packet);

/* The serial line is the shell's again: a session on it ends. */
void service_end_serial(service_t *service, const service_view_t *view, uint32_t now_ms);

/* Timeouts, a fresh seed, the answer to the bus. */
void service_step(service_t *service, const service_view_t *view, uint32_t now_ms);

/* True until service_store(): the tool wants the staging page stored and used. */
bool service_wants_store(const service_t *service);

/* The caller's decision: an error, or it will do so as soon as service_store_is_due(). */
void service_store(service_t *service, xcp_error_t error, uint32_t now_ms);

/* True once, when the answer has left. */
bool service_store_is_due(service_t *service, uint32_t now_ms);

#endif

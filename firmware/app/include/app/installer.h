/* SPDX-License-Identifier: Apache-2.0 */
/*
 * installer.h: another configuration over the serial line: receive, check, replace.
 *
 *     installer_open()    from here on every byte of the line is the installer's
 *     installer_receive()    Intel HEX (comms/intel_hex.h) of one whole config_t
 *     installer_write()   bridge off for good, the sector is written; the caller then lets
 *                         the watchdog restart the core
 *
 * Nothing is touched before the last record is there and the firmware's own validator has accepted
 * the whole image. What has been running until then knows nothing of it. Background context.
 */
#ifndef APP_INSTALLER_H
#define APP_INSTALLER_H

#include <stdbool.h>
#include <stdint.h>

#include "comms/intel_hex.h"
#include "comms/text.h"
#include "config/config.h"
#include "config/validate.h"
#include "hal/flash.h"

enum { INSTALLER_TIMEOUT_ms = 3000 /* then the sender is taken to be gone */ };

typedef enum {
    INSTALLER_CLOSED = 0,
    INSTALLER_RECEIVING,
    INSTALLER_CANCELLED, /* ^C, or silence */
    INSTALLER_REFUSED,   /* `hex.problem` or `config_result` says why */
    INSTALLER_ACCEPTED
} installer_state_t;

typedef struct {
    installer_state_t state;
    intel_hex_t hex;
    config_result_t config_result;
    uint32_t received_ms;
    union { /* aligned as what it is */
        config_t config;
        uint8_t bytes[sizeof(config_t)];
    } image;
} installer_t;

void installer_init(installer_t *installer);

void installer_open(installer_t *installer, uint32_t now_ms);

/* Any byte while INSTALLER_RECEIVING. */
void installer_receive(installer_t *installer, uint8_t byte, uint32_t now_ms);

/* Often: notices silence. */
void installer_tick(installer_t *installer, uint32_t now_ms);

/* What became of it, one line; for all states but CLOSED and RECEIVING. */
void installer_text(const installer_t *installer, text_t *line);

/* Only with INSTALLER_ACCEPTED and the wheel at rest; no control step may run any more, because the
 * configuration that it reads is erased. False, and `line` says why, if the memory could not be
 * written. */
bool installer_write(const installer_t *installer, text_t *line);

#endif

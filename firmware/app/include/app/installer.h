/* SPDX-License-Identifier: Apache-2.0 */
/*
 * installer.h: replaces the configuration in flash by one received over the serial line.
 *
 *     installer_open()    from here on all received bytes go to the installer
 *     installer_receive()    Intel HEX (comms/intel_hex.h) of one whole config_t
 *     installer_write()   bridge off, the other sector is written (config_store.h); the caller then
 *                         stops feeding the watchdog, which restarts the core
 *
 * Control continues unchanged until the last record has arrived and board_check_config() has
 * accepted the whole image. Background context.
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

/* Reception is cancelled after this time without a byte. */
enum { INSTALLER_TIMEOUT_ms = 3000 };

typedef enum {
    INSTALLER_CLOSED = 0,
    INSTALLER_RECEIVING,
    INSTALLER_CANCELLED, /* ^C, or timeout */
    INSTALLER_REFUSED,   /* reason in `hex.problem` or `config_result` */
    INSTALLER_ACCEPTED
} installer_state_t;

typedef struct {
    installer_state_t state;
    intel_hex_t hex;
    config_result_t config_result;
    uint32_t received_ms; /* time of the latest byte */
    union {               /* aligned as config_t */
        config_t config;
        uint8_t bytes[sizeof(config_t)];
    } image;
} installer_t;

void installer_init(installer_t *installer);

/* The memory for the received image as the staging page of XCP; NULL while an image comes. */
config_t *installer_staging(installer_t *installer);

/* Seals the staging page with its checksum and validates it as a whole. */
config_result_t installer_check_staging(installer_t *installer);

/* The staging page, if it passes the check, is accepted as if it had been received. */
void installer_accept_staging(installer_t *installer);

/* Starts reception; the timeout counts from now_ms. */
void installer_open(installer_t *installer, uint32_t now_ms);

/* One received byte; to be called for every byte while the state is INSTALLER_RECEIVING. */
void installer_receive(installer_t *installer, uint8_t byte, uint32_t now_ms);

/* Background context, every pass: checks the timeout. */
void installer_tick(installer_t *installer, uint32_t now_ms);

/* Writes the result as one line. Not in the states CLOSED and RECEIVING. */
void installer_text(const installer_t *installer, text_t *line);

/* Writes the received configuration to flash. Preconditions: INSTALLER_ACCEPTED, the wheel at
 * standstill, and no control step runs any more, because the core stands still meanwhile. False,
 * with the reason in `line`, if the memory could not be written. */
bool installer_write(const installer_t *installer, text_t *line);

#endif

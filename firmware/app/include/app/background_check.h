/* SPDX-License-Identifier: Apache-2.0 */
/*
 * background_check.h: the memory while the controller runs: CRC of configuration with its tables,
 * and of the program; least free stack. Background context, a part at each call, so a whole round
 * takes size / BACKGROUND_CHECK_BYTES passes of the background.
 *
 * Independent of both interrupts: it uses nothing that they write. What it finds stays found and
 * withdraws the self-test, or the configuration if that is damaged, which ends torque in the next
 * slow step (modes.h). If the slow step does
 * not come either, the watchdog restarts the core, and the boot checks refuse.
 */
#ifndef APP_BACKGROUND_CHECK_H
#define APP_BACKGROUND_CHECK_H

#include <stdbool.h>
#include <stdint.h>

#include "config/config.h"
#include "hal/flash.h"

enum {
    BACKGROUND_CHECK_BYTES = 64, /* a pass: about 3 000 instructions */
    /* Fewer bytes that the stack never used are a fault: before it leaves RAM. */
    BACKGROUND_CHECK_STACK_bytes = 64
};

typedef struct {
    const config_t *config;
    flash_image_t firmware;
    uint32_t firmware_crc32;
    uint32_t at_bytes; /* of the image in work */
    uint32_t crc;
    bool in_firmware; /* else in the configuration */
    bool damaged;
    bool config_damaged; /* what is damaged is the configuration */
} background_check_t;

/* config: accepted at boot. */
void background_check_init(background_check_t *check, const config_t *config,
                           flash_image_t firmware, uint32_t firmware_crc32);

/* One part. False from the first damage on. */
bool background_check_step(background_check_t *check, uint32_t stack_free_bytes);

#endif

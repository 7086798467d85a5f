/* SPDX-License-Identifier: Apache-2.0 */
/*
 * config_store.h: the configuration in two erase sectors, of which one is in force and the other is
 * written: a supply that fails at any moment of an update leaves the old or the new one in force.
 *
 *     sector    image (config_t) ... 0xFF ... | sequence | ~sequence |
 *
 * The last two words are the mark. It is written after the whole image has been written and
 * compared; without it the sector is not in force. In force is the sector with the higher sequence
 * number. Sector A without a mark is the build's or a debug probe's configuration, sequence 0.
 *
 * A marked sector was complete once. If it is damaged later, the firmware refuses it and stays in
 * BOOT: the older configuration may be another motor's, so it is never taken instead.
 */
#ifndef APP_CONFIG_STORE_H
#define APP_CONFIG_STORE_H

#include <stdint.h>

#include "hal/flash.h"

enum { CONFIG_STORE_MARK_BYTES = 8 };

typedef struct {
    flash_image_t image; /* without the mark; to be checked by config_validate() */
    flash_sector_t sector;
    uint32_t sequence; /* 0: from the build */
} config_store_t;

/* The configuration in force. Any context; reads only. */
config_store_t config_store_in_force(void);

/* Writes another configuration into the other sector and puts it in force for the next start. The
 * one in force stays as it is until the last word, so control may go on reading it; but the core
 * stands still meanwhile (hal/flash.h). Anything but FLASH_OK: the old one stays in force.
 * Background context. */
flash_status_t config_store_replace(const void *bytes, uint32_t size_bytes);

#endif

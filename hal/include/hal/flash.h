/* SPDX-License-Identifier: Apache-2.0 */
/*
 * flash.h: the two images in non-volatile memory: the firmware, and the configuration in an erase
 * sector of its own.
 */
#ifndef HAL_FLASH_H
#define HAL_FLASH_H

#include <stdbool.h>
#include <stdint.h>

typedef struct {
    const void *begin;
    uint32_t size_bytes;
} flash_image_t;

typedef enum {
    FLASH_OK = 0,
    FLASH_TOO_LARGE,    /* more bytes than the sector holds; the sector was not erased */
    FLASH_ERASE_FAILED, /* the sector's content is undefined: the configuration will be refused at
                           the next boot */
    FLASH_WRITE_FAILED, /* likewise */
    FLASH_UNSUPPORTED   /* this port has no programmable memory */
} flash_status_t;

/* The whole sector that holds the configuration; an erased one reads as 0xFF. */
flash_image_t flash_configuration(void);

/* The constant part of the firmware, and its CRC-32 (IEEE 802.3) from the build. */
flash_image_t flash_firmware(void);
uint32_t flash_firmware_crc32(void);

/* Replaces the configuration. The core is stalled, or only feeds the watchdog, for up to a second,
 * without interrupts: only with the bridge off and the motor at rest, and followed by a restart.
 * Background context. */
flash_status_t flash_write_configuration(const void *bytes, uint32_t size_bytes);

#endif

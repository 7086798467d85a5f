/* SPDX-License-Identifier: Apache-2.0 */
/*
 * flash.h: non-volatile memory: the firmware's image, and four erase sectors that the application
 * writes. What is in them is the application's (app/config_store.h).
 *
 * Programming only clears bits. While a sector is erased or a word is programmed the core stands
 * still or executes from RAM without interrupts, up to a second for an erase: refused while the
 * bridge switches, because the timer would repeat its last compare values all that time. When the
 * supply fails meanwhile, the word or sector in work holds anything; the others are not touched.
 */
#ifndef HAL_FLASH_H
#define HAL_FLASH_H

#include <stdbool.h>
#include <stdint.h>

typedef struct {
    const void *begin;
    uint32_t size_bytes;
} flash_image_t;

/* What is programmed at once, on some chips with an error-correcting code over all of it: a unit of
 * which some was written cannot be written again before it is erased. */
enum { FLASH_UNIT_BYTES = 8 };

typedef enum {
    FLASH_CONFIGURATION_A = 0, /* where the build and a debug probe put the configuration */
    FLASH_CONFIGURATION_B,
    FLASH_JOURNAL_A,
    FLASH_JOURNAL_B,
    FLASH_SECTORS
} flash_sector_t;

typedef enum {
    FLASH_OK = 0,
    FLASH_TOO_LARGE,    /* beyond the sector's end, or not aligned; nothing was done */
    FLASH_BRIDGE_ON,    /* the bridge switches; nothing was done */
    FLASH_ERASE_FAILED, /* the sector's content is undefined */
    FLASH_WRITE_FAILED, /* the word in work is undefined, those behind it are as they were */
    FLASH_UNSUPPORTED   /* this port has no such sector */
} flash_status_t;

/* The whole sector; an erased one reads as 0xFF. Size 0: this port has none. */
flash_image_t flash_sector(flash_sector_t sector);

/* The constant part of the firmware, and its CRC-32 (IEEE 802.3) from the build. */
flash_image_t flash_firmware(void);
uint32_t flash_firmware_crc32(void);

/* The chip keeps running at a supply too low for its flash: its option bytes ask for a lower
 * brown-out level than this port needs. Any context. */
bool flash_brown_out_low(void);

/* Erases a sector; the watchdog is fed. Background context. */
flash_status_t flash_erase(flash_sector_t sector);

/* Programs from the lowest address up and compares; ends at the first word that is wrong.
 * `at_bytes` is a multiple of FLASH_UNIT_BYTES, `size_bytes` of four; the rest of the last unit
 * reads as 0xFF. Interrupts wait for one unit at a time, at most 0.2 ms. Background context. */
flash_status_t flash_program(flash_sector_t sector, uint32_t at_bytes, const void *words,
                             uint32_t size_bytes);

#endif

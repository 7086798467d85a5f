/* SPDX-License-Identifier: Apache-2.0 */
/* The simulated board's flash and RAM. */
#include <string.h>

#include "board.h"
#include "hal/flash.h"
#include "hal/memory.h"
#include "host/port.h"

enum { WINDOW_WORDS = 64, RETAINED_WORDS = 2048, SCOPE_WORDS = 4096 };

/* Stands for the firmware: a text whose CRC-32 is published (the catalogue's check value). */
static const char FIRMWARE[] = "123456789";
static const uint32_t FIRMWARE_CRC32 = 0xCBF43926U;

static _Alignas(8) uint8_t flash[FLASH_SECTORS][HOST_FLASH_BYTES];
static volatile uint32_t window[WINDOW_WORDS];
static volatile uint32_t retained[RETAINED_WORDS];
static volatile uint32_t scope[SCOPE_WORDS];

void board_reset_memory(const void *configuration, uint32_t size_bytes)
{
    memset(flash, 0xFF, sizeof flash);
    memcpy(flash[FLASH_CONFIGURATION_A], configuration,
           size_bytes < HOST_FLASH_BYTES ? size_bytes : HOST_FLASH_BYTES);
    board_forget();
}

/* After power-up: anything. */
void board_forget(void)
{
    for (uint32_t i = 0; i < RETAINED_WORDS; i++) {
        retained[i] = 0xA5A5A5A5U;
    }
}

flash_image_t flash_sector(flash_sector_t sector)
{
    const flash_image_t image = {flash[sector], HOST_FLASH_BYTES};
    return image;
}

flash_image_t flash_firmware(void)
{
    const flash_image_t image = {FIRMWARE, sizeof FIRMWARE - 1};
    return image;
}

uint32_t flash_firmware_crc32(void)
{
    return FIRMWARE_CRC32;
}

bool flash_brown_out_low(void)
{
    return false;
}

flash_status_t flash_erase(flash_sector_t sector)
{
    if (board_bridge_on()) {
        return FLASH_BRIDGE_ON;
    }
    memset(flash[sector], 0xFF, HOST_FLASH_BYTES);
    return FLASH_OK;
}

flash_status_t flash_program(flash_sector_t sector, uint32_t at_bytes, const void *words,
                             uint32_t size_bytes)
{
    if (at_bytes > HOST_FLASH_BYTES || size_bytes > HOST_FLASH_BYTES - at_bytes ||
        at_bytes % FLASH_UNIT_BYTES != 0 || size_bytes % 4U != 0) {
        return FLASH_TOO_LARGE;
    }
    if (board_bridge_on()) {
        return FLASH_BRIDGE_ON;
    }
    const uint8_t *from = words;
    bool good = true;
    for (uint32_t i = 0; i < size_bytes; i++) {
        uint8_t *const to = &flash[sector][at_bytes + i];
        *to = (uint8_t)(*to & from[i]);
        good = good && *to == from[i];
    }
    return good ? FLASH_OK : FLASH_WRITE_FAILED;
}

memory_window_t memory_unused(void)
{
    const memory_window_t unused = {window, WINDOW_WORDS};
    return unused;
}

void memory_mark_stack(void) {}

memory_window_t memory_retained(void)
{
    const memory_window_t kept = {retained, RETAINED_WORDS};
    return kept;
}

memory_window_t memory_scope(void)
{
    const memory_window_t own = {scope, SCOPE_WORDS};
    return own;
}

uint32_t memory_stack_free_bytes(void)
{
    return 4U * WINDOW_WORDS; /* the host's stack is not the board's */
}

/* SPDX-License-Identifier: Apache-2.0 */
/* The simulated board's flash and RAM. */
#include <string.h>

#include "board.h"
#include "hal/flash.h"
#include "hal/memory.h"
#include "host/port.h"

enum { WINDOW_WORDS = 64, RETAINED_WORDS = 2048 };

/* Stands for the firmware: a text whose CRC-32 is published (the catalogue's check value). */
static const char FIRMWARE[] = "123456789";
static const uint32_t FIRMWARE_CRC32 = 0xCBF43926U;

static _Alignas(8) uint8_t flash[HOST_FLASH_BYTES];
static volatile uint32_t window[WINDOW_WORDS];
static volatile uint32_t retained[RETAINED_WORDS];

static void program(const void *configuration, uint32_t size_bytes)
{
    memset(flash, 0xFF, sizeof flash);
    memcpy(flash, configuration, size_bytes < sizeof flash ? size_bytes : sizeof flash);
}

void board_reset_memory(const void *configuration, uint32_t size_bytes)
{
    program(configuration, size_bytes);
    for (uint32_t i = 0; i < RETAINED_WORDS; i++) {
        retained[i] = 0xA5A5A5A5U; /* after power-up: anything */
    }
}

flash_image_t flash_configuration(void)
{
    const flash_image_t image = {flash, sizeof flash};
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

flash_status_t flash_write_configuration(const void *bytes, uint32_t size_bytes)
{
    if (size_bytes > sizeof flash || size_bytes % 4U != 0) {
        return FLASH_TOO_LARGE;
    }
    program(bytes, size_bytes);
    return FLASH_OK;
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

uint32_t memory_stack_free_bytes(void)
{
    return 4U * WINDOW_WORDS; /* the host's stack is not the board's */
}

/* SPDX-License-Identifier: Apache-2.0 */
#include "app/config_store.h"

#include <stdbool.h>

/* Sequence numbers wrap: the later of two is less than half the range ahead. */
static bool is_later(uint32_t sequence, uint32_t than)
{
    return sequence != than && sequence - than < UINT32_C(0x80000000);
}

/* False if the sector has no mark. */
static bool mark_of(flash_sector_t sector, uint32_t *sequence)
{
    const flash_image_t whole = flash_sector(sector);
    if (whole.size_bytes < CONFIG_STORE_MARK_BYTES) {
        return false;
    }
    const uint32_t *mark = (const uint32_t *)whole.begin + whole.size_bytes / 4U - 2U;
    *sequence = mark[0];
    return mark[1] == ~mark[0];
}

config_store_t config_store_in_force(void)
{
    config_store_t found = {.sector = FLASH_CONFIGURATION_A, .sequence = 0};
    uint32_t a;
    uint32_t b;
    const bool a_marked = mark_of(FLASH_CONFIGURATION_A, &a);
    if (a_marked) {
        found.sequence = a;
    }
    if (mark_of(FLASH_CONFIGURATION_B, &b) && (!a_marked || is_later(b, a))) {
        found.sector = FLASH_CONFIGURATION_B;
        found.sequence = b;
    }
    found.image = flash_sector(found.sector);
    if (found.image.size_bytes >= CONFIG_STORE_MARK_BYTES) {
        found.image.size_bytes -= CONFIG_STORE_MARK_BYTES;
    }
    return found;
}

flash_status_t config_store_replace(const void *bytes, uint32_t size_bytes)
{
    const config_store_t old = config_store_in_force();
    const flash_sector_t to =
        old.sector == FLASH_CONFIGURATION_A ? FLASH_CONFIGURATION_B : FLASH_CONFIGURATION_A;
    const uint32_t sector_bytes = flash_sector(to).size_bytes;
    if (sector_bytes == 0) {
        return FLASH_UNSUPPORTED;
    }
    const uint32_t mark_at = sector_bytes - CONFIG_STORE_MARK_BYTES;
    if (size_bytes > mark_at) {
        return FLASH_TOO_LARGE;
    }
    /* Zero is the build's. */
    const uint32_t sequence = old.sequence + 1U == 0 ? 1U : old.sequence + 1U;
    const uint32_t mark[2] = {sequence, ~sequence};
    flash_status_t status = flash_erase(to);
    if (status == FLASH_OK) {
        status = flash_program(to, 0, bytes, size_bytes);
    }
    if (status == FLASH_OK) {
        status = flash_program(to, mark_at, mark, sizeof mark);
    }
    return status;
}

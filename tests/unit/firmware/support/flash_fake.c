/* SPDX-License-Identifier: Apache-2.0 */
#include "flash_fake.h"

#include <string.h>

flash_fake_t fake;

static uint32_t fake_random(void)
{
    fake.random = fake.random * 1664525U + 1013904223U; /* Numerical Recipes */
    return fake.random >> 16 | fake.random << 16;
}

void fake_deliver(const void *image, uint32_t size_bytes)
{
    memset(&fake, 0, sizeof fake);
    memset(fake.word, 0xFF, sizeof fake.word);
    memcpy(fake.word[FLASH_CONFIGURATION_A], image, size_bytes);
}

flash_image_t flash_sector(flash_sector_t sector)
{
    const flash_image_t image = {fake.word[sector], FAKE_BYTES};
    return image;
}

/* From `before` to `after`, in part: not at all, any of the bits, a few of them, all. */
static uint32_t in_part(uint32_t style, uint32_t before, uint32_t after)
{
    const uint32_t changes = before ^ after;
    switch (style & 3U) {
    case 0:
        return before;
    case 1:
        return before ^ (changes & fake_random());
    case 2:
        return before ^ (changes & fake_random() & fake_random() & fake_random());
    default:
        return after;
    }
}

static bool is_cut(void)
{
    fake.operations++;
    return fake.operations == fake.cut_at;
}

flash_status_t flash_erase(flash_sector_t sector)
{
    if (fake.bridge_on) {
        return FLASH_BRIDGE_ON;
    }
    const bool cut = is_cut();
    const uint32_t style = fake_random();
    for (uint32_t i = 0; i < FAKE_WORDS; i++) {
        fake.word[sector][i] = cut ? in_part(style, fake.word[sector][i], UINT32_MAX) : UINT32_MAX;
    }
    if (cut) {
        longjmp(fake.supply_lost, 1);
    }
    return fake.operations == fake.fails_at ? FLASH_ERASE_FAILED : FLASH_OK;
}

flash_status_t flash_program(flash_sector_t sector, uint32_t at_bytes, const void *words,
                             uint32_t size_bytes)
{
    if (at_bytes > FAKE_BYTES || size_bytes > FAKE_BYTES - at_bytes ||
        at_bytes % FLASH_UNIT_BYTES != 0 || size_bytes % 4U != 0) {
        return FLASH_TOO_LARGE;
    }
    for (uint32_t i = 0; i < size_bytes / 4U; i++) {
        uint32_t *const at = &fake.word[sector][at_bytes / 4U + i];
        uint32_t wanted;
        memcpy(&wanted, (const uint8_t *)words + (size_t)4 * i, sizeof wanted);
        if (fake.bridge_on) {
            return FLASH_BRIDGE_ON;
        }
        if (is_cut()) {
            *at = in_part(fake_random(), *at, *at & wanted);
            longjmp(fake.supply_lost, 1);
        }
        *at &= wanted;
        if (*at != wanted || fake.operations == fake.fails_at) {
            return FLASH_WRITE_FAILED;
        }
    }
    return FLASH_OK;
}

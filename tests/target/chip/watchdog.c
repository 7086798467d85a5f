/* SPDX-License-Identifier: Apache-2.0 */
/* The independent watchdog (RM0090 section 21, RM0440 section 44). */
#include "parts.h"

static const uint32_t KEY_RELOAD = 0xAAAA, KEY_ACCESS = 0x5555, KEY_START = 0xCCCC;

static void write_key(chip_t *chip, uint32_t key)
{
    const uint32_t divided = 4U << (chip_get(chip, CHIP_IWDG_PR) & 7U);
    const bool started = chip->watchdog_end != CHIP_NEVER;
    if (key == KEY_START || (key == KEY_RELOAD && started)) {
        chip->watchdog_end =
            chip->now + (chip_get(chip, CHIP_IWDG_RLR) + 1ULL) * divided * CHIP_LSI_TICKS;
    }
    *chip_at(chip, CHIP_IWDG_KR) = key;
}

bool chip_watchdog_write(chip_t *chip, uint32_t address, uint32_t value)
{
    if (address == CHIP_IWDG_KR) {
        write_key(chip, value);
        return true;
    }
    if (chip_get(chip, CHIP_IWDG_KR) != KEY_ACCESS) {
        chip_note(chip, "watchdog register written without its key");
    }
    *chip_at(chip, CHIP_IWDG_KR) = KEY_ACCESS;
    return false;
}

void chip_watchdog_events(chip_t *chip)
{
    if (chip->now >= chip->watchdog_end) {
        chip->watchdog_end = CHIP_NEVER;
        chip_request_reset(chip, CHIP_RESET_WATCHDOG);
    }
}

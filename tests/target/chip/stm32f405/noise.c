/* SPDX-License-Identifier: Apache-2.0 */
/* The generator of random numbers (RM0090 section 24): a value whenever it is looked for, without
 * errors of clock or seed. Of the time, so that a run is the same again. */
#include "parts.h"

static const uint64_t GOLDEN = 0x9E3779B97F4A7C15U; /* of SplitMix64: 2^64 over the golden ratio */

static bool is_on(const chip_t *chip)
{
    return (chip_get(chip, CHIP_RNG_CR) & CHIP_RNG_CR_RNGEN) != 0;
}

uint32_t chip_noise_read(chip_t *chip, uint32_t address)
{
    if (address == CHIP_RNG_SR && is_on(chip)) {
        return chip_get(chip, address) | CHIP_RNG_SR_DRDY;
    }
    if (address == CHIP_RNG_DR && is_on(chip)) {
        uint32_t *value = chip_at(chip, address);
        *value += (uint32_t)((chip->now + 1U) * GOLDEN >> 32);
        return *value;
    }
    return chip_get(chip, address);
}

bool chip_noise_write(chip_t *chip, uint32_t address, uint32_t value)
{
    (void)chip;
    (void)address;
    (void)value;
    return false; /* stored */
}

/* SPDX-License-Identifier: Apache-2.0 */
/* The memory protection unit, whose regions are kept and asked (Arm DDI 0403, B3.5). It raises no
 * fault: what it forbids is noted where the model looks at an access, which is when the program
 * writes the flash and when it begins a block of instructions in the RAM. */
#include <string.h>

#include "parts.h"

static const uint32_t RBAR_VALID = 1U << 4, RASR_ENABLE = 1, RASR_XN = 1U << 28;
static const uint32_t CTRL_ENABLE = 1, CTRL_HFNMIENA = 2, CTRL_PRIVDEFENA = 4;
enum { LEAST_LOG2 = 5, EIGHTHS_FROM_LOG2 = 8 };

void chip_mpu_reset(chip_t *chip)
{
    memset(&chip->mpu, 0, sizeof chip->mpu);
}

static unsigned log2_of(uint32_t attributes)
{
    return (attributes >> 1 & 0x1FU) + 1U;
}

static void write_attributes(chip_t *chip, uint32_t value)
{
    const unsigned log2 = log2_of(value);
    const uint32_t base = chip->mpu.base[chip->mpu.number];
    if ((value & RASR_ENABLE) != 0 && (log2 < LEAST_LOG2 || (base & ((1U << log2) - 1U)) != 0)) {
        chip_note(chip, "MPU: region %u of 2^%u bytes at 0x%08X", chip->mpu.number, log2, base);
    }
    if ((value & 0xFF00U) != 0 && log2 < EIGHTHS_FROM_LOG2) {
        chip_note(chip, "MPU: eighths of region %u, which is too small", chip->mpu.number);
    }
    chip->mpu.attributes[chip->mpu.number] = value;
}

bool chip_mpu_write(chip_t *chip, uint32_t address, uint32_t value)
{
    switch (address) {
    case CHIP_MPU_CTRL:
        chip->mpu.control = value;
        return true;
    case CHIP_MPU_RNR:
        chip->mpu.number = value % CHIP_MPU_REGIONS;
        return true;
    case CHIP_MPU_RBAR:
        if ((value & RBAR_VALID) != 0) {
            chip->mpu.number = value % CHIP_MPU_REGIONS;
        }
        chip->mpu.base[chip->mpu.number] = value & ~(uint32_t)0x1F;
        return true;
    case CHIP_MPU_RASR:
        write_attributes(chip, value);
        return true;
    default:
        return false;
    }
}

/* Region that decides: the last one with this address; CHIP_MPU_REGIONS: none. */
static unsigned region_of(const chip_t *chip, uint32_t address)
{
    unsigned region = CHIP_MPU_REGIONS;
    for (unsigned i = 0; i < CHIP_MPU_REGIONS; i++) {
        const uint32_t attributes = chip->mpu.attributes[i];
        const unsigned log2 = log2_of(attributes);
        const uint64_t offset = (uint64_t)address - chip->mpu.base[i];
        if ((attributes & RASR_ENABLE) == 0 || address < chip->mpu.base[i] || offset >> log2 != 0) {
            continue;
        }
        const unsigned eighth = (unsigned)(offset >> (log2 - 3U));
        if (log2 < EIGHTHS_FROM_LOG2 || (attributes >> 8 >> eighth & 1U) == 0) {
            region = i;
        }
    }
    return region;
}

/* B3.1: code, RAM and external memory can be executed. */
static bool default_map_lets(uint32_t address, chip_access_t access)
{
    return access != CHIP_EXECUTE || address < 0x40000000U ||
           (address >= 0x60000000U && address < 0xA0000000U);
}

bool chip_mpu_lets(const chip_t *chip, uint32_t address, chip_access_t access)
{
    const bool above = chip->nvic.active[EXCEPTION_NMI] || chip->nvic.active[EXCEPTION_HARD_FAULT];
    if ((chip->mpu.control & CTRL_ENABLE) == 0 ||
        (above && (chip->mpu.control & CTRL_HFNMIENA) == 0)) {
        return default_map_lets(address, access);
    }
    const unsigned region = region_of(chip, address);
    if (region == CHIP_MPU_REGIONS) {
        return (chip->mpu.control & CTRL_PRIVDEFENA) != 0 && default_map_lets(address, access);
    }
    const uint32_t attributes = chip->mpu.attributes[region];
    const uint32_t permission = attributes >> 24 & 7U; /* of privileged code, table B3-15 */
    const bool readable = permission != 0 && permission != 4;
    switch (access) {
    case CHIP_READ:
        return readable;
    case CHIP_WRITE:
        return permission >= 1 && permission <= 3;
    case CHIP_EXECUTE:
        return readable && (attributes & RASR_XN) == 0;
    }
    return false;
}

/* SPDX-License-Identifier: Apache-2.0 */
/* What the DMA controllers of both chips have alike: one byte or word moved over the buses. */
#include "parts.h"

static bool reaches(chip_t *chip, uint32_t memory)
{
    const bool good = memory - (uint32_t)CHIP_RAM_BASE < (uint32_t)CHIP_RAM_BYTES;
    if (!good) {
        chip_note(chip, "DMA: 0x%08X is no memory that it reaches", memory);
    }
    return good;
}

void chip_dma_put_word(chip_t *chip, uint32_t peripheral, uint32_t memory)
{
    uint32_t word = 0;
    if (reaches(chip, memory)) {
        (void)uc_mem_read(chip->core, memory, &word, sizeof word);
        chip_bus_write(chip, peripheral, word);
    }
}

void chip_dma_move(chip_t *chip, uint32_t peripheral, uint32_t memory, bool to_memory)
{
    if (!reaches(chip, memory)) {
        return;
    }
    if (to_memory) {
        const uint8_t byte = (uint8_t)chip_bus_read(chip, peripheral);
        (void)uc_mem_write(chip->core, memory, &byte, sizeof byte);
    } else {
        uint8_t byte = 0;
        (void)uc_mem_read(chip->core, memory, &byte, sizeof byte);
        chip_bus_write(chip, peripheral, byte);
    }
}

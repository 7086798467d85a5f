/* SPDX-License-Identifier: Apache-2.0 */
/* What the DMA controllers of both chips have alike: one byte moved over the buses. */
#include "parts.h"

void chip_dma_move(chip_t *chip, uint32_t peripheral, uint32_t memory, bool to_memory)
{
    if (memory - (uint32_t)CHIP_RAM_BASE >= (uint32_t)CHIP_RAM_BYTES) {
        chip_note(chip, "DMA: 0x%08X is no memory that it reaches", memory);
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

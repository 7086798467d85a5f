/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The non-maskable interrupt. A double word whose programming or erasing was cut off by the supply
 * can have two wrong bits, which raises it when the word is read (RM0440 section 3.3.9). In the
 * sectors of hal/flash.h that is expected: their readers check sums. In the program, and when the
 * crystal stops, it is a fault.
 */
#include "flash_cells.h"
#include "interrupts.h"
#include "registers/rcc.h"
#include "vectors.h"

extern const uint32_t link_configuration_a[], link_journal_end[];

static bool is_of_a_sector(uint32_t error)
{
    const uint32_t address = FLASH_CELLS_BEGIN + (error & FLASH_ECCR_ADDR_ECC);
    return (error & FLASH_ECCR_ECCD) != 0 && (error & FLASH_ECCR_SYSF_ECC) == 0 &&
           address >= (uint32_t)(uintptr_t)link_configuration_a &&
           address < (uint32_t)(uintptr_t)link_journal_end;
}

void flash_error_handler(void)
{
    if ((RCC->CIFR & RCC_CIFR_CSSF) == 0 && is_of_a_sector(FLASH->ECCR)) {
        FLASH->ECCR = FLASH_ECCR_ECCD; /* cleared by writing 1 */
        return;
    }
    fault_handler(); /* last, so that nothing is on the stack above the core's frame */
}

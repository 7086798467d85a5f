/* SPDX-License-Identifier: Apache-2.0 */
/* flash_cells.h: pages of 2 KiB and double words with an error-correcting code (RM0440 section
 * 3.3), for flash.c. */
#ifndef STM32G431_FLASH_CELLS_H
#define STM32G431_FLASH_CELLS_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/flash.h"
#include "registers/flash.h"

enum {
    FLASH_CELLS_WORDS = 2, /* programmed by one operation */
    FLASH_CELLS_PAGE_BYTES = 2048,
    FLASH_CELLS_CONTROL = 0
};
#define FLASH_CELLS_BEGIN 0x08000000U
#define FLASH_CELLS_ERRORS                                                                         \
    (FLASH_SR_OPERR | FLASH_SR_PROGERR | FLASH_SR_WRPERR | FLASH_SR_PGAERR | FLASH_SR_SIZERR |     \
     FLASH_SR_PGSERR)

/* How many operations erase a sector of that size. */
static inline uint32_t flash_cells_erases(uint32_t size_bytes)
{
    return size_bytes / FLASH_CELLS_PAGE_BYTES;
}

/* What is written to the control register for each of them. */
static inline uint32_t flash_cells_erase(flash_sector_t sector, uint32_t begin, uint32_t number)
{
    (void)sector;
    const uint32_t page = (begin - FLASH_CELLS_BEGIN) / FLASH_CELLS_PAGE_BYTES + number;
    return FLASH_CR_PER | page << FLASH_CR_PNB_Pos;
}

/* The flash can be read as long as the chip does not reset itself. */
static inline bool flash_cells_brown_out_low(void)
{
    return false;
}

#endif

/* SPDX-License-Identifier: Apache-2.0 */
/* flash_cells.h: erase sectors and programming of this chip's flash (RM0090 section 3.6), for
 * flash.c. */
#ifndef STM32F405_FLASH_CELLS_H
#define STM32F405_FLASH_CELLS_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/flash.h"
#include "registers/flash.h"

enum {
    FLASH_CELLS_WORDS = 1,               /* programmed by one operation */
    FLASH_CELLS_FIRST_SECTOR = 1,        /* the first of hal/flash.h, in its order; see link.ld */
    FLASH_CELLS_PARALLELISM_32_BITS = 2, /* allowed at 2.7 .. 3.6 V */
    FLASH_CELLS_CONTROL = FLASH_CELLS_PARALLELISM_32_BITS << FLASH_CR_PSIZE_Pos
};
#define FLASH_CELLS_ERRORS                                                                         \
    (FLASH_SR_OPERR | FLASH_SR_WRPERR | FLASH_SR_PGAERR | FLASH_SR_PGPERR | FLASH_SR_PGSERR)

/* How many operations erase a sector of that size. */
static inline uint32_t flash_cells_erases(uint32_t size_bytes)
{
    return size_bytes > 0 ? 1U : 0U;
}

/* What is written to the control register for each of them. */
static inline uint32_t flash_cells_erase(flash_sector_t sector, uint32_t begin, uint32_t number)
{
    (void)begin;
    (void)number;
    return FLASH_CR_SER | ((uint32_t)FLASH_CELLS_FIRST_SECTOR + (uint32_t)sector)
                              << FLASH_CR_SNB_Pos;
}

/* Code 0 is level 3, 2.7 V; 3, as delivered, is off: 1.7 V. */
static inline bool flash_cells_brown_out_low(void)
{
    return (FLASH->OPTCR & FLASH_OPTCR_BOR_LEV) != 0;
}

#endif

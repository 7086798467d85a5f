/* SPDX-License-Identifier: Apache-2.0 */
/* Erasing and programming (RM0090 section 3.6). */
#include "parts.h"

enum { WORD_us = 16, WORDS_PSIZE = 2, SECTORS = 12, SMALL_SECTOR_BYTES = 16 << 10 };
/* Typical, 32 bits at a time (data sheet, table 40). */
enum { ERASE_16_KIB_ms = 250, ERASE_64_KIB_ms = 550, ERASE_128_KIB_ms = 1000 };
/* The sectors that the program may write; the first and those behind them hold the program. */
enum { FIRST_FREE_SECTOR = 1, LAST_FREE_SECTOR = 4 };
/* The description's reset value is not the chip's (3.9.10). */
static const uint32_t OPTIONS_AS_DELIVERED = 0x0FFFAAED;
static const uint32_t FIRST_KEY = 0x45670123, SECOND_KEY = 0xCDEF89AB;

void chip_flash_reset(chip_t *chip)
{
    chip->flash.keys = 0;
    chip->flash.busy = 0;
    chip->flash.fixes = 0;
}

static bool is_locked(const chip_t *chip)
{
    return (chip_get(chip, CHIP_FLASH_CR) & CHIP_FLASH_CR_LOCK) != 0;
}

/* Table 5: four of 16 KiB, one of 64, seven of 128. */
static uint32_t sector_begin(uint32_t sector)
{
    if (sector <= 4) {
        return sector * SMALL_SECTOR_BYTES;
    }
    return (sector - 4U) * (128U << 10);
}

static uint32_t erase_ms(uint32_t sector)
{
    return sector < 4 ? ERASE_16_KIB_ms : (sector == 4 ? ERASE_64_KIB_ms : ERASE_128_KIB_ms);
}

static void erase(chip_t *chip, uint32_t sector)
{
    if (sector >= SECTORS) {
        chip_note(chip, "erase of sector %u", sector);
        return;
    }
    if (sector < FIRST_FREE_SECTOR || sector > LAST_FREE_SECTOR) {
        chip_note(chip, "erase of sector %u, which holds the program", sector);
    }
    const uint32_t begin = CHIP_FLASH_BASE + sector_begin(sector);
    const uint32_t end = CHIP_FLASH_BASE + sector_begin(sector + 1U);
    chip_cells_check_stall(chip, "erase");
    const bool cut = chip_cells_cut(chip);
    const uint32_t style = cut ? chip_cells_style(chip) : 0;
    for (uint32_t at = begin; at < end; at += 4U) {
        const uint32_t before = chip_cells_word(chip, at);
        chip_cells_set(chip, at,
                       before | (cut ? chip_cells_partly(chip, style, ~before) : ~before));
    }
    chip->flash.busy = chip->now + erase_ms(sector) * 1000ULL * CHIP_TICKS_PER_US;
}

static void write_control(chip_t *chip, uint32_t value)
{
    if (is_locked(chip)) {
        chip_note(chip, "FLASH_CR written while it is locked");
        return;
    }
    if (chip->now < chip->flash.busy) {
        chip_note(chip, "FLASH_CR written during an operation");
    }
    *chip_at(chip, CHIP_FLASH_CR) = value & ~CHIP_FLASH_CR_STRT;
    if ((value & CHIP_FLASH_CR_STRT) != 0 && (value & CHIP_FLASH_CR_SER) != 0) {
        erase(chip, chip_field(chip, CHIP_FLASH_CR, CHIP_FLASH_CR_SNB));
    }
    if ((value & CHIP_FLASH_CR_LOCK) != 0) {
        chip->flash.keys = 0;
    }
}

bool chip_flash_register(chip_t *chip, uint32_t address, uint32_t value)
{
    switch (address) {
    case CHIP_FLASH_KEYR:
        if (chip->flash.keys == 0 && value == FIRST_KEY) {
            chip->flash.keys = 1;
        } else if (chip->flash.keys == 1 && value == SECOND_KEY) {
            chip->flash.keys = 2;
            *chip_at(chip, CHIP_FLASH_CR) &= ~CHIP_FLASH_CR_LOCK;
        } else {
            chip_note(chip, "wrong key sequence for the flash");
            chip->flash.keys = UINT32_MAX; /* locked until the next reset */
        }
        return true;
    case CHIP_FLASH_CR:
        write_control(chip, value);
        return true;
    case CHIP_FLASH_SR: /* cleared by writing 1 */
        *chip_at(chip, address) &= ~value;
        return true;
    default:
        return false;
    }
}

uint32_t chip_flash_read(chip_t *chip, uint32_t address)
{
    const uint32_t value = chip_get(chip, address);
    if (address == CHIP_FLASH_OPTCR) { /* level 3 of the brown-out reset has code 0 */
        return OPTIONS_AS_DELIVERED & ~(chip->fault.brown_out_off ? 0U : CHIP_FLASH_OPTCR_BOR_LEV);
    }
    return address == CHIP_FLASH_SR && chip->now < chip->flash.busy ? value | CHIP_FLASH_SR_BSY
                                                                    : value;
}

/* Before the store is carried out; chip_flash_settle() puts there what the flash makes of it. */
void chip_flash_program(chip_t *chip, uint32_t address, uint32_t size, uint32_t value)
{
    const uint32_t control = chip_get(chip, CHIP_FLASH_CR);
    const uint32_t at = address & ~3U;
    const uint32_t before = chip_cells_word(chip, at);
    uint32_t after = before;
    if (is_locked(chip) || (control & CHIP_FLASH_CR_PG) == 0 || size != 4 ||
        chip_field(chip, CHIP_FLASH_CR, CHIP_FLASH_CR_PSIZE) != WORDS_PSIZE) {
        chip_note(chip, "store of %u bytes to the flash at 0x%08X", size, address);
        *chip_at(chip, CHIP_FLASH_SR) |= CHIP_FLASH_SR_PGSERR;
    } else {
        chip_cells_check_stall(chip, "programming");
        after = before & value; /* bits are only ever cleared */
        if (chip_cells_cut(chip)) {
            after = before ^ chip_cells_partly(chip, chip_cells_style(chip), before ^ after);
        }
        chip->flash.busy = chip->now + WORD_us * CHIP_TICKS_PER_US;
    }
    chip_cells_fix(chip, at, after);
}

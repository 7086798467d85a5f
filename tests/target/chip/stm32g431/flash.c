/* SPDX-License-Identifier: Apache-2.0 */
/* Erasing of pages and programming of double words (RM0440 section 3.3), whose code for correcting
 * errors a supply that fails can leave wrong (3.3.9). */
#include "parts.h"

enum {
    PAGE_BYTES = 2048,
    PAGES = CHIP_FLASH_BYTES / PAGE_BYTES,
    FIRST_FREE_PAGE = 52, /* of those that the program may write; link.ld */
    FREE_BEGIN = CHIP_FLASH_BASE + FIRST_FREE_PAGE * PAGE_BYTES,
    ERASE_us = 22000, /* typical (data sheet, flash memory characteristics) */
    CELL_us = 82,
    CELL_BYTES = 8
};
static const uint32_t FIRST_KEY = 0x45670123, SECOND_KEY = 0xCDEF89AB;

void chip_flash_reset(chip_t *chip)
{
    chip->flash.keys = 0;
    chip->flash.busy = 0;
    chip->flash.fixes = 0;
    chip->flash.first_address = 0;
}

static bool is_locked(const chip_t *chip)
{
    return (chip_get(chip, CHIP_FLASH_CR) & CHIP_FLASH_CR_LOCK) != 0;
}

/* ---- double words that cannot be read ---- */

static uint8_t *cell_state(chip_t *chip, uint32_t address)
{
    return &chip->flash.broken[(address - (uint32_t)CHIP_FLASH_BASE) / CELL_BYTES];
}

static void on_read(uc_engine *core, uc_mem_type type, uint64_t address, int size, int64_t value,
                    void *user)
{
    (void)core;
    (void)type;
    (void)size;
    (void)value;
    chip_t *chip = user;
    if (*cell_state(chip, (uint32_t)address) == 0) {
        return;
    }
    *chip_at(chip, CHIP_FLASH_ECCR) =
        CHIP_FLASH_ECCR_ECCD | (((uint32_t)address - (uint32_t)CHIP_FLASH_BASE) & ~7U);
    chip->flash.unreadable++;
    chip_pend(chip, EXCEPTION_NMI);
    chip->deadline = 0;
}

/* A change of bits that the supply has ended: the code is right if it has not begun or is complete,
 * and if what is there is erased. */
static void break_cell(chip_t *chip, uint32_t address)
{
    if (!chip->flash.watches_reads) {
        chip->flash.watches_reads =
            uc_hook_add(chip->core, &chip->flash.read_hook, UC_HOOK_MEM_READ, (void *)on_read, chip,
                        (uint64_t)FREE_BEGIN,
                        (uint64_t)CHIP_FLASH_BASE + CHIP_FLASH_BYTES - 1U) == UC_ERR_OK;
    }
    *cell_state(chip, address) = 1;
}

static bool is_erased(chip_t *chip, uint32_t address)
{
    return chip_cells_word(chip, address) == UINT32_MAX &&
           chip_cells_word(chip, address + 4U) == UINT32_MAX;
}

/* ---- operations ---- */

static void erase(chip_t *chip, uint32_t page)
{
    if (page >= PAGES) {
        chip_note(chip, "erase of page %u", page);
        return;
    }
    if (page < FIRST_FREE_PAGE) {
        chip_note(chip, "erase of page %u, which holds the program", page);
    }
    const uint32_t begin = (uint32_t)CHIP_FLASH_BASE + page * PAGE_BYTES;
    chip_cells_check_stall(chip, "erase");
    const bool cut = chip_cells_cut(chip);
    const uint32_t style = cut ? chip_cells_style(chip) : 0;
    for (uint32_t at = begin; at < begin + PAGE_BYTES; at += CELL_BYTES) {
        *cell_state(chip, at) = 0;
        bool changed = false;
        for (uint32_t word = at; word < at + CELL_BYTES; word += 4U) {
            const uint32_t before = chip_cells_word(chip, word);
            const uint32_t after =
                before | (cut ? chip_cells_partly(chip, style, ~before) : ~before);
            changed = changed || after != before;
            chip_cells_set(chip, word, after);
        }
        if (cut && changed && !is_erased(chip, at)) {
            break_cell(chip, at);
        }
    }
    chip->flash.busy = chip->now + (chip_ticks_t)ERASE_us * CHIP_TICKS_PER_US;
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
    if ((value & CHIP_FLASH_CR_STRT) != 0 && (value & CHIP_FLASH_CR_PER) != 0) {
        erase(chip, chip_field(chip, CHIP_FLASH_CR, CHIP_FLASH_CR_PNB));
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
    case CHIP_FLASH_ECCR:
        *chip_at(chip, address) &= ~(value & (CHIP_FLASH_ECCR_ECCD | CHIP_FLASH_ECCR_ECCC));
        return true;
    default:
        return false;
    }
}

uint32_t chip_flash_read(chip_t *chip, uint32_t address)
{
    const uint32_t value = chip_get(chip, address);
    return address == CHIP_FLASH_SR && chip->now < chip->flash.busy ? value | CHIP_FLASH_SR_BSY
                                                                    : value;
}

/* Both words are there: 3.3.7 lets an erased double word take any value, another one only zero. */
static void program(chip_t *chip, uint32_t at, const uint32_t words[2])
{
    chip_cells_check_stall(chip, "programming");
    const uint32_t *before = chip->flash.before;
    const bool blank = before[0] == UINT32_MAX && before[1] == UINT32_MAX;
    uint32_t after[2] = {words[0], words[1]};
    if (!blank && (words[0] | words[1]) != 0) {
        chip_note(chip, "double word at 0x%08X programmed twice", at);
        *chip_at(chip, CHIP_FLASH_SR) |= CHIP_FLASH_SR_PROGERR;
        after[0] = before[0];
        after[1] = before[1];
    } else if (chip_cells_cut(chip)) {
        const uint32_t style = chip_cells_style(chip);
        for (int i = 0; i < 2; i++) {
            after[i] = before[i] ^ chip_cells_partly(chip, style, before[i] ^ words[i]);
        }
        const bool none = after[0] == before[0] && after[1] == before[1];
        const bool all = after[0] == words[0] && after[1] == words[1];
        if (!none && !all) {
            break_cell(chip, at);
        }
    }
    chip_cells_fix(chip, at, after[0]);
    chip_cells_fix(chip, at + 4U, after[1]);
    chip->flash.busy = chip->now + CELL_us * CHIP_TICKS_PER_US;
}

/* Before the store is carried out; chip_flash_settle() puts there what the flash makes of it. The
 * first word of two waits in a buffer. */
void chip_flash_program(chip_t *chip, uint32_t address, uint32_t size, uint32_t value)
{
    const uint32_t control = chip_get(chip, CHIP_FLASH_CR);
    chip_flash_t *flash = &chip->flash;
    const uint32_t before = chip_cells_word(chip, address & ~3U);
    const bool first = (address & 7U) == 0;
    if (is_locked(chip) || (control & CHIP_FLASH_CR_PG) == 0 || size != 4 ||
        (!first && flash->first_address != address - 4U)) {
        chip_note(chip, "store of %u bytes to the flash at 0x%08X", size, address);
        *chip_at(chip, CHIP_FLASH_SR) |= CHIP_FLASH_SR_PGSERR;
        chip_cells_fix(chip, address & ~3U, before);
        return;
    }
    if (first) {
        flash->first_address = address;
        flash->first_word = value;
        flash->before[0] = before;
        chip_cells_fix(chip, address, before);
        return;
    }
    flash->before[1] = before;
    const uint32_t words[2] = {flash->first_word, value};
    const uint32_t at = flash->first_address;
    flash->first_address = 0;
    program(chip, at, words);
}

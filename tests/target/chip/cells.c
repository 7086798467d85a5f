/* SPDX-License-Identifier: Apache-2.0 */
/* Words of the flash, and a supply that fails in the middle of an erase or of a programming. */
#include "parts.h"

/* A change of bits that the supply ends: none yet, any, a few, all, all of half of the words. The
 * manuals promise nothing about the bits that change; those of other words or sectors stay. */
enum { NOT_YET, ANY_BIT, A_FEW, ALL, HALF_OF_THE_WORDS, STYLES };

uint32_t chip_cells_style(chip_t *chip)
{
    return chip_random(chip) % STYLES;
}

uint32_t chip_cells_partly(chip_t *chip, uint32_t style, uint32_t changes)
{
    switch (style) {
    case NOT_YET:
        return 0;
    case ANY_BIT:
        return changes & chip_random(chip);
    case A_FEW:
        return changes & chip_random(chip) & chip_random(chip) & chip_random(chip) &
               chip_random(chip);
    case HALF_OF_THE_WORDS:
        return (chip_random(chip) & 1U) != 0 ? changes : 0;
    default:
        return changes;
    }
}

/* The operation is done in part, and the chip is without power. */
bool chip_cells_cut(chip_t *chip)
{
    chip->flash.operations++;
    if (chip->flash.operations == chip->fault.flash_cut_after) {
        chip->has_power = false;
        return true;
    }
    return false;
}

void chip_cells_set(chip_t *chip, uint32_t address, uint32_t value)
{
    (void)uc_mem_write(chip->core, address, &value, sizeof value);
}

uint32_t chip_cells_word(chip_t *chip, uint32_t address)
{
    uint32_t value = 0;
    (void)uc_mem_read(chip->core, address, &value, sizeof value);
    return value;
}

/* The core cannot read the flash meanwhile (RM0090 3.6, RM0440 3.3.7): a bridge that switches
 * repeats its last compare values. */
void chip_cells_check_stall(chip_t *chip, const char *what)
{
    if (chip_timer1_drives(chip)) {
        chip_note(chip, "%s of the flash while the gates switch", what);
    }
}

void chip_cells_fix(chip_t *chip, uint32_t address, uint32_t value)
{
    if (chip->flash.fixes < CHIP_FLASH_FIXES) {
        chip->flash.fix_address[chip->flash.fixes] = address;
        chip->flash.fix_value[chip->flash.fixes] = value;
        chip->flash.fixes++;
    }
}

void chip_flash_settle(chip_t *chip)
{
    for (unsigned i = 0; i < chip->flash.fixes; i++) {
        chip_cells_set(chip, chip->flash.fix_address[i], chip->flash.fix_value[i]);
    }
    chip->flash.fixes = 0;
}

/* SPDX-License-Identifier: Apache-2.0 */
/* What each handled interrupt executes, block by block, from its handler's first instruction to its
 * return. */
#include <stdlib.h>

#include "parts.h"

enum { CHIP_METER_BLOCKS = 1 << 14 }; /* of one handler; the slow step has some 4 000 */

/* One handler that runs, or has been interrupted by those above it. */
typedef struct {
    uint32_t instructions;
    uint32_t count;
    bool is_whole; /* metered from its beginning, and there was room */
    chip_block_t block[CHIP_METER_BLOCKS];
} level_t;

struct chip_meter {
    chip_handled_call_t *call;
    void *context;
    level_t level[CHIP_NESTING];
};

bool chip_meter(chip_t *chip, chip_handled_call_t *call, void *context)
{
    free(chip->meter);
    chip->meter = call != NULL ? calloc(1, sizeof *chip->meter) : NULL;
    if (chip->meter != NULL) {
        chip->meter->call = call;
        chip->meter->context = context;
    }
    return call == NULL || chip->meter != NULL;
}

void chip_meter_enter(chip_t *chip)
{
    if (chip->meter != NULL) {
        level_t *level = &chip->meter->level[chip->nvic.nesting - 1U];
        level->instructions = 0;
        level->count = 0;
        level->is_whole = true;
    }
}

void chip_meter_block(chip_t *chip, uint32_t address, uint32_t bytes, uint32_t instructions)
{
    if (chip->meter == NULL || chip->nvic.nesting == 0) {
        return;
    }
    level_t *level = &chip->meter->level[chip->nvic.nesting - 1U];
    if (level->count == CHIP_METER_BLOCKS) {
        level->is_whole = false;
        return;
    }
    const chip_block_t block = {.address = address, .bytes = bytes};
    level->block[level->count++] = block;
    level->instructions += instructions;
}

void chip_meter_leave(chip_t *chip)
{
    if (chip->meter == NULL) {
        return;
    }
    level_t *level = &chip->meter->level[chip->nvic.nesting - 1U];
    if (level->is_whole) {
        const chip_handled_t handled = {.exception = chip->nvic.stacked[chip->nvic.nesting - 1U],
                                        .instructions = level->instructions,
                                        .block = level->block,
                                        .count = level->count};
        chip->meter->call(chip->meter->context, &handled);
    }
    level->is_whole = false;
}

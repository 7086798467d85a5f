/* SPDX-License-Identifier: Apache-2.0 */
/* blocks.h: basic blocks as the emulator of the core reports them. */
#ifndef CHIP_BLOCKS_H
#define CHIP_BLOCKS_H

#include <stdbool.h>

#include <unicorn/unicorn.h>

#define BLOCKS_IT_BITS UINT32_C(0x0600FC00) /* of the program status: conditions of an IT block */

/* Instructions in a piece of code, also those whose condition fails. */
uint32_t blocks_instructions_in(uc_engine *core, uint64_t address, uint32_t bytes);

/* Whether an IT instruction is among them. */
bool blocks_set_conditions(uc_engine *core, uint64_t address, uint32_t bytes);

/* Whether the program status holds conditions of an IT block. */
bool blocks_has_conditions(uc_engine *core);

/* The emulator may keep the conditions of an IT block that its end skips, as after
 * `ittee .. pop {pc}`: the next block would lose instructions. Whether it does so before the block
 * at this address: then it has to be stopped and the conditions to be dropped. */
bool blocks_conditions_are_over(uc_engine *core, uint32_t address);
void blocks_drop_conditions(uc_engine *core);

#endif

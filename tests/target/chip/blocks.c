/* SPDX-License-Identifier: Apache-2.0 */
#include "blocks.h"

/* Those of two halfwords begin with 11101, 11110 or 11111 (Arm DDI 0403, A5.1). */
uint32_t blocks_instructions_in(uc_engine *core, uint64_t address, uint32_t bytes)
{
    uint8_t code[4096];
    const uint32_t most = bytes < sizeof code ? bytes : sizeof code;
    uint32_t count = 0;
    if (uc_mem_read(core, address, code, most) == UC_ERR_OK) {
        for (uint32_t at = 0; at < most; at += code[at + 1] >> 3 >= 0x1D ? 4 : 2) {
            count++;
        }
    }
    return count;
}

bool blocks_set_conditions(uc_engine *core, uint64_t address, uint32_t bytes)
{
    uint8_t code[4096];
    if (bytes > sizeof code || uc_mem_read(core, address, code, bytes) != UC_ERR_OK) {
        return true;
    }
    for (uint32_t at = 0; at < bytes; at += code[at + 1] >> 3 >= 0x1D ? 4 : 2) {
        if (code[at + 1] == 0xBF && (code[at] & 0xFU) != 0) {
            return true;
        }
    }
    return false;
}

/* Whether an IT instruction up to eight halfwords before covers this address (Arm DDI 0403,
 * A7.3.1): the lowest bit of the mask that is set tells how many instructions. */
static bool in_it_block(uc_engine *core, uint32_t address)
{
    enum { HALFWORDS = 8 };
    uint8_t code[2 * HALFWORDS];
    if (uc_mem_read(core, address - sizeof code, code, sizeof code) != UC_ERR_OK) {
        return false;
    }
    for (unsigned begin = 0; begin < sizeof code; begin += 2) {
        const unsigned mask = code[begin] & 0xFU;
        if (code[begin + 1] != 0xBF || mask == 0) {
            continue;
        }
        const unsigned covered = (mask & 1U) != 0   ? 4
                                 : (mask & 2U) != 0 ? 3
                                 : (mask & 4U) != 0 ? 2
                                                    : 1;
        unsigned at = begin + 2;
        for (unsigned k = 0; k < covered && at < sizeof code; k++) {
            at += code[at + 1] >> 3 >= 0x1D ? 4U : 2U;
            if (at == sizeof code && k + 1 < covered) {
                return true;
            }
        }
        if (begin + 2 == sizeof code) {
            return true;
        }
    }
    return false;
}

bool blocks_has_conditions(uc_engine *core)
{
    uint32_t flags;
    (void)uc_reg_read(core, UC_ARM_REG_CPSR, &flags);
    return (flags & BLOCKS_IT_BITS) != 0;
}

bool blocks_conditions_are_over(uc_engine *core, uint32_t address)
{
    return blocks_has_conditions(core) && !in_it_block(core, address);
}

void blocks_drop_conditions(uc_engine *core)
{
    uint32_t flags;
    (void)uc_reg_read(core, UC_ARM_REG_CPSR, &flags);
    flags &= ~BLOCKS_IT_BITS;
    (void)uc_reg_write(core, UC_ARM_REG_CPSR, &flags);
}

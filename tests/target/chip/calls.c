/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Instructions of the calls of functions in a program for QEMU's mps2-an386 (hal/qemu_mps2), by the
 * blocks that the models of the chips count: against the plugin of tools/benchmark, which counts
 * each instruction.
 *
 *     chip_calls ELF OUTPUT MOST BEGIN OPTIONS NAME=ADDRESS...
 *
 * Counting begins when the function at BEGIN is called and ends after MOST calls or with the
 * program. OPTIONS: the program's command line. OUTPUT gets a line for each call, when it ends:
 * NAME, nothing, its instructions, and the blocks of code that it executed (ride.c).
 *
 * Exit code 0: the program ended, or MOST calls were counted.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "blocks.h"

enum {
    FLASH_BYTES = 4 << 20,
    RAM_BASE = 0x20000000,
    RAM_BYTES = 4 << 20,
    PERIPHERALS_BASE = 0x40000000,
    CORE_BASE = (int)0xE0000000,
    WINDOW_BYTES = 1 << 20,
    FUNCTIONS = 8,
    DEPTH = 8,
    BLOCKS = 1 << 14,
    EXCEPTION_BKPT = 7,
    SYS_WRITE0 = 0x04,
    SYS_GET_CMDLINE = 0x15,
    SYS_EXIT = 0x18
};
static const uint32_t EXIT_GOOD = 0x20026;

typedef struct {
    const char *name;
    uint32_t address;
} function_t;

/* A call that has not ended. */
typedef struct {
    const function_t *function;
    uint32_t back, stack; /* where it returns to, and with which stack */
    uint32_t instructions, count;
    uint32_t address[BLOCKS], bytes[BLOCKS];
} open_call_t;

static struct {
    uc_engine *core;
    FILE *out;
    const char *options;
    uint32_t begin;
    long most, calls;
    function_t function[FUNCTIONS];
    unsigned functions;
    open_call_t open[DEPTH];
    unsigned depth;
    bool counts, ended, good, drops_conditions, too_long;
} all;

static uint32_t reg(int id)
{
    uint32_t value = 0;
    (void)uc_reg_read(all.core, id, &value);
    return value;
}

static void end_call(void)
{
    const open_call_t *call = &all.open[--all.depth];
    (void)fprintf(all.out, "%s\t\t%u\t", call->function->name, call->instructions);
    for (uint32_t i = 0; i < call->count; i++) {
        (void)fprintf(all.out, "%s%x+%x", i > 0 ? " " : "", call->address[i], call->bytes[i]);
    }
    (void)fputc('\n', all.out);
    all.calls++;
}

static void begin_call(const function_t *function)
{
    if (all.depth == DEPTH) {
        all.too_long = true;
        return;
    }
    open_call_t *call = &all.open[all.depth++];
    call->function = function;
    call->back = reg(UC_ARM_REG_LR) & ~1U;
    call->stack = reg(UC_ARM_REG_SP);
    call->instructions = 0;
    call->count = 0;
}

static void count_block(uint32_t address, uint32_t bytes)
{
    while (all.depth > 0 && address == all.open[all.depth - 1].back &&
           reg(UC_ARM_REG_SP) == all.open[all.depth - 1].stack) {
        end_call();
    }
    for (unsigned i = 0; i < all.functions; i++) {
        if (address == all.function[i].address) {
            begin_call(&all.function[i]);
        }
    }
    const uint32_t instructions =
        all.depth > 0 ? blocks_instructions_in(all.core, address, bytes) : 0;
    for (unsigned i = 0; i < all.depth; i++) {
        open_call_t *call = &all.open[i];
        call->instructions += instructions;
        if (call->count == BLOCKS) {
            all.too_long = true;
            return;
        }
        call->address[call->count] = address;
        call->bytes[call->count++] = bytes;
    }
}

static void on_block(uc_engine *core, uint64_t address, uint32_t bytes, void *user)
{
    (void)user;
    if (blocks_conditions_are_over(core, (uint32_t)address)) {
        all.drops_conditions = true;
        (void)uc_emu_stop(core);
        return;
    }
    all.counts = all.counts || address == all.begin;
    if (all.counts) {
        count_block((uint32_t)address, bytes);
    }
    if (all.calls >= all.most || all.too_long) {
        all.good = !all.too_long;
        all.ended = true;
        (void)uc_emu_stop(core);
    }
}

/* Semihosting: what semihost.c asks for. */
static void request(void)
{
    uint32_t result = 0;
    const uint32_t argument = reg(UC_ARM_REG_R1);
    uint32_t block[2] = {0, 0};
    switch (reg(UC_ARM_REG_R0)) {
    case SYS_GET_CMDLINE:
        (void)uc_mem_read(all.core, argument, block, sizeof block);
        (void)uc_mem_write(all.core, block[0], all.options, strlen(all.options) + 1U);
        break;
    case SYS_EXIT:
        all.ended = true;
        all.good = argument == EXIT_GOOD;
        break;
    case SYS_WRITE0:
    default:
        break;
    }
    (void)uc_reg_write(all.core, UC_ARM_REG_R0, &result);
}

static void on_exception(uc_engine *core, uint32_t number, void *user)
{
    (void)user;
    if (number == EXCEPTION_BKPT) {
        request();
        const uint32_t next = (reg(UC_ARM_REG_PC) + 2U) | 1U;
        (void)uc_reg_write(core, UC_ARM_REG_PC, &next);
    } else {
        (void)fprintf(stderr, "exception %u of the core at 0x%x\n", number, reg(UC_ARM_REG_PC));
        all.ended = true;
    }
    if (all.ended) {
        (void)uc_emu_stop(core);
    }
}

static bool load(const char *path)
{
    static uint8_t bytes[8 << 20];
    FILE *file = fopen(path, "rb");
    const size_t size = file != NULL ? fread(bytes, 1, sizeof bytes, file) : 0;
    if (file != NULL) {
        (void)fclose(file);
    }
    if (size < 52 || memcmp(bytes,
                            "\x7f"
                            "ELF\1\1",
                            6) != 0) {
        return false;
    }
    uint32_t table;
    uint16_t count;
    memcpy(&table, &bytes[28], sizeof table);
    memcpy(&count, &bytes[44], sizeof count);
    bool good = true;
    for (uint32_t i = 0; i < count && good; i++) {
        uint32_t header[8];
        good = (size_t)table + (i + 1U) * sizeof header <= size;
        if (good) {
            memcpy(header, &bytes[table + i * sizeof header], sizeof header);
            good = header[0] != 1 || header[4] == 0 ||
                   ((size_t)header[1] + header[4] <= size &&
                    uc_mem_write(all.core, header[3], &bytes[header[1]], header[4]) == UC_ERR_OK);
        }
    }
    return good;
}

static bool make_core(void)
{
    uc_hook hook;
    return uc_open(UC_ARCH_ARM, UC_MODE_THUMB | UC_MODE_MCLASS, &all.core) == UC_ERR_OK &&
           uc_ctl_set_cpu_model(all.core, UC_CPU_ARM_CORTEX_M4) == UC_ERR_OK &&
           uc_mem_map(all.core, 0, FLASH_BYTES, UC_PROT_ALL) == UC_ERR_OK &&
           uc_mem_map(all.core, RAM_BASE, RAM_BYTES, UC_PROT_ALL) == UC_ERR_OK &&
           uc_mem_map(all.core, PERIPHERALS_BASE, WINDOW_BYTES, UC_PROT_ALL) == UC_ERR_OK &&
           uc_mem_map(all.core, (uint32_t)CORE_BASE, WINDOW_BYTES, UC_PROT_ALL) == UC_ERR_OK &&
           uc_hook_add(all.core, &hook, UC_HOOK_BLOCK, (void *)on_block, NULL, 1, 0) == UC_ERR_OK &&
           uc_hook_add(all.core, &hook, UC_HOOK_INTR, (void *)on_exception, NULL, 1, 0) ==
               UC_ERR_OK;
}

static void run(void)
{
    uint32_t vector[2];
    (void)uc_mem_read(all.core, 0, vector, sizeof vector);
    (void)uc_reg_write(all.core, UC_ARM_REG_SP, &vector[0]);
    uint32_t at = vector[1];
    while (!all.ended) {
        const uc_err error = uc_emu_start(all.core, at | 1U, UINT32_MAX, 0, 0);
        at = reg(UC_ARM_REG_PC);
        if (error != UC_ERR_OK) {
            (void)fprintf(stderr, "%s at 0x%x\n", uc_strerror(error), at);
            return;
        }
        if (all.drops_conditions) {
            blocks_drop_conditions(all.core);
            all.drops_conditions = false;
        }
    }
}

int main(int argc, char **argv)
{
    if (argc < 7 || argc - 6 > FUNCTIONS) {
        (void)fprintf(stderr, "usage: chip_calls ELF OUTPUT MOST BEGIN OPTIONS NAME=ADDRESS...\n");
        return 2;
    }
    all.most = strtol(argv[3], NULL, 0);
    all.begin = (uint32_t)strtoul(argv[4], NULL, 0);
    all.options = argv[5];
    for (int i = 6; i < argc; i++) {
        char *is = strchr(argv[i], '=');
        if (is == NULL) {
            return 2;
        }
        *is = '\0';
        const function_t function = {argv[i], (uint32_t)strtoul(is + 1, NULL, 0)};
        all.function[all.functions++] = function;
    }
    all.out = fopen(argv[2], "w");
    if (all.out == NULL || !make_core() || !load(argv[1])) {
        (void)fprintf(stderr, "%s cannot be run, or %s not be written\n", argv[1], argv[2]);
        return 2;
    }
    run();
    const bool written = fclose(all.out) == 0;
    (void)uc_close(all.core);
    return all.good && written ? 0 : 1;
}

/* SPDX-License-Identifier: Apache-2.0 */
/* The core, its memory map, and time. */
#include <string.h>

#include "blocks.h"
#include "parts.h"

/* ---- registers ---- */

/* Behind the core's own registers. */
static const uint32_t DBGMCU_BEGIN = 0xE0042000;

static const chip_route_t *route_of(uint32_t address)
{
    const chip_route_t *route = CHIP_ROUTES;
    while (route->begin != 0 && (address ^ route->begin) >= 0x400U) {
        route++;
    }
    return route->begin != 0 ? route : NULL;
}

uint32_t chip_bus_read(chip_t *chip, uint32_t address)
{
    const unsigned known = chip->known[chip_index(address)];
    if (known == 0) {
        chip_note(chip, "read of 0x%08X, where there is no register", address);
        return 0;
    }
    if (!chip_has_clock(chip, address)) {
        chip_note(chip, "read of %s without its clock", CHIP_REGISTERS[known - 1].name);
        return 0;
    }
    const chip_route_t *route = route_of(address);
    return route != NULL ? route->read(chip, address) : chip_get(chip, address);
}

void chip_bus_write(chip_t *chip, uint32_t address, uint32_t value)
{
    const unsigned known = chip->known[chip_index(address)];
    if (known == 0) {
        chip_note(chip, "write of 0x%08X, where there is no register", address);
        return;
    }
    const chip_register_t *row = &CHIP_REGISTERS[known - 1];
    if (!chip_has_clock(chip, address)) {
        chip_note(chip, "write of %s without its clock", row->name);
        return;
    }
    if ((row->access & 2U) == 0) {
        chip_note(chip, "write of %s, which is read-only", row->name);
        return;
    }
    chip->deadline = chip->now; /* the next event may be an earlier one now */
    const chip_route_t *route = route_of(address);
    if (route == NULL || !route->write(chip, address, value)) {
        *chip_at(chip, address) = value & row->bits;
    }
}

static uint64_t on_read(uc_engine *core, uint64_t offset, unsigned size, void *user)
{
    (void)core;
    const chip_window_t *window = user;
    const uint32_t word = (uint32_t)offset & ~3U;
    const uint32_t value = chip_bus_read(window->chip, window->begin + word);
    return value >> 8U * (offset & 3U) & (size == 4 ? UINT32_MAX : (1U << 8U * size) - 1U);
}

static void on_write(uc_engine *core, uint64_t offset, unsigned size, uint64_t value, void *user)
{
    (void)core;
    const chip_window_t *window = user;
    if (size != 4) {
        chip_note(window->chip, "write of %u bytes at 0x%08X", size,
                  window->begin + (uint32_t)offset);
        return;
    }
    chip_bus_write(window->chip, window->begin + (uint32_t)offset, (uint32_t)value);
}

static uint64_t on_core_read(uc_engine *core, uint64_t offset, unsigned size, void *user)
{
    (void)core;
    const uint32_t address = (uint32_t)CHIP_CORE_BASE + ((uint32_t)offset & ~3U);
    const uint32_t value = address >= DBGMCU_BEGIN ? ((chip_t *)user)->core_word[offset / 4]
                                                   : chip_core_read(user, address);
    return value >> 8U * (offset & 3U) & (size == 4 ? UINT32_MAX : (1U << 8U * size) - 1U);
}

static void on_core_write(uc_engine *core, uint64_t offset, unsigned size, uint64_t value,
                          void *user)
{
    (void)core;
    chip_t *chip = user;
    uint32_t *word = &chip->core_word[offset / 4];
    const uint32_t shift = 8U * ((uint32_t)offset & 3U);
    const uint32_t mask = size == 4 ? UINT32_MAX : (1U << 8U * size) - 1U;
    const uint32_t whole = (*word & ~(mask << shift)) | ((uint32_t)value & mask) << shift;
    *word = whole;
    chip->deadline = chip->now;
    chip_core_write(chip, (uint32_t)CHIP_CORE_BASE + ((uint32_t)offset & ~3U), whole);
}

/* ---- the core ---- */

/* Each block of the flash is counted once. Notes whether conditions may hold at its end. */
static uint32_t instructions_in(chip_t *chip, uint64_t address, uint32_t size)
{
    const bool in_flash = address - CHIP_FLASH_BASE < CHIP_FLASH_BYTES;
    const size_t place = in_flash ? (address - CHIP_FLASH_BASE) / 2 : 0;
    if (in_flash && chip->instructions[place] != 0) {
        chip->may_have_conditions = chip->may_have_conditions || chip->sets_conditions[place];
        return chip->instructions[place];
    }
    const uint32_t count = blocks_instructions_in(chip->core, address, size);
    const bool sets_conditions = blocks_set_conditions(chip->core, address, size);
    if (in_flash && count < 256) {
        chip->instructions[place] = (uint8_t)count;
        chip->sets_conditions[place] = sets_conditions;
    }
    chip->may_have_conditions = chip->may_have_conditions || sets_conditions;
    return count;
}

/* Reading the program status before each block takes a fifth of the time, so only where the block
 * before may have left conditions. Returns whether they are over. */
static bool conditions_are_over(chip_t *chip, uint32_t address)
{
    if (!chip->may_have_conditions) {
        return false;
    }
    chip->may_have_conditions = blocks_has_conditions(chip->core);
    return chip->may_have_conditions && blocks_conditions_are_over(chip->core, address);
}

/* Before the block is executed; a stop leaves it for later. */
static void on_block(uc_engine *core, uint64_t address, uint32_t size, void *user)
{
    chip_t *chip = user;
    if (chip->flash.fixes > 0) {
        chip_flash_settle(chip);
    }
    if (chip->now < chip->flash.busy && address - CHIP_FLASH_BASE < CHIP_FLASH_BYTES) {
        chip->now = chip->flash.busy; /* the core waits for the flash */
    }
    if (!chip->has_power || chip->now >= chip->deadline ||
        (chip->needs_attention && (chip->reset_requested || chip_exception_due(chip) != 0))) {
        (void)uc_emu_stop(core);
        return;
    }
    if (conditions_are_over(chip, (uint32_t)address)) {
        chip->drops_conditions = true;
        (void)uc_emu_stop(core);
        return;
    }
    if (address - CHIP_RAM_BASE < CHIP_RAM_BYTES &&
        !chip_mpu_lets(chip, (uint32_t)address, CHIP_EXECUTE)) {
        chip_note(chip, "MPU: code at 0x%08X is not to be executed", (uint32_t)address);
    }
    const uint32_t instructions = instructions_in(chip, address, size);
    chip_meter_block(chip, (uint32_t)address, size, instructions);
    chip->now += (chip_ticks_t)instructions * chip->ticks_per_cycle;
}

static void on_exception(uc_engine *core, uint32_t number, void *user)
{
    enum { EXCEPTION_EXIT = 8 };
    chip_t *chip = user;
    if (number == EXCEPTION_EXIT) {
        chip_exception_return(chip);
    } else {
        chip_note(chip, "exception %u of the core", number);
        chip_pend(chip, EXCEPTION_HARD_FAULT);
        chip->deadline = 0;
    }
    (void)uc_emu_stop(core);
}

static void on_flash_write(uc_engine *core, uc_mem_type type, uint64_t address, int size,
                           int64_t value, void *user)
{
    (void)core;
    (void)type;
    if (!chip_mpu_lets(user, (uint32_t)address, CHIP_WRITE)) {
        chip_note(user, "MPU: the flash at 0x%08X is not to be written", (uint32_t)address);
    }
    chip_flash_program(user, (uint32_t)address, (uint32_t)size, (uint32_t)value);
}

static void load_stack_and_entry(chip_t *chip)
{
    uint32_t vector[2];
    (void)uc_mem_read(chip->core, CHIP_FLASH_BASE, vector, sizeof vector);
    const uint32_t none = 0;
    const uint32_t link = UINT32_MAX;
    (void)uc_reg_write(chip->core, UC_ARM_REG_SP, &vector[0]);
    (void)uc_reg_write(chip->core, UC_ARM_REG_LR, &link);
    (void)uc_reg_write(chip->core, UC_ARM_REG_IPSR, &none);
    (void)uc_reg_write(chip->core, UC_ARM_REG_PRIMASK, &none);
    (void)uc_reg_write(chip->core, UC_ARM_REG_BASEPRI, &none);
    (void)uc_reg_write(chip->core, UC_ARM_REG_CONTROL, &none);
    const uint32_t entry = vector[1] | 1U;
    (void)uc_reg_write(chip->core, UC_ARM_REG_PC, &entry);
}

void chip_request_reset(chip_t *chip, chip_reset_t cause)
{
    chip->reset_requested = true;
    chip->reset_by = cause;
}

void chip_reset_by(chip_t *chip, chip_reset_t cause)
{
    const uint32_t status = chip_get(chip, CHIP_RCC_CSR);
    memset(chip->word, 0, sizeof chip->word);
    memset(chip->core_word, 0, sizeof chip->core_word);
    for (unsigned i = 0; i < CHIP_REGISTER_COUNT; i++) {
        const chip_register_t *row = &CHIP_REGISTERS[i];
        if (row->address < (uint32_t)CHIP_CORE_BASE) {
            *chip_at(chip, row->address) = row->reset;
        }
    }
    chip->reset_requested = false;
    chip->resets++;
    chip->watchdog_resets += cause == CHIP_RESET_WATCHDOG ? 1U : 0U;
    chip_clocks_reset(chip, cause, status);
    chip_nvic_reset(chip);
    chip_mpu_reset(chip);
    chip_flash_reset(chip);
    chip_timer1_reset(chip);
    chip_timer8_reset(chip);
    chip_adc_reset(chip);
    chip_can_reset(chip);
    chip_serial_reset(chip);
    chip_part_reset(chip);
    chip->pin_levels = UINT16_MAX;
    load_stack_and_entry(chip);
}

static chip_ticks_t least(chip_ticks_t a, chip_ticks_t b)
{
    return a < b ? a : b;
}

static chip_ticks_t next_event(chip_t *chip)
{
    chip_ticks_t next = chip_nvic_next(chip);
    next = least(next, chip_clocks_next(chip));
    next = least(next, chip_part_next(chip));
    next = least(next, chip_timer1_next(chip));
    next = least(next, chip_timer8_next(chip));
    next = least(next, chip_adc_next(chip));
    next = least(next, chip_can_next(chip));
    return least(next, chip_serial_next(chip));
}

static void events(chip_t *chip)
{
    chip_timer1_events(chip);
    chip_timer8_events(chip);
    chip_adc_events(chip);
    chip_can_events(chip);
    chip_serial_events(chip);
    chip_nvic_events(chip);
    chip_clocks_events(chip);
}

static bool on_no_memory(uc_engine *core, uc_mem_type type, uint64_t address, int size,
                         int64_t value, void *user)
{
    (void)core;
    (void)size;
    (void)value;
    chip_t *chip = user;
    chip->missing = (uint32_t)address;
    chip->missing_code = type == UC_MEM_FETCH_UNMAPPED;
    return false;
}

/* Executes until the deadline, an exception or a reset. */
static void execute(chip_t *chip)
{
    uint32_t at;
    (void)uc_reg_read(chip->core, UC_ARM_REG_PC, &at);
    if (chip->drops_conditions) {
        blocks_drop_conditions(chip->core);
        chip->drops_conditions = false;
    }
    chip->may_have_conditions = true; /* of what was interrupted */
    const uc_err error = uc_emu_start(chip->core, at | 1U, UINT32_MAX, 0, 0);
    if (error != UC_ERR_OK) {
        (void)uc_reg_read(chip->core, UC_ARM_REG_PC, &at);
        chip_note(chip, "%s at 0x%08X", uc_strerror(error), at);
        chip_bus_fault(chip, chip->missing, chip->missing_code);
        if (chip->nvic.active[EXCEPTION_HARD_FAULT]) {
            chip->now = chip->deadline; /* locked up until the watchdog acts */
        }
    }
}

static void run_until(chip_t *chip, chip_ticks_t end, bool stops_at_sample)
{
    while (chip->now < end && chip->has_power && !(stops_at_sample && chip->adc.is_triggered)) {
        if (chip->reset_requested) {
            chip_reset_by(chip, chip->reset_by);
        }
        chip_part_watch(chip);
        chip_pins_watch(chip);
        const unsigned exception = chip_exception_due(chip);
        if (exception != 0 && !chip->fault.core_stuck) {
            chip_exception_enter(chip, exception);
        }
        chip->needs_attention = chip_exception_waits(chip);
        chip->deadline = least(next_event(chip), end);
        if (chip->fault.core_stuck) {
            chip->now = chip->deadline > chip->now ? chip->deadline : chip->now;
        } else if (chip->now < chip->deadline) {
            execute(chip);
        }
        events(chip);
    }
}

void chip_run(chip_t *chip, chip_ticks_t duration)
{
    const chip_ticks_t end = chip->now + duration;
    while (chip->now < end && chip->has_power) {
        run_until(chip, end, true);
        chip_sample(chip);
    }
}

bool chip_run_to_sample(chip_t *chip, chip_ticks_t most)
{
    run_until(chip, chip->now + most, true);
    return chip->adc.is_triggered;
}

void chip_sample(chip_t *chip)
{
    if (chip->adc.is_triggered) {
        chip->adc.is_triggered = false;
        chip_adc_inject(chip);
        /* To the top of the count, a little later, where the compare values become active, unless
         * the block in which the trigger came has already gone beyond it. */
        if (!chip->timer1.down) {
            run_until(chip, chip->timer1.next_end + 1U, true);
        }
    }
}

/* Instead of the maker's bootloader: stack, entry, and there a loop. */
static const uint32_t SYSTEM_MEMORY[] = {CHIP_RAM_BASE + 0x2000, CHIP_SYSTEM_BASE + 8 + 1,
                                         0xE7FEE7FE};

bool chip_in_bootloader(const chip_t *chip)
{
    uint32_t at;
    uint32_t stack;
    (void)uc_reg_read(chip->core, UC_ARM_REG_PC, &at);
    (void)uc_reg_read(chip->core, UC_ARM_REG_SP, &stack);
    return at - CHIP_SYSTEM_BASE < CHIP_SYSTEM_BYTES && stack == SYSTEM_MEMORY[0] &&
           chip_get(chip, CHIP_REMAP) == 1 &&
           chip_get(chip, CHIP_RCC_CFGR) == CHIP_RCC_CFGR_AT_RESET;
}

/* The windows of the peripherals. */
static bool map_windows(chip_t *chip)
{
    static const struct {
        uint32_t begin, bytes;
    } WINDOWS[] = {CHIP_WINDOWS};
    bool good = true;
    for (unsigned i = 0; i < sizeof WINDOWS / sizeof WINDOWS[0]; i++) {
        chip_window_t *window = &chip->window[i];
        window->chip = chip;
        window->begin = WINDOWS[i].begin;
        window->bytes = WINDOWS[i].bytes;
        good = good && uc_mmio_map(chip->core, window->begin, window->bytes, on_read, window,
                                   on_write, window) == UC_ERR_OK;
    }
    return good;
}

bool chip_core_open(chip_t *chip)
{
    uc_hook hook;
    bool good =
        uc_open(UC_ARCH_ARM, UC_MODE_THUMB | UC_MODE_MCLASS, &chip->core) == UC_ERR_OK &&
        uc_ctl_set_cpu_model(chip->core, UC_CPU_ARM_CORTEX_M4) == UC_ERR_OK &&
        uc_mem_map(chip->core, CHIP_FLASH_BASE, CHIP_FLASH_BYTES, UC_PROT_ALL) == UC_ERR_OK &&
        uc_mem_map(chip->core, CHIP_RAM_BASE, CHIP_RAM_BYTES, UC_PROT_ALL) == UC_ERR_OK &&
        uc_mem_map(chip->core, CHIP_SYSTEM_BASE, CHIP_SYSTEM_BYTES, UC_PROT_READ | UC_PROT_EXEC) ==
            UC_ERR_OK &&
        uc_mem_write(chip->core, CHIP_SYSTEM_BASE, SYSTEM_MEMORY, sizeof SYSTEM_MEMORY) ==
            UC_ERR_OK &&
        uc_mmio_map(chip->core, (uint32_t)CHIP_CORE_BASE, CHIP_CORE_BYTES, on_core_read, chip,
                    on_core_write, chip) == UC_ERR_OK &&
        uc_mem_write(chip->core, CHIP_FLASH_BASE, chip->flash_at_power_on, CHIP_FLASH_BYTES) ==
            UC_ERR_OK;
    good =
        good && map_windows(chip) &&
        uc_hook_add(chip->core, &hook, UC_HOOK_BLOCK, (void *)on_block, chip, 1, 0) == UC_ERR_OK &&
        uc_hook_add(chip->core, &hook, UC_HOOK_INTR, (void *)on_exception, chip, 1, 0) ==
            UC_ERR_OK &&
        uc_hook_add(chip->core, &hook, UC_HOOK_MEM_UNMAPPED, (void *)on_no_memory, chip, 1, 0) ==
            UC_ERR_OK &&
        uc_hook_add(chip->core, &hook, UC_HOOK_MEM_WRITE, (void *)on_flash_write, chip,
                    CHIP_FLASH_BASE, CHIP_FLASH_BASE + CHIP_FLASH_BYTES - 1) == UC_ERR_OK;
    for (int i = 0; i < CHIP_NESTING && good; i++) {
        good = uc_context_alloc(chip->core, &chip->nvic.context[i]) == UC_ERR_OK;
    }
    return good;
}

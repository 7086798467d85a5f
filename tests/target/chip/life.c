/* SPDX-License-Identifier: Apache-2.0 */
/* A chip from its image to its end, and what is told about it. */
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "parts.h"

enum { ELF_HEADER_BYTES = 52, PROGRAM_HEADER_BYTES = 32, PT_LOAD = 1 };

void chip_note(chip_t *chip, const char *format, ...)
{
    if (chip->violations < CHIP_VIOLATIONS) {
        va_list arguments;
        va_start(arguments, format);
        (void)vsnprintf(chip->violation[chip->violations], CHIP_VIOLATION_BYTES, format, arguments);
        va_end(arguments);
    }
    chip->violations++;
}

uint32_t chip_random(chip_t *chip)
{
    chip->random = chip->random * 1664525U + 1013904223U; /* Numerical Recipes */
    return chip->random >> 16 | chip->random << 16;
}

void chip_seed(chip_t *chip, uint32_t seed)
{
    chip->random = seed;
    for (int i = 0; i < 4; i++) { /* neighbouring seeds part */
        (void)chip_random(chip);
    }
}

static bool load(chip_t *chip, const char *path)
{
    FILE *file = fopen(path, "rb");
    if (file == NULL) {
        (void)fprintf(stderr, "%s: cannot be read; ./tools/dev firmware makes it\n", path);
        return false;
    }
    static uint8_t bytes[8 << 20];
    const size_t size = fread(bytes, 1, sizeof bytes, file);
    (void)fclose(file);
    static const uint8_t MAGIC[6] = {0x7F, 'E', 'L', 'F', 1, 1};
    if (size < ELF_HEADER_BYTES || size == sizeof bytes || memcmp(bytes, MAGIC, 6) != 0) {
        (void)fprintf(stderr, "%s: not an ELF of a 32-bit little-endian machine\n", path);
        return false;
    }
    memset(chip->flash_at_power_on, 0xFF, sizeof chip->flash_at_power_on);
    uint32_t table;
    uint16_t count;
    memcpy(&table, &bytes[28], sizeof table);
    memcpy(&count, &bytes[44], sizeof count);
    for (uint32_t i = 0; i < count; i++) {
        uint32_t header[PROGRAM_HEADER_BYTES / 4];
        if ((size_t)table + (i + 1) * sizeof header > size) {
            (void)fprintf(stderr, "%s: shorter than its headers say\n", path);
            return false;
        }
        memcpy(header, &bytes[table + i * sizeof header], sizeof header);
        const uint32_t offset = header[1];
        const uint32_t to = header[3] - CHIP_FLASH_BASE;
        const uint32_t stored = header[4];
        if (header[0] != PT_LOAD || stored == 0) {
            continue;
        }
        if ((size_t)offset + stored > size || to >= CHIP_FLASH_BYTES ||
            stored > CHIP_FLASH_BYTES - to) {
            (void)fprintf(stderr, "%s: a segment is outside of the flash\n", path);
            return false;
        }
        memcpy(&chip->flash_at_power_on[to], &bytes[offset], stored);
    }
    return true;
}

chip_t *chip_open(const char *elf_path)
{
    chip_t *chip = calloc(1, sizeof *chip);
    if (chip == NULL || !load(chip, elf_path)) {
        free(chip);
        return NULL;
    }
    if (!chip_core_open(chip)) {
        (void)fprintf(stderr, "the emulator of the core does not start\n");
        chip_close(chip);
        return NULL;
    }
    for (unsigned i = 0; i < CHIP_REGISTER_COUNT; i++) {
        if (CHIP_REGISTERS[i].address < (uint32_t)CHIP_CORE_BASE) {
            chip->known[chip_index(CHIP_REGISTERS[i].address)] = (uint16_t)(i + 1U);
        }
    }
    chip->random = 1;
    chip_power_cycle(chip);
    return chip;
}

void chip_close(chip_t *chip)
{
    if (chip == NULL) {
        return;
    }
    for (int i = 0; i < CHIP_NESTING; i++) {
        (void)uc_context_free(chip->nvic.context[i]);
    }
    if (chip->core != NULL) {
        (void)uc_close(chip->core);
    }
    free(chip->meter);
    free(chip);
}

void chip_power_cycle(chip_t *chip)
{
    for (uint32_t at = 0; at < CHIP_RAM_BYTES; at += 4) {
        const uint32_t left_over = chip_random(chip);
        (void)uc_mem_write(chip->core, (uint32_t)CHIP_RAM_BASE + at, &left_over, sizeof left_over);
    }
    chip->has_power = true;
    chip->flash.operations = 0;
    chip->fault.flash_cut_after = 0;
    chip_reset_by(chip, CHIP_RESET_SUPPLY);
}

void chip_pend(chip_t *chip, unsigned exception)
{
    chip->nvic.pending[exception] = true;
    chip->needs_attention = true;
}

chip_inputs_t *chip_inputs(chip_t *chip)
{
    return &chip->in;
}

chip_faults_t *chip_faults(chip_t *chip)
{
    return &chip->fault;
}

chip_ticks_t chip_now(const chip_t *chip)
{
    return chip->now;
}

bool chip_register(const chip_t *chip, uint32_t address, uint32_t *value)
{
    const bool is_peripheral = address < (uint32_t)CHIP_CORE_BASE;
    *value = is_peripheral ? chip_get(chip, address) : 0;
    return is_peripheral;
}

bool chip_read(chip_t *chip, uint32_t address, void *bytes, uint32_t size)
{
    return uc_mem_read(chip->core, address, bytes, size) == UC_ERR_OK;
}

bool chip_write(chip_t *chip, uint32_t address, const void *bytes, uint32_t size)
{
    return uc_mem_write(chip->core, address, bytes, size) == UC_ERR_OK;
}

void chip_spoil_registers(chip_t *chip, uint32_t value)
{
    for (int i = 0; i <= 12; i++) {
        (void)uc_reg_write(chip->core, UC_ARM_REG_R0 + i, &value);
    }
}

void chip_derail(chip_t *chip, uint32_t address)
{
    const uint32_t to = address | 1U;
    (void)uc_reg_write(chip->core, UC_ARM_REG_PC, &to);
}

unsigned chip_bus_faults(const chip_t *chip, uint32_t *instruction)
{
    *instruction = chip->bus_fault_at;
    return chip->bus_faults;
}

unsigned chip_resets(const chip_t *chip)
{
    return chip->resets;
}

unsigned chip_watchdog_resets(const chip_t *chip)
{
    return chip->watchdog_resets;
}

uint32_t chip_flash_operations(const chip_t *chip)
{
    return chip->flash.operations;
}

unsigned chip_unreadable(const chip_t *chip)
{
    return chip->flash.unreadable;
}

bool chip_has_power(const chip_t *chip)
{
    return chip->has_power;
}

void chip_violate(chip_t *chip, const char *text)
{
    chip_note(chip, "%s", text);
}

unsigned chip_violations(const chip_t *chip)
{
    return chip->violations;
}

const char *chip_violation_text(const chip_t *chip, unsigned number)
{
    return number < chip->violations && number < CHIP_VIOLATIONS ? chip->violation[number] : NULL;
}

const char *chip_text(const chip_t *chip)
{
    return chip->serial.text;
}

void chip_type(chip_t *chip, const char *text)
{
    chip_serial_t *serial = &chip->serial;
    for (; *text != '\0' && serial->typed_count < sizeof serial->typed; text++) {
        serial->typed[(serial->typed_first + serial->typed_count) % sizeof serial->typed] = *text;
        serial->typed_count++;
    }
    if (serial->next_byte == CHIP_NEVER && serial->typed_count > 0) {
        serial->next_byte = chip->now + CHIP_TICKS_PER_US;
    }
}

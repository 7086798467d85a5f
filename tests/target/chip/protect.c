/* SPDX-License-Identifier: Apache-2.0 */
/*
 * What the memory protection unit lets the flashable image do, address by address, against the map
 * of the linked image.
 *
 *     chip_protect ELF [--finds TEXT]
 *
 * Exit code 0: as expected; of an image with an error planted, that TEXT finds it (rig.h).
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "planted.h"
#include "rig.h"

enum {
    ELF_BYTES = 8 << 20,
    SECTION_BYTES = 40,
    SYMBOL_BYTES = 16,
    SYMTAB = 2,
    STEP = 32, /* the smallest region */
    NULL_BYTES = 4096
};
static uint8_t elf[ELF_BYTES];
static size_t elf_size;

static uint32_t word(size_t at)
{
    uint32_t value = 0;
    if (at + sizeof value <= elf_size) {
        memcpy(&value, &elf[at], sizeof value);
    }
    return value;
}

static bool read_elf(const char *path)
{
    FILE *file = fopen(path, "rb");
    elf_size = file == NULL ? 0 : fread(elf, 1, sizeof elf, file);
    if (file != NULL) {
        (void)fclose(file);
    }
    return elf_size > 0 && elf_size < sizeof elf;
}

/* Address of a symbol of the linker script; the test ends if there is none. */
static uint32_t address_of(const char *name)
{
    const size_t table = word(32);
    const unsigned sections = word(48) & 0xFFFFU;
    for (unsigned i = 0; i < sections; i++) {
        const size_t section = table + (size_t)i * SECTION_BYTES;
        if (word(section + 4) != SYMTAB) {
            continue;
        }
        const size_t names = word(table + (size_t)word(section + 24) * SECTION_BYTES + 16);
        const size_t begin = word(section + 16);
        for (size_t at = begin; at < begin + word(section + 20); at += SYMBOL_BYTES) {
            const size_t text = names + word(at);
            if (text + strlen(name) < elf_size &&
                memcmp(&elf[text], name, strlen(name) + 1U) == 0) {
                return word(at + 4);
            }
        }
    }
    (void)fprintf(stderr, "the image has no symbol %s\n", name);
    exit(2);
}

/* From begin to end. */
static bool all_let(uint32_t begin, uint32_t end, chip_access_t access, bool wanted)
{
    bool good = true;
    for (uint32_t at = begin; at < end && good; at += STEP) {
        good = chip_mpu_lets(rig.chip, at, access) == wanted;
        if (!good) {
            printf("at 0x%08X\n", at);
        }
    }
    return good;
}

static bool lets(const char *what, uint32_t begin, uint32_t end, const char *wanted)
{
    static const char LETTERS[] = "rwx";
    bool good = begin < end;
    for (int access = CHIP_READ; access <= CHIP_EXECUTE; access++) {
        good = good &&
               all_let(begin, end, (chip_access_t)access, strchr(wanted, LETTERS[access]) != NULL);
    }
    printf("0x%08X .. 0x%08X %-3s %s\n", begin, end, wanted, what);
    return expect(good, what);
}

static bool flash_is_protected(void)
{
    const uint32_t image = address_of("link_image_begin");
    const uint32_t end = address_of("link_image_end");
    const uint32_t sectors = address_of("link_configuration_a");
    const uint32_t open =
        image < IMAGE_OPEN_BEGINS && IMAGE_OPEN_BEGINS < end ? IMAGE_OPEN_BEGINS : end;
    return lets("the program is not written", image, open, "rx") &&
           lets("the application writes its sectors", sectors, address_of("link_journal_end"),
                "rwx") &&
           lets("what the eighths leave open is as documented", IMAGE_OPEN_BEGINS, IMAGE_OPEN_ENDS,
                "rwx");
}

static bool ram_is_protected(void)
{
    const uint32_t guard = address_of("link_guard_begin");
    const uint32_t stack = address_of("link_stack_begin");
    const uint32_t code = address_of("link_data_begin");
    const uint32_t variables = address_of("link_ram_code_end");
    const uint32_t end = guard + IMAGE_RAM_BYTES;
    return expect(stack - guard == STEP, "the guard is what the unit can protect") &&
           lets("an overflow of the stack is a fault", guard, stack, "") &&
           lets("the stack is not executed", stack, code, "rw") &&
           lets("the code in the RAM is not written", code, variables, "rx") &&
           lets("variables are not executed", variables, end, "rw");
}

static bool passes(const char *path)
{
    if (!read_elf(path) || !open_rig(path)) {
        return wrong("the image cannot be loaded");
    }
    boot();
    return expect(says("configuration accepted"), "boots") && flash_is_protected() &&
           ram_is_protected() && lets("a null pointer is a fault", 0, NULL_BYTES, "") &&
           lets("peripherals are not executed", 0x40000000U, 0x40001000U, "rw") &&
           expect(chip_resets(rig.chip) == 1, "runs without a reset") && obeys_the_manuals();
}

int main(int argc, char **argv)
{
    const char *finds = planted_text(&argc, argv);
    if (argc != 2) {
        (void)fprintf(stderr, "usage: chip_protect ELF [--finds TEXT]\n");
        return 2;
    }
    return rig_result(passes(argv[1]), finds);
}

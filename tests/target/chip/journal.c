/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Power cuts while a record of the journal is written, on the model of the chip.
 *
 *     chip_journal ELF [EACH | status]
 *
 * The flashable image counts a start by the reset pin and records it a second later. Just before,
 * the chip is copied (a process each), loses its supply in one operation of the flash, gets it
 * back, boots, and the shell is asked for the count. Three series, with every EACH-th of their
 * operations (1 without):
 *
 *     append   of a record behind another one
 *     erase    of the older sector, at the start that finds the newer one full
 *     change   the first record in the sector that was erased
 *
 * status: one record without a cut, after which the shell has to report READY, without a fault.
 *
 * Exit code 0: the count is the old one until the last operation of a record, the old or the new
 * one in this, the new one after it; every eighth copy records another start behind; nothing that
 * a manual forbids.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "config/validate.h"
#include "copies.h"
#include "rig.h"

enum {
    GREETING_ms = 120,
    ERASING_ms = 1200, /* of a sector, by the data sheet */
    BEFORE_ms = 850,   /* from the greeting to just before the record */
    RECORD_ms = 300,   /* from there to its end */
    ANSWER_ms = 150,
    ERASES = 10, /* an erase that ends in different bits each */
    EACH_GOES_ON = 8,
    MOST_BYTES = 1024 /* of a record */
};
enum { WORD_SEQUENCE = 1, WORD_SIZE = 2 }; /* of a record; the last one is its sum */

typedef enum { RIGHT, WRONG, CODES } code_t;
static const char ASKED[] = "times started by reset pin, since production ";

typedef struct {
    const char *name;
    uint32_t operations; /* of one that is not cut */
    uint32_t each;
    unsigned before; /* the count until then */
    bool at_start;   /* in the erase of a start */
    unsigned cuts, wrong;
} series_t;
static series_t series;

static void run_ms(unsigned duration_ms)
{
    chip_run(rig.chip, (chip_ticks_t)duration_ms * 1000U * CHIP_TICKS_PER_US);
}

static void start_by_pin(unsigned then_ms)
{
    chip_reset_by(rig.chip, CHIP_RESET_PIN);
    run_ms(GREETING_ms + then_ms);
}

/* To its prompt, after an erase if it has to. */
static void start_by_supply(void)
{
    const size_t from = strlen(chip_text(rig.chip));
    chip_power_cycle(rig.chip);
    for (unsigned ms = 0; ms < ERASING_ms; ms++) {
        if (strstr(&chip_text(rig.chip)[from], "configuration accepted") != NULL) {
            break;
        }
        run_ms(1);
    }
    run_ms(1);
}

/* What the shell says, to its prompt. */
static const char *answer(const char *command)
{
    const size_t from = strlen(chip_text(rig.chip));
    chip_type(rig.chip, command);
    for (unsigned ms = 0; ms < ANSWER_ms && strstr(&chip_text(rig.chip)[from], "> ") == NULL;
         ms++) {
        run_ms(1);
    }
    return &chip_text(rig.chip)[from];
}

/* Starts by the pin since production, as the shell says after the supply was gone. */
static unsigned counted(void)
{
    start_by_supply();
    const char *line = strstr(answer("blackbox\r"), ASKED);
    return line == NULL ? 0U : (unsigned)strtoul(line + strlen(ASKED), NULL, 10);
}

/* It starts by the pin once more and records that behind what was cut. */
static bool goes_on(unsigned count)
{
    start_by_pin(BEFORE_ms + RECORD_ms);
    return counted() == count + 1U;
}

static uint32_t operation_of(uint32_t number)
{
    return series.at_start ? 1U : number * series.each + 1U;
}

/* In the copy. */
static int work(uint32_t number)
{
    const uint32_t operation = operation_of(number);
    const unsigned noted = chip_violations(rig.chip);
    chip_seed(rig.chip, number + 1U);
    if (series.at_start) {
        chip_power_cycle(rig.chip);
    }
    chip_faults(rig.chip)->flash_cut_after = chip_flash_operations(rig.chip) + operation;
    run_ms(series.at_start ? ERASING_ms : RECORD_ms);
    const bool cut = !chip_has_power(rig.chip);
    const unsigned count = counted();
    const unsigned least = series.before + (operation > series.operations ? 1U : 0U);
    const unsigned most = series.before + (operation >= series.operations ? 1U : 0U);
    const bool good = cut == (operation <= series.operations) && count >= least &&
                      count <= (series.at_start ? series.before : most) &&
                      (number % EACH_GOES_ON != 0 || goes_on(count)) &&
                      chip_violations(rig.chip) == noted;
    if (!good) {
        printf("%s, operation %u: %s, count %u of %u\n%s\n%s\n", series.name, operation,
               cut ? "cut" : "not cut", count, series.before, chip_text(rig.chip),
               chip_violations(rig.chip) == noted ? "" : chip_violation_text(rig.chip, noted));
    }
    return good ? RIGHT : WRONG;
}

static void ended(uint32_t number, int code)
{
    (void)number;
    series.cuts++;
    series.wrong += code == RIGHT ? 0U : 1U;
}

static bool cut_each(const char *name, uint32_t operations, uint32_t each, unsigned before,
                     bool at_start)
{
    const series_t fresh = {.name = name,
                            .operations = operations,
                            .each = each,
                            .before = before,
                            .at_start = at_start};
    series = fresh;
    copies_run(at_start ? (uint32_t)ERASES : operations / each + 1U, work, ended);
    printf("| %s | %u | %u |\n", name, series.cuts, series.wrong);
    return expect(series.wrong == 0 && series.cuts > 1, name);
}

/* ---- a journal that is full ---- */

static bool write_record(uint32_t at, uint32_t words[], uint32_t size, uint32_t sequence)
{
    words[WORD_SEQUENCE] = sequence;
    words[size / 4U - 1U] = config_crc32(words, size - 4U);
    return chip_write(rig.chip, at, words, size);
}

/* A full of records like its newest one, which is the last; one older than they in B. */
static bool fill(uint32_t size)
{
    uint32_t words[MOST_BYTES / 4] = {0};
    const uint32_t places = (IMAGE_JOURNAL_B - IMAGE_JOURNAL_A) / size;
    bool good = chip_read(rig.chip, IMAGE_JOURNAL_A + size, words, size);
    const uint32_t first = words[WORD_SEQUENCE];
    for (uint32_t i = 0; i < places && good; i++) {
        good = write_record(IMAGE_JOURNAL_A + i * size, words, size, first + 1U + i);
    }
    return good && write_record(IMAGE_JOURNAL_B, words, size, first);
}

static bool is_erased(uint32_t begin, uint32_t end)
{
    bool good = true;
    for (uint32_t at = begin; at < end && good; at += 4U) {
        uint32_t word = 0;
        good = chip_read(rig.chip, at, &word, sizeof word) && word == UINT32_MAX;
    }
    return good;
}

/* ---- the series ---- */

static bool changes_sector(uint32_t size, uint32_t operations, uint32_t each)
{
    if (!expect(counted() == 2U && fill(size), "two starts are recorded") ||
        !cut_each("erase of the older sector", 1, 1, 2, true)) {
        return false;
    }
    return expect(counted() == 2U && is_erased(IMAGE_JOURNAL_B, IMAGE_JOURNAL_ENDS),
                  "a start erases the older sector, and counts as before") &&
           (start_by_pin(BEFORE_ms), true) &&
           cut_each("first record of a sector", operations, each, 2, false);
}

/* The core stands still while a word is programmed: no step may be missed for it. */
static bool keeps_its_status(const char *elf)
{
    if (!open_rig(elf)) {
        return wrong("the image cannot be loaded");
    }
    boot();
    start_by_pin(BEFORE_ms);
    const uint32_t before = chip_flash_operations(rig.chip);
    run_ms(RECORD_ms);
    return expect(before == 0 && chip_flash_operations(rig.chip) > 0, "a record is written") &&
           expect(strstr(answer("status\r"), "READY, ") != NULL, "and no fault comes") &&
           obeys_the_manuals();
}

static bool passes(const char *elf, uint32_t each)
{
    if (!open_rig(elf)) {
        return wrong("the image cannot be loaded");
    }
    boot();
    start_by_pin(BEFORE_ms + RECORD_ms);
    uint32_t size = 0;
    (void)chip_read(rig.chip, IMAGE_JOURNAL_A + 4U * WORD_SIZE, &size, sizeof size);
    size &= 0xFFFFU;
    const uint32_t operations = chip_flash_operations(rig.chip);
    if (!expect(counted() == 1U && size <= MOST_BYTES && operations == size / 4U / CHIP_CELL_WORDS,
                "a start is recorded")) {
        return false;
    }
    start_by_pin(BEFORE_ms);
    if (!cut_each("a record behind another one", operations, each, 1, false)) {
        return false;
    }
    run_ms(RECORD_ms);
    return changes_sector(size, operations, each) && obeys_the_manuals();
}

int main(int argc, char **argv)
{
    if (argc < 2 || argc > 3) {
        (void)fprintf(stderr, "usage: chip_journal ELF [EACH | status]\n");
        return 2;
    }
    if (argc > 2 && strcmp(argv[2], "status") == 0) {
        return rig_result(keeps_its_status(argv[1]), NULL);
    }
    const uint32_t each = argc > 2 ? (uint32_t)strtoul(argv[2], NULL, 10) : 1U;
    printf("| supply fails in | cuts | wrong |\n|---|---|---|\n");
    return rig_result(each > 0 && passes(argv[1], each), NULL);
}

/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Power cuts during updates of the configuration, on the model of the chip.
 *
 *     chip_cuts ELF CUTS RUNS [--finds TEXT]
 *     chip_cuts ELF every [--finds TEXT]
 *
 * The flashable image receives another configuration over its serial line, all but the last record:
 * the snapshot, a process that is copied for each cut. The copy gets the last record, loses its
 * supply at one erase or write of the flash, gets it back, and boots to the end of its check of
 * the configuration; RUNS of them on to RUN. Half of the cuts hit the update of sector B, half the
 * one of sector A that follows it; `every`: each operation of both. But for the RUNS the chip is in
 * BOOT on its internal oscillator, a tenth of the instructions.
 *
 * Exit code 0: the old or the new configuration after each cut, and RUN where it was asked for, and
 * nothing that a manual forbids; of an image with an error planted, that TEXT is among the findings
 * that are printed.
 */
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bench/bench.h"
#include "config/validate.h"
#include "copies.h"
#include "drive.h"
#include "image.h"
#include "planted.h"
#include "unity.h"

enum {
    STEP_us = 500,
    CHUNK = 200,    /* characters; the model's line takes 256 */
    BOOT_ms = 3000, /* watchdog 1 s, CRC of the program 0.5 s on the internal oscillator */
    UPDATE_ms = 3000,
    READY_PERIODS = 8000,
    RECORD_BYTES = 16,
    TEXT_BYTES = 1 << 16
};

/* What the supply fails in. */
typedef enum { ERASE, FIRST_WORD, IMAGE, LAST_WORD, MARK, COMPLEMENT, AFTER, PARTS } part_t;
static const char *const PART_TEXT[PARTS] = {"erase of the other sector", "first cell of the image",
                                             "a cell of the image",       "last cell of the image",
                                             "first cell of the mark",    "last cell of the mark",
                                             "after the update"};

typedef enum { OLD, NEW, NONE, NOT_RUN, OUTCOMES } outcome_t;
static const char *const OUTCOME_TEXT[OUTCOMES] = {"old", "new", "none", "not to RUN"};
enum { UNREADABLE = 16, FOUND = 32, FORBIDDEN = 64 }; /* added to a copy's exit code */

typedef struct {
    unsigned count[PARTS][OUTCOMES];
    unsigned runs, ran;
    unsigned unreadable; /* copies that have read a word whose error could not be corrected */
    unsigned forbidden;  /* in which something was that a manual forbids */
} table_t;

/* The cuts of one update. */
typedef struct {
    unsigned cuts, runs, later_runs; /* of the second update */
    bool every;
    const char *old_name, *new_name;
} series_t;

static chip_t *chip;
static config_t fixture, another, third; /* in this order */
static drive_t drive;
static char hex[TEXT_BYTES];
static bool on_crystal;
static table_t table;
static series_t series;
static const char *finds; /* NULL: no error is planted */
static bool found;

/* What is wrong, in words. */
static bool finding(const char *text)
{
    printf("found: %s\n", text);
    found = found || planted_is(text, finds);
    return false;
}

/* Without a crystal the timer has no clock, and inverter_trip() writes it all the same: such a
 * register ignores writes and reads as zero (RM0090 7.3.10, RM0440 7.2.17). */
static unsigned forbidden_since(unsigned noted)
{
    unsigned count = 0;
    for (unsigned i = noted; chip_violation_text(chip, i) != NULL; i++) {
        const char *text = chip_violation_text(chip, i);
        if (strstr(text, " of TIM1_BDTR without its clock") == NULL) {
            (void)finding(text);
            count++;
        }
    }
    return count;
}

/* The fixture's checks are Unity's. */
void setUp(void) {}

void tearDown(void) {}

static void run_us(unsigned duration_us)
{
    chip_run(chip, (chip_ticks_t)duration_us * CHIP_TICKS_PER_US);
}

/* Runs until the chip has written this since `from`; false after `most_ms`. */
static bool answers(size_t from, const char *text, unsigned most_ms)
{
    for (unsigned us = 0; us < most_ms * 1000U && chip_has_power(chip); us += STEP_us) {
        run_us(STEP_us);
        if (strstr(&chip_text(chip)[from], text) != NULL) {
            return true;
        }
    }
    return false;
}

/* As objcopy writes it, without the record that ends it. */
static void make_hex(const config_t *config)
{
    const uint8_t *bytes = (const uint8_t *)config;
    size_t size = 0;
    for (unsigned at = 0; at < sizeof *config; at += RECORD_BYTES) {
        const unsigned left = (unsigned)sizeof *config - at;
        const unsigned length = left < RECORD_BYTES ? left : RECORD_BYTES;
        unsigned sum = length + (at >> 8) + (at & 0xFFU);
        size += (size_t)sprintf(&hex[size], ":%02X%04X00", length, at);
        for (unsigned i = 0; i < length; i++) {
            size += (size_t)sprintf(&hex[size], "%02X", bytes[at + i]);
            sum += bytes[at + i];
        }
        size += (size_t)sprintf(&hex[size], "%02X\r", (0x100U - (sum & 0xFFU)) & 0xFFU);
    }
}

/* At the rate of the line. */
static void type(const char *text)
{
    for (size_t left = strlen(text); left > 0;) {
        char part[CHUNK + 1];
        const size_t count = left < CHUNK ? left : CHUNK;
        memcpy(part, text, count);
        part[count] = '\0';
        chip_type(chip, part);
        run_us((unsigned)(count * 10U * 1000000U / 115200U));
        text += count;
        left -= count;
    }
}

/* The chip on its board at rest, from power-on to its prompt. */
static bool boots_with(const char *name)
{
    const size_t from = strlen(chip_text(chip));
    chip_faults(chip)->crystal_dead = !on_crystal;
    drive_begin(&drive, chip, &fixture);
    char banner[80];
    (void)snprintf(banner, sizeof banner, "configuration %s ", name);
    return strstr(&chip_text(chip)[from], banner) != NULL ||
           answers(from, banner, (unsigned)BOOT_ms);
}

/* All of an update but its last record. */
static bool prepare(const config_t *config)
{
    const size_t from = strlen(chip_text(chip));
    make_hex(config);
    type("install\r");
    if (!answers(from, "send the configuration", 100)) {
        return false;
    }
    type(hex);
    return strstr(&chip_text(chip)[from], "refused") == NULL;
}

static bool update(void)
{
    const size_t from = strlen(chip_text(chip));
    type(":00000001FF\r");
    return answers(from, "written, restarting", (unsigned)UPDATE_ms);
}

static bool comes_to_run(void)
{
    bench_params_t params = image_vehicle();
    const driver_trace_t none = {.points = 0};
    static bench_t bench;
    bench_init(&bench, &params, &fixture, &none);
    const wheel_coupling_t coupling = drive_coupling(&drive);
    bench.wheel[0].coupling = &coupling;
    bench.speed_prescribed = true;
    bench.vehicle.speed_m_per_s = 0.0;
    for (int i = 0; i < READY_PERIODS && bench.wheel[0].slow.mode != IMAGE_MODE; i++) {
        bench_period(&bench);
    }
    return bench.wheel[0].slow.mode == IMAGE_MODE;
}

static outcome_t outcome_of(size_t from, const char *old_name, const char *new_name, bool to_run)
{
    if (!answers(from, "configuration accepted", (unsigned)BOOT_ms)) {
        return NONE;
    }
    char banner[80];
    (void)snprintf(banner, sizeof banner, "configuration %s ", old_name);
    outcome_t outcome = strstr(&chip_text(chip)[from], banner) != NULL ? OLD : NONE;
    (void)snprintf(banner, sizeof banner, "configuration %s ", new_name);
    outcome = strstr(&chip_text(chip)[from], banner) != NULL ? NEW : outcome;
    return to_run && !comes_to_run() ? NOT_RUN : outcome;
}

/* In the copy. */
static outcome_t cut(uint32_t operation, uint32_t seed, const char *old_name, const char *new_name,
                     bool to_run)
{
    chip_seed(chip, seed);
    chip_faults(chip)->flash_cut_after = chip_flash_operations(chip) + operation;
    (void)update();
    chip_power_cycle(chip);
    const size_t from = strlen(chip_text(chip));
    on_crystal = on_crystal || to_run;
    chip_faults(chip)->crystal_dead = !on_crystal;
    drive_begin(&drive, chip, &fixture);
    return outcome_of(from, old_name, new_name, to_run);
}

/* Operations of an update: the erases, the cells of the image, those of the mark, which is two
 * words. */
enum {
    CELL_BYTES = 4 * CHIP_CELL_WORDS,
    ERASES = CHIP_UPDATE_ERASES,
    CELLS = (sizeof(config_t) + CELL_BYTES - 1) / CELL_BYTES,
    MARK_CELLS = 2 / CHIP_CELL_WORDS,
    OPERATIONS = ERASES + CELLS + MARK_CELLS
};

static part_t part_of(uint32_t operation)
{
    if (operation <= ERASES) {
        return ERASE;
    }
    if (operation == ERASES + 1) {
        return FIRST_WORD;
    }
    if (operation < ERASES + CELLS) {
        return IMAGE;
    }
    if (operation > OPERATIONS) {
        return AFTER;
    }
    return operation == ERASES + CELLS ? LAST_WORD : operation == OPERATIONS ? COMPLEMENT : MARK;
}

/* A quarter of the cuts each in the erase and in the mark, the rest over the image. */
static uint32_t operation_of(unsigned number)
{
    if (series.every) {
        return number + 1U;
    }
    switch (number % 8U) {
    case 0:
    case 5:
        return 1U + number / 8U % ERASES;
    case 1:
        return OPERATIONS;
    case 2:
        return ERASES + CELLS + 1U;
    case 4:
        return number % 16U == 4U ? (uint32_t)ERASES + CELLS
                                  : (number % 32U == 12U ? OPERATIONS + 1U : ERASES + 1U);
    default:
        return ERASES + 2U + (uint32_t)((uint64_t)(CELLS - 2U) * number / series.cuts);
    }
}

static bool goes_on_to_run(unsigned number)
{
    return (number + 1U) * series.runs / series.cuts != number * series.runs / series.cuts;
}

/* In the copy. */
static int work(uint32_t number)
{
    const uint32_t operation = operation_of(number);
    const unsigned noted = chip_violations(chip);
    const outcome_t seen =
        cut(operation, number + 1U, series.old_name, series.new_name, goes_on_to_run(number));
    if (seen >= NONE) {
        printf("cut %u at operation %u:\n%s\n", number, operation, chip_text(chip));
    }
    const bool forbidden = forbidden_since(noted) > 0;
    return (int)seen + (chip_unreadable(chip) > 0 ? UNREADABLE : 0) + (found ? FOUND : 0) +
           (forbidden ? FORBIDDEN : 0);
}

static void ended(uint32_t number, int code)
{
    outcome_t seen = NONE;
    if (code >= 0 && code % UNREADABLE < OUTCOMES) {
        seen = (outcome_t)(code % UNREADABLE);
        table.unreadable += (code & UNREADABLE) != 0 ? 1U : 0U;
        table.forbidden += (code & FORBIDDEN) != 0 ? 1U : 0U;
        found = found || (code & FOUND) != 0;
    }
    table.count[part_of(operation_of(number))][seen]++;
    table.runs += goes_on_to_run(number) ? 1U : 0U;
    table.ran += goes_on_to_run(number) && seen < NONE ? 1U : 0U;
}

/* Before the mark's last cell the old one is in force, after it the new one. */
static bool is_right(int part, int outcome)
{
    return outcome == OLD ? part != AFTER : outcome == NEW && part >= COMPLEMENT;
}

static bool print(void)
{
    unsigned wrong = 0;
    unsigned all = 0;
    printf(
        "| supply fails in | cuts | old | new | none | not to RUN |\n|---|---|---|---|---|---|\n");
    for (int part = 0; part < PARTS; part++) {
        const unsigned *n = table.count[part];
        const unsigned sum = n[OLD] + n[NEW] + n[NONE] + n[NOT_RUN];
        printf("| %s | %u | %u | %u | %u | %u |\n", PART_TEXT[part], sum, n[OLD], n[NEW], n[NONE],
               n[NOT_RUN]);
        all += sum;
    }
    for (int part = 0; part < PARTS; part++) {
        for (int outcome = 0; outcome < OUTCOMES; outcome++) {
            const unsigned count = is_right(part, outcome) ? 0U : table.count[part][outcome];
            char text[80];
            (void)snprintf(text, sizeof text, "%s: %s", PART_TEXT[part], OUTCOME_TEXT[outcome]);
            wrong += count;
            if (count > 0) {
                (void)finding(text);
            }
        }
    }
    printf("%u cuts, %u of %u to RUN, %u wrong; unreadable words met in %u\n", all, table.ran,
           table.runs, wrong, table.unreadable);
    return wrong == 0 && all > 0 && table.ran == table.runs && table.forbidden == 0;
}

static void cut_often(const config_t *from, const config_t *to)
{
    series.old_name = from->name;
    series.new_name = to->name;
    copies_run(series.cuts, work, ended);
}

/* In the chip itself, whose supply stays. */
static bool updates_to(const config_t *config)
{
    const uint32_t before = chip_flash_operations(chip);
    if (!update()) {
        return finding("an update does not end");
    }
    const bool good = chip_flash_operations(chip) - before == OPERATIONS ||
                      finding("an update has another number of erases and writes");
    return (boots_with(config->name) || finding("an update is not in force after the restart")) &&
           good;
}

/* Of the update, and the update itself. */
static bool cuts_are_survived(const config_t *from, const config_t *to)
{
    if (!prepare(to)) {
        return finding("an update is not accepted");
    }
    cut_often(from, to);
    return updates_to(to);
}

static bool all_cuts(void)
{
    if (!boots_with(fixture.name)) {
        return finding("does not boot");
    }
    const bool first = cuts_are_survived(&fixture, &another);
    series.runs = series.later_runs;
    const bool second = (first || finds != NULL) && cuts_are_survived(&another, &third);
    const bool survived = print();
    return forbidden_since(0) == 0 && first && second && survived;
}

static config_t renamed(const config_t *config, const char *name)
{
    config_t out = *config;
    memset(out.name, 0, sizeof out.name);
    (void)snprintf(out.name, sizeof out.name, "%s", name);
    out.crc32 = config_crc32(&out, (uint32_t)offsetof(config_t, crc32));
    return out;
}

int main(int argc, char **argv)
{
    finds = planted_text(&argc, argv);
    series.every = argc == 3 && strcmp(argv[2], "every") == 0;
    if (argc != 4 && !series.every) {
        (void)fprintf(stderr, "usage: chip_cuts ELF CUTS RUNS|every [--finds TEXT]\n");
        return 2;
    }
    series.cuts = series.every ? OPERATIONS + 1U : (unsigned)strtoul(argv[2], NULL, 10) / 2U;
    const unsigned runs = series.every ? 0U : (unsigned)strtoul(argv[3], NULL, 10);
    series.runs = runs / 2U;
    series.later_runs = runs - series.runs;
    fixture = image_config();
    another = renamed(&fixture, "another");
    third = renamed(&fixture, "third");
    chip = chip_open(argv[1]);
    if (chip == NULL) {
        return 2;
    }
    const bool good = all_cuts();
    if (!good && finds == NULL) {
        printf("%s\n", chip_text(chip));
    }
    chip_close(chip);
    if (finds != NULL) {
        printf("%s\n", good ? "NOT FOUND" : found ? "found" : "FAILS FOR ANOTHER REASON");
    }
    return (finds == NULL ? good : !good && found) ? 0 : 1;
}

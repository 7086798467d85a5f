/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Power cuts during updates of the configuration, on the model of the chip.
 *
 *     chip_cuts ELF CUTS RUNS [crystal|planted]
 *
 * The flashable image receives another configuration over its serial line, all but the last record:
 * the snapshot, a process that is copied for each cut. The copy gets the last record, loses its
 * supply at one erase or write of the flash, gets it back, and boots to the end of its check of
 * the configuration; RUNS of them on to RUN. Half of the cuts hit the update of sector B, half the
 * one of sector A that follows it. Without `crystal` the chip, but for those runs, is in BOOT on
 * its internal oscillator, a tenth of the instructions.
 *
 * Exit code 0: the old or the new configuration after each cut, and RUN where it was asked for;
 * with `planted`, an image with an error: not so.
 */
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "bench/bench.h"
#include "config/validate.h"
#include "drive.h"
#include "image.h"
#include "unity.h"

enum {
    STEP_us = 500,
    CHUNK = 200,    /* characters; the model's line takes 256 */
    BOOT_ms = 3000, /* watchdog 1 s, CRC of the program 0.5 s on the internal oscillator */
    UPDATE_ms = 3000,
    READY_PERIODS = 8000,
    RECORD_BYTES = 16,
    JOBS = 4, /* copies at the same time */
    TEXT_BYTES = 1 << 16
};

/* What the supply fails in. */
typedef enum { ERASE, FIRST_WORD, IMAGE, LAST_WORD, MARK, COMPLEMENT, AFTER, PARTS } part_t;
static const char *const PART_TEXT[PARTS] = {"erase of the other sector", "first cell of the image",
                                             "a cell of the image",       "last cell of the image",
                                             "first cell of the mark",    "last cell of the mark",
                                             "after the update"};

typedef enum { OLD, NEW, NONE, NOT_RUN, OUTCOMES } outcome_t;
enum { UNREADABLE = 16 }; /* added to a copy's exit code */

typedef struct {
    unsigned count[PARTS][OUTCOMES];
    unsigned runs, ran;
    unsigned unreadable; /* copies that have read a word whose error could not be corrected */
} table_t;

static chip_t *chip;
static config_t fixture, another, third;
static drive_t drive;
static char hex[TEXT_BYTES];
static bool on_crystal;

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
static uint32_t operation_of(unsigned number, unsigned cuts)
{
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
        return ERASES + 2U + (uint32_t)((uint64_t)(CELLS - 2U) * number / cuts);
    }
}

/* A copy at work. */
typedef struct {
    pid_t process; /* 0: none */
    uint32_t operation;
    bool to_run;
} job_t;

static void collect(table_t *table, job_t *jobs)
{
    int status = 0;
    const pid_t ended = wait(&status);
    for (int j = 0; j < JOBS; j++) {
        if (jobs[j].process != ended || ended <= 0) {
            continue;
        }
        outcome_t seen = NONE;
        if (WIFEXITED(status) && WEXITSTATUS(status) % UNREADABLE < OUTCOMES) {
            seen = (outcome_t)(WEXITSTATUS(status) % UNREADABLE);
            table->unreadable += WEXITSTATUS(status) >= UNREADABLE ? 1U : 0U;
        }
        table->count[part_of(jobs[j].operation)][seen]++;
        table->runs += jobs[j].to_run ? 1U : 0U;
        table->ran += jobs[j].to_run && seen < NONE ? 1U : 0U;
        jobs[j].process = 0;
    }
}

static int free_job(const job_t *jobs)
{
    for (int j = 0; j < JOBS; j++) {
        if (jobs[j].process == 0) {
            return j;
        }
    }
    return JOBS;
}

static bool any_at_work(const job_t *jobs)
{
    bool any = false;
    for (int j = 0; j < JOBS; j++) {
        any = any || jobs[j].process != 0;
    }
    return any;
}

static pid_t start(unsigned number, const job_t *job, const char *old_name, const char *new_name)
{
    (void)fflush(stdout);
    const pid_t copy = fork();
    if (copy != 0) {
        return copy;
    }
    const outcome_t seen = cut(job->operation, number + 1U, old_name, new_name, job->to_run);
    if (seen >= NONE) {
        (void)printf("cut %u at operation %u:\n%s\n", number, job->operation, chip_text(chip));
        (void)fflush(stdout);
    }
    _exit((int)seen + (chip_unreadable(chip) > 0 ? UNREADABLE : 0));
}

static void cut_often(table_t *table, unsigned cuts, unsigned runs, const char *old_name,
                      const char *new_name)
{
    job_t jobs[JOBS] = {{.process = 0}};
    for (unsigned i = 0; i < cuts; i++) {
        while (free_job(jobs) == JOBS) {
            collect(table, jobs);
        }
        job_t *job = &jobs[free_job(jobs)];
        job->operation = operation_of(i, cuts);
        job->to_run = (i + 1U) * runs / cuts != i * runs / cuts;
        job->process = start(i, job, old_name, new_name);
        if (job->process < 0) {
            job->process = 0;
            table->count[part_of(job->operation)][NONE]++;
        }
    }
    while (any_at_work(jobs)) {
        collect(table, jobs);
    }
}

static bool print(const table_t *table)
{
    unsigned bad = 0;
    unsigned all = 0;
    printf(
        "| supply fails in | cuts | old | new | none | not to RUN |\n|---|---|---|---|---|---|\n");
    for (int part = 0; part < PARTS; part++) {
        const unsigned *n = table->count[part];
        const unsigned sum = n[OLD] + n[NEW] + n[NONE] + n[NOT_RUN];
        printf("| %s | %u | %u | %u | %u | %u |\n", PART_TEXT[part], sum, n[OLD], n[NEW], n[NONE],
               n[NOT_RUN]);
        bad += n[NONE] + n[NOT_RUN];
        /* What is in force before the mark's last cell, and after it. */
        bad += part < COMPLEMENT ? n[NEW] : 0U;
        bad += part == AFTER ? n[OLD] : 0U;
        all += sum;
    }
    printf("%u cuts, %u of %u to RUN, %u wrong; unreadable words met in %u\n", all, table->ran,
           table->runs, bad, table->unreadable);
    return bad == 0 && all > 0 && table->ran == table->runs;
}

static bool fails(const char *what)
{
    printf("%s\n%s\n", what, chip_text(chip));
    return false;
}

static bool all_cuts(unsigned cuts, unsigned runs)
{
    table_t table = {.runs = 0};
    if (!boots_with(fixture.name) || !prepare(&another)) {
        return fails("the update is not accepted");
    }
    cut_often(&table, cuts / 2U, runs / 2U, fixture.name, another.name);
    const uint32_t before = chip_flash_operations(chip);
    if (!update() || chip_flash_operations(chip) - before != OPERATIONS) {
        return fails("an update has another number of erases and writes");
    }
    if (!boots_with(another.name)) {
        return fails("the update is not in force after the restart");
    }
    if (!prepare(&third)) {
        return fails("the second update is not accepted");
    }
    cut_often(&table, cuts - cuts / 2U, runs - runs / 2U, another.name, third.name);
    if (!update() || !boots_with(third.name)) {
        return fails("the second update is not in force after the restart");
    }
    const bool good = print(&table);
    const char *violation = chip_violation_text(chip, 0);
    if (on_crystal && violation != NULL) {
        return fails(violation);
    }
    return good;
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
    if (argc < 4) {
        (void)fprintf(stderr, "usage: chip_cuts ELF CUTS RUNS [crystal|planted]\n");
        return 2;
    }
    on_crystal = argc > 4 && strcmp(argv[4], "crystal") == 0;
    const bool planted = argc > 4 && strcmp(argv[4], "planted") == 0;
    fixture = image_config();
    another = renamed(&fixture, "another");
    third = renamed(&fixture, "third");
    chip = chip_open(argv[1]);
    if (chip == NULL) {
        return 2;
    }
    const bool good =
        all_cuts((unsigned)strtoul(argv[2], NULL, 10), (unsigned)strtoul(argv[3], NULL, 10));
    chip_close(chip);
    if (planted) {
        printf("%s\n", good ? "NOT CAUGHT" : "caught");
    }
    return good != planted ? 0 : 1;
}

/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Everything that is read from a memory which may hold anything, under a coverage-guided fuzzer:
 * configuration, black box, crash record, journal of faults, the two configurations in flash, Intel
 * HEX. Address and undefined-behaviour sanitizers watch the arithmetic; the checks are properties
 * of every run, each beside its reader. Images lie in memory of exactly their size.
 *
 * The first byte says which reader, the others change an image that was good.
 */
#include <stdlib.h>
#include <string.h>

#include "app/config_store.h"
#include "app/fault_journal.h"
#include "app/recorder.h"
#include "app/report.h"
#include "comms/intel_hex.h"
#include "config/fields.h"
#include "config/validate.h"
#include "flash_fake.h"
#include "fuzz_bytes.h"

extern const config_t CONFIG_LU2013, CONFIG_EBIKE36V, CONFIG_SCOOTER48V, CONFIG_IPM400V;

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static const config_t *const CONFIGS[] = {&CONFIG_LU2013, &CONFIG_EBIKE36V, &CONFIG_SCOOTER48V,
                                          &CONFIG_IPM400V};

static void require_text(const text_t *line)
{
    require(line->length < TEXT_CAPACITY && line->chars[line->length] == '\0');
    for (uint32_t i = 0; i < line->length; i++) {
        require(line->chars[i] >= ' ' && line->chars[i] <= '~');
    }
}

/* ---- configuration: accepted only with its checksum, a name and every field in its range ---- */

static void require_accepted(const config_t *config)
{
    require(config->magic == CONFIG_MAGIC && config->format_version == CONFIG_FORMAT_VERSION);
    require(config->size_bytes == sizeof *config);
    require(config->crc32 == crc_of(config, offsetof(config_t, crc32)));
    require(config->name[0] != '\0');
    config_field_t field = config_field_first();
    do {
        for (uint32_t k = 0; k < field.count; k++) {
            const int32_t value = config_field_value(config, &field, k);
            require(value >= field.lowest && value <= field.highest);
        }
    } while (config_field_next(&field));
    text_t line;
    text_clear(&line);
    report_identity(config, &line);
    require_text(&line);
}

static void read_configuration(bytes_t *bytes)
{
    static config_t image;
    const uint8_t how = take8(bytes);
    change_words(&image, CONFIGS[how & 3U], bytes);
    if ((how & 0x1CU) != 0) {
        image.crc32 = crc_of(&image, offsetof(config_t, crc32));
    }
    const size_t size = (how & 0xE0U) != 0 ? sizeof image : take16(bytes) % (sizeof image + 1U);
    config_t *const found = malloc(size > 0 ? size : 1U);
    memcpy(found, &image, size);
    const config_result_t result = config_validate(found, (uint32_t)size);
    require(result.field != NULL);
    require(size == sizeof image || result.code == CONFIG_RESULT_SIZE);
    if (result.code == CONFIG_RESULT_OK) {
        require_accepted(found);
    } else {
        text_t line;
        text_clear(&line);
        report_refusal(&result, &line);
        require_text(&line);
    }
    require(result.code != CONFIG_RESULT_RANGE || result.value < result.lowest ||
            result.value > result.highest);
    free(found);
}

/* ---- black box: its indices stay inside, a record is kept only whole, all of it is printed ----
 */

static void make_box(recorder_memory_t *box, bytes_t *bytes)
{
    recorder_t recorder;
    memset(box, take8(bytes), sizeof *box);
    const recorder_start_t start = {.pwm_frequency_Hz = 20000, .config_crc32 = 7};
    recorder_init(&recorder, box, &start);
    box->phase = take8(bytes) % (RECORDER_SEALED + 1U);
    box->reason = take8(bytes);
    for (int i = take8(bytes) % 4; i > 0; i--) {
        box->counts[take8(bytes) % RECORDER_COUNTED] = take16(bytes);
    }
    uint32_t sum = 0;
    for (int i = 0; i < RECORDER_COUNTED; i++) {
        sum += box->counts[i];
    }
    box->counts_check = ~sum;
    const size_t from = offsetof(recorder_memory_t, crc32) + sizeof box->crc32;
    box->crc32 = crc_of((const uint8_t *)box + from, sizeof *box - from);
    change_bytes(box, take8(bytes) % 2U != 0 ? 168U : sizeof *box, bytes);
}

static void require_box(const recorder_memory_t *box)
{
    require(box->magic == RECORDER_MAGIC && box->phase <= RECORDER_SEALED);
    require(box->fast_next < RECORDER_FAST_ENTRIES && box->slow_next < RECORDER_SLOW_ENTRIES);
}

static void print_box(const recorder_memory_t *box)
{
    const fault_journal_t journal = {.newest = NULL};
    const report_status_t status = {.black_box = box, .journal = &journal, .control = true};
    enum { LINES_MOST = 1 + RECORDER_COUNTED + (sizeof *box + 31) / 32 };
    for (uint32_t number = 0;; number++) {
        text_t line;
        text_clear(&line);
        const bool more = report_black_box(&status, number, &line);
        require_text(&line);
        require(number <= LINES_MOST);
        if (!more) {
            return;
        }
    }
}

static void step_box(recorder_t *recorder, recorder_memory_t *box, bytes_t *bytes)
{
    const recorder_phase_t before = (recorder_phase_t)box->phase;
    const uint8_t reason = box->reason;
    const uint8_t what = take8(bytes);
    slow_output_t output = {.mode = MODE_RUN, .speed_mrad_s = (int32_t)take32(bytes)};
    output.fault_reason = what < 16U ? (reason_t)take8(bytes) : REASON_NONE;
    output.hydraulic_torque_mNm = (int32_t)take32(bytes);
    const wheel_temperatures_t temperature = {(int32_t)take32(bytes), 2500};
    const recorder_fast_t sample = {.rotor = what};
    for (int n = what % 128; n >= 0; n--) {
        if (recorder->takes_samples) {
            recorder_fast(box, &sample, BRIDGE_PWM);
        }
        recorder_slow(recorder, &output, &temperature);
    }
    if (what >= 128U) {
        (void)recorder_seal(recorder);
    }
    require_box(box);
    require(box->phase >= before);
    require(before < RECORDER_ENDING || box->reason == reason);
}

static void read_box(bytes_t *bytes)
{
    recorder_memory_t *const box = malloc(sizeof *box);
    make_box(box, bytes);
    const size_t from = offsetof(recorder_memory_t, crc32) + sizeof box->crc32;
    const uint32_t crc = crc_of((const uint8_t *)box + from, sizeof *box - from);
    const bool whole = box->phase == RECORDER_SEALED && box->crc32 == crc;
    recorder_t recorder;
    const recorder_start_t start = {.pwm_frequency_Hz = 20000,
                                    .was_watchdog = take8(bytes) % 2U != 0,
                                    .reset_cause = take8(bytes)};
    recorder_init(&recorder, box, &start);
    require_box(box);
    require(box->phase != RECORDER_SEALED || (whole && !recorder.takes_samples));
    require(recorder.takes_samples == (box->phase == RECORDER_RECORDING));
    for (int steps = 0; bytes->left > 0 && steps < 12; steps++) {
        step_box(&recorder, box, bytes);
    }
    print_box(box);
    free(box);
}

/* ---- crash record: two lines of text, whatever its words are ---- */

static void read_crash(bytes_t *bytes)
{
    crash_record_t *const crash = malloc(sizeof *crash);
    for (int i = 0; i < CRASH_VALUES; i++) {
        crash->value[i] = take32(bytes);
    }
    crash->value[CRASH_CAUSE] >>= take8(bytes) % 32U;
    for (uint32_t number = 0; number < 4; number++) {
        text_t line;
        text_clear(&line);
        require(report_crash(crash, number, &line) == (number < 2U));
        require_text(&line);
    }
    free(crash);
}

/* ---- journal: the newest whole record, totals that never fall, power cuts ---- */

static bool is_record(const fault_record_t *record)
{
    const bool inside_a =
        (const uint8_t *)record >= (const uint8_t *)fake.word[FLASH_JOURNAL_A] &&
        (const uint8_t *)(record + 1) <= (const uint8_t *)fake.word[FLASH_JOURNAL_A + 2];
    return inside_a && record->size_bytes == sizeof *record &&
           record->tail[ENERGY_KINDS] == crc_of(record, sizeof *record - 4U);
}

/* Nothing from here on changes after a cut but what is in memory. */
static void append(fault_journal_t *journal, const recorder_memory_t *box)
{
    fault_journal_make_space(journal);
    uint32_t before[RECORDER_COUNTED];
    for (uint32_t i = 0; i < RECORDER_COUNTED; i++) {
        before[i] = fault_journal_total(journal, box, i);
    }
    flash_status_t status = fault_journal_append(journal, box);
    while (journal->written_bytes > 0) {
        status = fault_journal_append(journal, box);
    }
    if (status == FLASH_OK) {
        fault_journal_t again;
        fault_journal_init(&again);
        require(again.newest == journal->newest && is_record(again.newest));
        require(!fault_journal_is_due(&again, box));
        for (uint32_t i = 0; i < RECORDER_COUNTED; i++) {
            require(fault_journal_total(&again, box, i) == before[i]);
        }
    }
}

static void read_journal(bytes_t *bytes)
{
    static recorder_memory_t box;
    static fault_journal_t journal;
    static bytes_t rest;
    rest = *bytes;
    fake_deliver(&CONFIG_LU2013, sizeof CONFIG_LU2013);
    memset(&box, 0, sizeof box);
    fault_journal_init(&journal);
    fault_journal_number(&journal, &box);
    for (int steps = 0; rest.left > 0 && steps < 6; steps++) {
        const uint8_t what = take8(&rest);
        if (what < 128U) {
            box.counts[take8(&rest) % RECORDER_COUNTED]++;
        } else if (what < 160U) {
            const flash_sector_t sector = what % 2U != 0 ? FLASH_JOURNAL_A : FLASH_JOURNAL_B;
            change_bytes(fake.word[sector], FAKE_BYTES, &rest);
            fault_journal_init(&journal);
        } else if (what < 168U) { /* the supply comes back */
            memset(&box, 0, sizeof box);
            fault_journal_init(&journal);
            fault_journal_number(&journal, &box);
        }
        fake.bridge_on = what % 16U == 0;
        fake.cut_at = what % 8U == 0 ? fake.operations + take8(&rest) : 0;
        if (setjmp(fake.supply_lost) == 0) {
            append(&journal, &box);
        } else {
            fault_journal_init(&journal);
        }
        require(journal.newest == NULL || is_record(journal.newest));
    }
}

/* ---- two configurations: one of the two is in force, the old one until the new one is whole ----
 */

static void read_store(bytes_t *bytes)
{
    static config_t image;
    static bytes_t rest;
    rest = *bytes;
    fake_deliver(&CONFIG_LU2013, sizeof CONFIG_LU2013);
    for (int updates = 0; rest.left > 0 && updates < 4; updates++) {
        const uint8_t what = take8(&rest);
        if (what >= 192U) {
            const flash_sector_t sector =
                what % 2U != 0 ? FLASH_CONFIGURATION_A : FLASH_CONFIGURATION_B;
            uint32_t *const mark = &fake.word[sector][FAKE_WORDS - 2];
            mark[0] = take32(&rest);
            mark[1] = ~mark[0];
        }
        change_words(&image, CONFIGS[what & 3U], &rest);
        fake.cut_at = what % 8U == 0 ? fake.operations + take16(&rest) % FAKE_WORDS : 0;
        static config_store_t old;
        static uint32_t old_crc;
        old = config_store_in_force();
        old_crc = crc_of(old.image.begin, old.image.size_bytes);
        if (setjmp(fake.supply_lost) == 0) {
            require(config_store_replace(&image, sizeof image) == FLASH_OK);
            const config_store_t now = config_store_in_force();
            require(now.sector != old.sector && now.sequence != 0);
            require(memcmp(now.image.begin, &image, sizeof image) == 0);
        }
        const config_store_t now = config_store_in_force();
        require(now.sector == old.sector || memcmp(now.image.begin, &image, sizeof image) == 0);
        require(old_crc == crc_of(old.image.begin, old.image.size_bytes));
    }
}

/* ---- Intel HEX: never beyond the buffer, and what is whole has an end ---- */

static void read_hex(bytes_t *bytes)
{
    const uint32_t capacity = take8(bytes);
    uint8_t *const to = malloc(capacity > 0 ? capacity : 1U);
    intel_hex_t hex;
    memset(&hex, 0xA5, sizeof hex);
    intel_hex_init(&hex, to, capacity);
    bool ended = false;
    while (bytes->left > 0 && !ended) {
        ended = intel_hex_receive(&hex, take8(bytes));
        require(hex.size_bytes <= capacity);
        require(hex.problem == INTEL_HEX_GOOD || (hex.record >= 1U && hex.record <= hex.records));
        require(intel_hex_text(hex.problem)[0] != '\0');
    }
    free(to);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static void (*const READERS[])(bytes_t *) = {read_configuration, read_box,   read_crash,
                                                 read_journal,       read_store, read_hex};
    bytes_t bytes = {data, size};
    READERS[take8(&bytes) % (sizeof READERS / sizeof READERS[0])](&bytes);
    return 0;
}

/* SPDX-License-Identifier: Apache-2.0 */
/* Counters of faults since production: over resets, losses of the supply at every word, and full
 * sectors. */
#include <string.h>

#include "app/fault_journal.h"
#include "app/report.h"
#include "config/validate.h"
#include "flash_fake.h"
#include "unity.h"

enum {
    PLACES = FAKE_BYTES / (int)sizeof(fault_record_t),
    WORDS = (int)(sizeof(fault_record_t) / 4),
    FAULT = 13, /* any two */
    OTHER = 62
};

static fault_journal_t journal;
static recorder_memory_t box;

/* The RAM is lost; recorder_init() begins anew. As app_boot() does it. */
static void come_with_supply(void)
{
    memset(&box, 0, sizeof box);
    fault_journal_init(&journal);
    fault_journal_make_space(&journal);
    fault_journal_number(&journal, &box);
}

/* The RAM stays; by the watchdog, so no sector is erased. */
static void come_with_reset(void)
{
    fault_journal_init(&journal);
    fault_journal_number(&journal, &box);
}

static uint32_t since_production(uint32_t fault)
{
    return fault_journal_total(&journal, &box, fault);
}

/* A whole record, or what comes of it. */
static flash_status_t record(void)
{
    flash_status_t status = fault_journal_append(&journal, &box);
    while (journal.written_bytes > 0) {
        status = fault_journal_append(&journal, &box);
    }
    return status;
}

static void append(void)
{
    TEST_ASSERT_EQUAL_INT(FLASH_OK, record());
}

void setUp(void)
{
    fake_deliver(&box, 0);
    come_with_supply();
}

void tearDown(void) {}

void test_without_a_record_the_faults_of_this_supply_are_all_there_are(void)
{
    TEST_ASSERT_FALSE(fault_journal_is_due(&journal, &box));
    box.counts[FAULT] = 3;
    TEST_ASSERT_TRUE(fault_journal_is_due(&journal, &box));
    TEST_ASSERT_EQUAL_UINT32(3, since_production(FAULT));
    TEST_ASSERT_EQUAL_UINT32(0, since_production(OTHER));
}

void test_counters_add_up_over_supplies(void)
{
    for (uint32_t supply = 1; supply <= 5; supply++) {
        come_with_supply();
        box.counts[FAULT] = 2;
        box.counts[OTHER] = (uint16_t)supply;
        append();
        TEST_ASSERT_FALSE(fault_journal_is_due(&journal, &box));
        TEST_ASSERT_EQUAL_UINT32(2 * supply, since_production(FAULT));
        TEST_ASSERT_EQUAL_UINT32(supply * (supply + 1) / 2, since_production(OTHER));
    }
}

void test_a_reset_counts_no_fault_twice(void)
{
    box.counts[FAULT] = 2;
    append();
    come_with_reset();
    TEST_ASSERT_FALSE(fault_journal_is_due(&journal, &box));
    TEST_ASSERT_EQUAL_UINT32(2, since_production(FAULT));
    box.counts[FAULT]++;
    come_with_reset();
    TEST_ASSERT_EQUAL_UINT32(3, since_production(FAULT));
    append();
    come_with_supply();
    TEST_ASSERT_EQUAL_UINT32(3, since_production(FAULT));
}

void test_two_supplies_without_a_record_between_them_do_not_share_a_number(void)
{
    box.counts[FAULT] = 1;
    append();
    come_with_supply();
    const uint16_t first = box.supply;
    box.counts[FAULT] = 1;
    append();
    come_with_supply();
    TEST_ASSERT_NOT_EQUAL_UINT16(first, box.supply);
    box.counts[FAULT] = 1;
    TEST_ASSERT_EQUAL_UINT32(3, since_production(FAULT));
}

void test_counters_saturate(void)
{
    box.counts[FAULT] = UINT16_MAX;
    append();
    come_with_supply();
    box.counts[FAULT] = 10;
    TEST_ASSERT_EQUAL_UINT32(UINT16_MAX, since_production(FAULT));
    append();
    TEST_ASSERT_EQUAL_UINT32(UINT16_MAX, since_production(FAULT));
}

/* Returns whether the supply failed. */
static bool append_with_cut(uint32_t at, uint32_t seed)
{
    fake.operations = 0;
    fake.cut_at = at;
    fake.random = seed;
    if (setjmp(fake.supply_lost) != 0) {
        fake.cut_at = 0;
        return true;
    }
    (void)record();
    fake.cut_at = 0;
    return false;
}

/* `before` records precede the one that is cut: none, some, the last place of the sector. */
static void cut_everywhere(uint32_t before)
{
    for (uint32_t at = 1; at <= WORDS + 1; at++) {
        for (uint32_t seed = 0; seed < 8; seed++) {
            setUp();
            for (uint32_t i = 1; i <= before; i++) {
                box.counts[FAULT] = (uint16_t)i;
                append();
            }
            box.counts[FAULT] = (uint16_t)(before + 7U);
            const bool cut = append_with_cut(at, seed * 0x9E3779B9U);
            TEST_ASSERT_EQUAL(at <= WORDS, cut);
            come_with_supply();
            const uint32_t left = since_production(FAULT);
            TEST_ASSERT_TRUE(left == before || (at >= WORDS && left == before + 7U));
            /* Whatever the cut left behind, the next record is taken. */
            box.counts[FAULT] = 5;
            append();
            come_with_supply();
            TEST_ASSERT_EQUAL_UINT32(left + 5U, since_production(FAULT));
        }
    }
}

void test_a_cut_of_the_supply_leaves_the_last_whole_record(void)
{
    cut_everywhere(0);
    cut_everywhere(3);
    cut_everywhere(PLACES - 1);
    cut_everywhere(PLACES);
}

static void fill(uint32_t records)
{
    for (uint32_t i = 0; i < records; i++) {
        box.counts[OTHER]++;
        append();
    }
}

void test_a_full_sector_is_followed_by_the_other_one_and_then_by_a_refusal(void)
{
    fill(2 * PLACES);
    box.counts[OTHER]++;
    TEST_ASSERT_EQUAL_INT(FLASH_TOO_LARGE, record());
    TEST_ASSERT_EQUAL_UINT32(2 * PLACES + 1, since_production(OTHER));
}

void test_a_start_erases_the_older_sector_when_the_newer_one_is_nearly_full(void)
{
    for (uint32_t round = 0; round < 3; round++) {
        while (journal.next + FAULT_JOURNAL_RESERVE <= PLACES) {
            fake.operations = 0;
            fault_journal_make_space(&journal);
            TEST_ASSERT_EQUAL_UINT32(0, fake.operations);
            fill(1);
        }
        const uint32_t known = since_production(OTHER);
        come_with_reset();
        fault_journal_make_space(&journal);
        come_with_reset();
        TEST_ASSERT_EQUAL_UINT32(known, since_production(OTHER));
        const flash_sector_t full = journal.sector;
        fill(PLACES - journal.next + 1U);
        TEST_ASSERT_NOT_EQUAL_INT(full, journal.sector);
    }
}

void test_a_cut_while_the_older_sector_is_erased_loses_no_count(void)
{
    for (uint32_t seed = 0; seed < 32; seed++) {
        setUp();
        fill(2 * PLACES - 2);
        fake.operations = 0;
        fake.cut_at = 1;
        fake.random = seed * 0x9E3779B9U;
        if (setjmp(fake.supply_lost) == 0) {
            fault_journal_make_space(&journal);
        }
        fake.cut_at = 0;
        come_with_supply();
        TEST_ASSERT_EQUAL_UINT32(2 * PLACES - 2, since_production(OTHER));
        fault_journal_make_space(&journal);
        fill(4);
        come_with_supply();
        TEST_ASSERT_EQUAL_UINT32(2 * PLACES + 2, since_production(OTHER));
    }
}

void test_no_place_is_used_up_while_the_bridge_switches(void)
{
    box.counts[FAULT] = 1;
    fake.bridge_on = true;
    TEST_ASSERT_EQUAL_INT(FLASH_BRIDGE_ON, record());
    TEST_ASSERT_EQUAL_UINT32(0, journal.next);
    fake.bridge_on = false;
    append();
    TEST_ASSERT_EQUAL_UINT32(1, since_production(FAULT));
}

/* While a unit is programmed the core of an STM32G431 stands still for 83 us. */
void test_one_call_programs_one_unit_of_the_flash(void)
{
    box.counts[FAULT] = 1;
    for (uint32_t n = 1; n <= WORDS / 2; n++) {
        TEST_ASSERT_TRUE(fault_journal_is_due(&journal, &box));
        fake.operations = 0;
        TEST_ASSERT_EQUAL_INT(FLASH_OK, fault_journal_append(&journal, &box));
        TEST_ASSERT_EQUAL_UINT32(2, fake.operations); /* words */
        TEST_ASSERT_EQUAL_UINT32(n < WORDS / 2 ? n * FLASH_UNIT_BYTES : 0, journal.written_bytes);
    }
    TEST_ASSERT_FALSE(fault_journal_is_due(&journal, &box));
}

void test_a_count_that_comes_while_a_record_is_written_is_in_this_one_or_the_next(void)
{
    for (uint32_t after = 1; after < WORDS / 2; after++) {
        setUp();
        box.counts[FAULT] = 3;
        for (uint32_t n = 0; n < after; n++) {
            TEST_ASSERT_EQUAL_INT(FLASH_OK, fault_journal_append(&journal, &box));
        }
        box.counts[FAULT] = 5;
        append();
        TEST_ASSERT_EQUAL_UINT32(5, since_production(FAULT));
        if (fault_journal_is_due(&journal, &box)) {
            append();
        }
        come_with_supply();
        TEST_ASSERT_EQUAL_UINT32(5, since_production(FAULT));
    }
}

void test_a_bridge_that_switches_on_in_the_middle_of_a_record_uses_the_place_up(void)
{
    box.counts[FAULT] = 1;
    TEST_ASSERT_EQUAL_INT(FLASH_OK, fault_journal_append(&journal, &box));
    fake.bridge_on = true;
    TEST_ASSERT_EQUAL_INT(FLASH_BRIDGE_ON, fault_journal_append(&journal, &box));
    TEST_ASSERT_EQUAL_UINT32(0, journal.written_bytes);
    fake.bridge_on = false;
    append();
    TEST_ASSERT_EQUAL_UINT32(2, journal.next);
    come_with_supply();
    TEST_ASSERT_EQUAL_UINT32(1, since_production(FAULT));
}

void test_a_damaged_record_gives_way_to_the_one_before(void)
{
    box.counts[FAULT] = 4;
    append();
    box.counts[FAULT] = 6;
    append();
    fake.word[FLASH_JOURNAL_A][2 * WORDS - 2] ^= 1U;
    come_with_supply();
    TEST_ASSERT_EQUAL_UINT32(4, since_production(FAULT));
}

void test_a_word_that_is_not_taken_leaves_the_record_before_and_uses_the_place_up(void)
{
    box.counts[FAULT] = 4;
    append();
    fake.operations = 0;
    fake.fails_at = 9;
    box.counts[FAULT] = 5;
    TEST_ASSERT_EQUAL_INT(FLASH_WRITE_FAILED, record());
    TEST_ASSERT_EQUAL_UINT32(5, since_production(FAULT));
    append();
    TEST_ASSERT_EQUAL_UINT32(3, journal.next);
    come_with_supply();
    TEST_ASSERT_EQUAL_UINT32(5, since_production(FAULT));
}

/* ---- energies ---- */

static void spend(uint32_t steps_10J)
{
    for (uint32_t k = 0; k < ENERGY_KINDS; k++) {
        journal.energy.life_10J[k] += steps_10J * (k + 1U);
    }
}

static void assert_energies(uint32_t steps_10J)
{
    for (uint32_t k = 0; k < ENERGY_KINDS; k++) {
        TEST_ASSERT_EQUAL_UINT32(steps_10J * (k + 1U), journal.energy.life_10J[k]);
    }
}

void test_energies_are_stored_where_one_of_them_has_grown_by_a_kilojoule(void)
{
    journal.energy.life_10J[ENERGY_KINDS - 1] = FAULT_JOURNAL_ENERGY_10J - 1;
    TEST_ASSERT_FALSE(fault_journal_is_due(&journal, &box));
    journal.energy.life_10J[ENERGY_KINDS - 1]++;
    TEST_ASSERT_TRUE(fault_journal_is_due(&journal, &box));
    append();
    TEST_ASSERT_FALSE(fault_journal_is_due(&journal, &box));
    journal.energy.life_10J[0] = FAULT_JOURNAL_ENERGY_10J;
    TEST_ASSERT_TRUE(fault_journal_is_due(&journal, &box));
}

void test_energies_outlast_supplies_and_full_sectors(void)
{
    for (uint32_t n = 1; n <= 5 * PLACES; n++) {
        spend(100);
        append();
        come_with_supply();
        assert_energies(100 * n);
    }
}

/* 73 points of a record, 140 patterns of half-written words at each. */
void test_of_ten_thousand_cuts_each_leaves_the_old_energies_or_the_new_ones(void)
{
    uint32_t cuts = 0;
    for (uint32_t at = 1; at <= WORDS; at++) {
        for (uint32_t seed = 0; seed < 140; seed++) {
            setUp();
            spend(1000);
            append();
            spend(500);
            TEST_ASSERT_TRUE(append_with_cut(at, seed * 0x9E3779B9U));
            cuts++;
            come_with_supply();
            assert_energies(at == WORDS && journal.energy.life_10J[0] != 1000 ? 1500 : 1000);
        }
    }
    TEST_ASSERT_GREATER_OR_EQUAL_UINT32(10000, cuts);
}

/* ---- journals of format 1: the same without energies ---- */

enum { OLD_WORDS = WORDS - ENERGY_KINDS, OLD_PLACES = FAKE_BYTES / (4 * OLD_WORDS) };

static void put_old(flash_sector_t sector, uint32_t index, uint32_t sequence, uint16_t total)
{
    fault_record_t record = {.magic = 0x4C4E4A46,
                             .sequence = sequence,
                             .size_bytes = 4 * OLD_WORDS,
                             .supply = (uint16_t)sequence};
    record.total[FAULT] = total;
    record.included[FAULT] = total;
    uint32_t *words = &fake.word[sector][index * OLD_WORDS];
    memcpy(words, &record, 4 * OLD_WORDS);
    words[OLD_WORDS - 1] = config_crc32(words, 4 * (OLD_WORDS - 1));
}

void test_the_newest_record_of_format_1_is_read_and_goes_on_in_the_other_sector(void)
{
    for (uint32_t i = 0; i < OLD_PLACES; i++) {
        put_old(FLASH_JOURNAL_A, i, i + 1U, (uint16_t)(i + 1U));
    }
    come_with_supply();
    TEST_ASSERT_EQUAL_UINT32(OLD_PLACES, since_production(FAULT));
    assert_energies(0);
    box.counts[FAULT] = 2;
    spend(300);
    append();
    TEST_ASSERT_EQUAL_INT(FLASH_JOURNAL_B, journal.sector);
    come_with_supply();
    TEST_ASSERT_EQUAL_UINT32(OLD_PLACES + 2U, since_production(FAULT));
    assert_energies(300);
}

void test_two_sectors_of_format_1_lose_the_older_one_at_a_start_by_the_supply(void)
{
    put_old(FLASH_JOURNAL_A, 0, 1, 1);
    put_old(FLASH_JOURNAL_A, 1, 2, 2);
    put_old(FLASH_JOURNAL_B, 0, 3, 3);
    come_with_reset();
    box.counts[FAULT] = 1;
    TEST_ASSERT_EQUAL_INT(FLASH_TOO_LARGE, record());
    come_with_supply();
    TEST_ASSERT_EQUAL_UINT32(3, since_production(FAULT));
    box.counts[FAULT] = 1;
    append();
    TEST_ASSERT_EQUAL_INT(FLASH_JOURNAL_A, journal.sector);
    come_with_supply();
    TEST_ASSERT_EQUAL_UINT32(4, since_production(FAULT));
}

/* ---- as the shell shows them ---- */

static void assert_line(uint32_t number, const char *words)
{
    const report_status_t status = {.black_box = &box, .journal = &journal};
    text_t line;
    text_clear(&line);
    TEST_ASSERT_TRUE(report_black_box(&status, number, &line));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(line.chars, words), line.chars);
}

void test_the_black_box_names_the_start_that_ended_it_and_counts_starts(void)
{
    box.counts[RECORDER_FIRST_LOW - 1] = 4;   /* the last one of faults */
    box.counts[RECORDER_FIRST_START - 1] = 3; /* and of warnings with a number below them */
    box.counts[RECORDER_FIRST_START + RESET_PIN] = 2;
    append();
    come_with_supply();
    box.phase = RECORDER_COMPLETE;
    box.reason = REASON_PROGRAM_FLOW;
    box.fault_ms = 1234;
    box.after_reset = 1;
    box.ended_by = RESET_WATCHDOG;
    box.counts[RECORDER_FIRST_START + RESET_PIN] = 1;
    assert_line(0, "black box: record of 75 ");
    assert_line(0, ", 1234 ms after the start, ended by a reset, then started by watchdog");
    assert_line(1, "0 times unknown reason, since production 4");
    assert_line(2,
                "0 times current sensors: stored offsets, none measured yet, since production 3");
    assert_line(3, "1 times started by reset pin, since production 3");
}

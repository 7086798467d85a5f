/* SPDX-License-Identifier: Apache-2.0 */
#include "app/fault_journal.h"

#include <stddef.h>

#include "config/validate.h"

#define MAGIC UINT32_C(0x4C4E4A46) /* "FJNL", little endian */

_Static_assert(RECORDER_COUNTED % 2 == 0 && sizeof(fault_record_t) % FLASH_UNIT_BYTES == 0 &&
                   offsetof(fault_record_t, tail) + 4U * (ENERGY_KINDS + 1U) ==
                       sizeof(fault_record_t),
               "whole units of the flash without padding");

/* Of the record of format 1, which ends where that of format 2 has the energies. */
#define FORMAT_1_BYTES (uint32_t)(offsetof(fault_record_t, tail) + 4U)

static uint32_t places(flash_sector_t sector)
{
    return flash_sector(sector).size_bytes / (uint32_t)sizeof(fault_record_t);
}

static const fault_record_t *record_at(flash_sector_t sector, uint32_t index)
{
    return (const fault_record_t *)flash_sector(sector).begin + index;
}

static flash_sector_t other(flash_sector_t sector)
{
    return sector == FLASH_JOURNAL_A ? FLASH_JOURNAL_B : FLASH_JOURNAL_A;
}

/* The CRC is the last of size_bytes. */
static bool is_whole(const fault_record_t *record, uint32_t size_bytes)
{
    const uint32_t *const words = (const uint32_t *)record;
    return record->magic == MAGIC && record->size_bytes == size_bytes &&
           words[size_bytes / 4U - 1U] == config_crc32(record, size_bytes - 4U);
}

/* Index behind the last place that is not erased. */
static uint32_t used(flash_sector_t sector)
{
    const uint32_t words_a_place = (uint32_t)(sizeof(fault_record_t) / sizeof(uint32_t));
    const uint32_t *const words = (const uint32_t *)flash_sector(sector).begin;
    uint32_t at = places(sector) * words_a_place;
    while (at > 0 && words[at - 1U] == UINT32_MAX) {
        at--;
    }
    return (at + words_a_place - 1U) / words_a_place;
}

/* For records of one format; those of the other are none of it, wherever they begin. */
static void look_at(fault_journal_t *journal, flash_sector_t sector, uint32_t size_bytes)
{
    const flash_image_t image = flash_sector(sector);
    const uint32_t *const words = (const uint32_t *)image.begin;
    for (uint32_t at = 0; at + size_bytes <= image.size_bytes; at += size_bytes) {
        const fault_record_t *record = (const fault_record_t *)(words + at / 4U);
        const bool is_later = journal->newest == NULL ||
                              record->sequence - journal->newest->sequence < UINT32_C(0x80000000);
        if (is_later && is_whole(record, size_bytes)) {
            journal->newest = record;
            journal->sector = sector;
        }
    }
}

static uint32_t stored_energy_10J(const fault_journal_t *journal, uint32_t kind)
{
    const fault_record_t *newest = journal->newest;
    return newest != NULL && newest->size_bytes == sizeof *newest ? newest->tail[kind] : 0U;
}

void fault_journal_init(fault_journal_t *journal)
{
    static const fault_journal_t empty = {.newest = NULL, .sector = FLASH_JOURNAL_A};
    *journal = empty;
    look_at(journal, FLASH_JOURNAL_A, FORMAT_1_BYTES);
    look_at(journal, FLASH_JOURNAL_B, FORMAT_1_BYTES);
    look_at(journal, FLASH_JOURNAL_A, (uint32_t)sizeof(fault_record_t));
    look_at(journal, FLASH_JOURNAL_B, (uint32_t)sizeof(fault_record_t));
    const fault_record_t *newest = journal->newest;
    const bool is_format_1 = newest != NULL && newest->size_bytes == FORMAT_1_BYTES;
    journal->next = is_format_1 ? places(journal->sector) : used(journal->sector);
    const bool has = newest != NULL && newest->size_bytes == sizeof *newest;
    energy_init(&journal->energy, has ? newest->tail : empty.energy.life_10J);
}

static uint32_t next_sequence(const fault_journal_t *journal)
{
    return journal->newest == NULL ? 1U : journal->newest->sequence + 1U;
}

/* No record in flash can have this number: each one that is written makes the sequence longer. */
void fault_journal_number(const fault_journal_t *journal, recorder_memory_t *box)
{
    if (box->supply == 0) {
        const uint16_t number = (uint16_t)next_sequence(journal);
        box->supply = number == 0 ? (uint16_t)1 : number;
    }
}

void fault_journal_make_space(const fault_journal_t *journal)
{
    const bool is_short = journal->next + FAULT_JOURNAL_RESERVE > places(journal->sector);
    if (is_short && used(other(journal->sector)) > 0) {
        (void)flash_erase(other(journal->sector));
    }
}

/* Of a counter of the black box, what the newest record does not include. */
static uint32_t fresh(const fault_journal_t *journal, uint16_t supply, uint32_t index,
                      uint32_t counted)
{
    const fault_record_t *newest = journal->newest;
    const bool same_supply = newest != NULL && newest->supply == supply;
    const uint32_t included = same_supply ? newest->included[index] : 0U;
    return counted > included ? counted - included : 0U;
}

static uint32_t total(const fault_journal_t *journal, uint16_t supply, uint32_t index,
                      uint32_t counted)
{
    const uint32_t before = journal->newest == NULL ? 0U : journal->newest->total[index];
    const uint32_t sum = before + fresh(journal, supply, index, counted);
    return sum < UINT16_MAX ? sum : UINT16_MAX;
}

uint32_t fault_journal_total(const fault_journal_t *journal, const recorder_memory_t *box,
                             uint32_t index)
{
    return total(journal, box->supply, index, box->counts[index]);
}

bool fault_journal_is_due(const fault_journal_t *journal, const recorder_memory_t *box)
{
    bool due = journal->written_bytes > 0;
    for (uint32_t i = 0; i < RECORDER_COUNTED; i++) {
        due = due || fresh(journal, box->supply, i, box->counts[i]) > 0;
    }
    for (uint32_t k = 0; k < ENERGY_KINDS; k++) {
        const uint32_t grown_10J = journal->energy.life_10J[k] - stored_energy_10J(journal, k);
        due = due || grown_10J >= FAULT_JOURNAL_ENERGY_10J;
    }
    return due;
}

/* Two counters a word, the lower one first. The totals follow from what has been written of the
 * black box, which counts on meanwhile, so that both agree. */
static uint32_t word_of(const fault_journal_t *journal, const recorder_memory_t *box,
                        const fault_record_t *place, uint32_t word)
{
    enum {
        INCLUDED = offsetof(fault_record_t, included) / 4,
        TOTAL = offsetof(fault_record_t, total) / 4,
        TAIL = offsetof(fault_record_t, tail) / 4
    };
    if (word >= TAIL) {
        return journal->energy.life_10J[word - TAIL];
    }
    if (word >= TOTAL) {
        const uint32_t i = 2U * (word - TOTAL);
        return total(journal, box->supply, i, place->included[i]) |
               total(journal, box->supply, i + 1U, place->included[i + 1U]) << 16;
    }
    if (word >= INCLUDED) {
        const uint32_t i = 2U * (word - INCLUDED);
        return box->counts[i] | (uint32_t)box->counts[i + 1U] << 16;
    }
    switch (word) {
    case 0:
        return MAGIC;
    case 1:
        return next_sequence(journal);
    default:
        return (uint32_t)sizeof(fault_record_t) | (uint32_t)box->supply << 16;
    }
}

flash_status_t fault_journal_append(fault_journal_t *journal, const recorder_memory_t *box)
{
    const uint32_t at = journal->written_bytes;
    if (at == 0 && journal->next >= places(journal->sector)) {
        const flash_sector_t to = other(journal->sector);
        if (places(to) == 0 || used(to) > 0) {
            return places(to) == 0 ? FLASH_UNSUPPORTED : FLASH_TOO_LARGE;
        }
        journal->sector = to;
        journal->next = 0;
    }
    const fault_record_t *place = record_at(journal->sector, journal->next);
    const uint32_t begin = journal->next * (uint32_t)sizeof(fault_record_t);
    uint32_t unit[2] = {word_of(journal, box, place, at / 4U), 0};
    unit[1] = at + FLASH_UNIT_BYTES < sizeof(fault_record_t)
                  ? word_of(journal, box, place, at / 4U + 1U)
                  : config_crc32_continue(config_crc32(place, at), unit, 4U);
    const flash_status_t status = flash_program(journal->sector, begin + at, unit, sizeof unit);
    if (status == FLASH_OK && at + FLASH_UNIT_BYTES < sizeof *place) {
        journal->written_bytes = at + FLASH_UNIT_BYTES;
        return FLASH_OK;
    }
    journal->written_bytes = 0;
    /* A place of which something was written is used up. */
    journal->next += status == FLASH_BRIDGE_ON && at == 0 ? 0U : 1U;
    if (status == FLASH_OK) {
        journal->newest = place;
    }
    return status;
}

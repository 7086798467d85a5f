/* SPDX-License-Identifier: Apache-2.0 */
/*
 * fault_journal.h: how often each fault and warning, and each start but those by the supply, came
 * since production, and the energy account for life (energy.h), in flash. Background context.
 *
 *     black box (RAM, since the supply came) --difference--> record (flash, since production)
 *
 * A record holds all totals and the counters of the black box that they include, so that a reset,
 * which the black box survives, counts no fault twice. Records are appended in two sectors; in
 * force is the whole one (CRC) with the highest sequence number. A supply that fails while one is
 * written leaves the one before.
 *
 * The older sector is erased at a start by the supply (fault_journal_make_space()) when the newer
 * one is nearly full: an erase takes up to a second. A record is written one unit of the flash at a
 * time, because the core may stand still meanwhile (a double word of an STM32G431: 83 us, two PWM
 * interrupts that do not come): a record at a stretch would be a fault of the program flow. A
 * sector lasts 10 000 erases: of 16 KiB, which hold 56 records, 560 000 records; of 2 KiB, seven
 * records, 70 000.
 *
 * Energy alone makes a record where it has grown by FAULT_JOURNAL_ENERGY_10J: one each time the
 * driver switches off at rest. Two sectors of 16 KiB last 1.1 million of these.
 *
 * A journal of format 1, whose records lack the energies, is read; its sector counts as full.
 *
 * Warnings are counted only while torque may be enabled and written only while it is not, so a
 * warning that stays, or comes and goes, makes one record at most each time the driver switches
 * off; when both sectors are full nothing is written until the next start by the supply. At most
 * one erase such a start in any case.
 *
 * Not counted are faults of a drive whose supply ends before the wheel was at rest once.
 */
#ifndef APP_FAULT_JOURNAL_H
#define APP_FAULT_JOURNAL_H

#include <stdbool.h>
#include <stdint.h>

#include "app/energy.h"
#include "app/recorder.h"
#include "hal/flash.h"

/* Fewer free records than this in the sector in use at a start: the other one is erased. */
enum { FAULT_JOURNAL_RESERVE = 16 };

enum { FAULT_JOURNAL_ENERGY_10J = 100 };

typedef struct {
    uint32_t magic;
    uint32_t sequence;
    uint16_t size_bytes;
    uint16_t supply;                     /* recorder_memory_t.supply that `included` is of */
    uint16_t included[RECORDER_COUNTED]; /* counters of the black box within the totals */
    uint16_t total[RECORDER_COUNTED];    /* since production, saturating */
    uint32_t tail[ENERGY_KINDS + 1];     /* energies for life in 10 J, and the CRC-32 of all
                                                      bytes before it; format 1 has no energies */
} fault_record_t;

typedef struct {
    const fault_record_t *newest; /* NULL: there is none */
    flash_sector_t sector;        /* that the next record goes to */
    uint32_t next;                /* its index there */
    uint32_t written_bytes;       /* of a record that is being written; 0: none is */
    energy_t energy;              /* began with what the newest record had; the owner counts on */
} fault_journal_t;

/* Finds the newest record. Reads only. */
void fault_journal_init(fault_journal_t *journal);

/* Numbers the black box if its counters began at zero with this start. */
void fault_journal_number(const fault_journal_t *journal, recorder_memory_t *box);

/* At a start by the supply, before control: erases the older sector if the newer one is
 * nearly full; the core then stands still for up to a second. */
void fault_journal_make_space(const fault_journal_t *journal);

/* Of the counter `index` of the black box, since production. */
uint32_t fault_journal_total(const fault_journal_t *journal, const recorder_memory_t *box,
                             uint32_t index);

/* A record is being written, or the black box has counted something that the newest one does not
 * include, or the energies have grown. */
bool fault_journal_is_due(const fault_journal_t *journal, const recorder_memory_t *box);

/* Appends a record, one unit a call; journal->written_bytes is 0 again with the last one, and after
 * a failure. At most one call a millisecond. Precondition: the wheel at rest, torque not enabled.
 * FLASH_BRIDGE_ON: the bridge switches, nothing was written. FLASH_TOO_LARGE: both sectors are full
 * until the next start. After other failures, and in the middle of a record, the next call takes
 * the place behind. */
flash_status_t fault_journal_append(fault_journal_t *journal, const recorder_memory_t *box);

#endif

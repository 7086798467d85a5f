/* SPDX-License-Identifier: Apache-2.0 */
/*
 * recorder.h: the black box: what happened around the first fault, and how often each fault and
 * each warning of the list of faults (core/reason.h) came.
 *
 * The memory is the caller's: recorder_memory_t, 8 KiB that keep their content over a reset. Two
 * rings are written until RECORDER_FAST_AFTER_ms and RECORDER_SLOW_AFTER_ms after the first fault:
 * the raw samples of RECORDER_FAST_ENTRIES PWM periods (20 ms at 20 kHz), and the slow step's
 * results at 100 Hz over 2 s. The record of the first fault since the supply came is kept; nothing
 * but losing the supply makes space for another. A reset by a watchdog in the middle of a recording
 * ends it like a fault. Starts are counted by their cause, but for those by the supply and those
 * that recorder_expect_restart() announced.
 *
 * A fault is counted when it is latched, a warning when it appears while torque may be enabled
 * (RUN, LIMP), but not again until for RECORDER_CALM_ms there has been no warning at all: one that
 * comes and goes faster, or by turns with another, counts once.
 *
 *     recorder_init()   once, at boot
 *
 *     recorder_fast()   every PWM period; about twenty instructions
 *
 *     recorder_slow()   every millisecond, after the slow step
 *
 *     recorder_seal()   background, any rate: adds the CRC to a record that is complete
 *
 * recorder_fast() may interrupt the other functions: it alone writes the fast ring and its index
 * while takes_samples is true.
 */
#ifndef APP_RECORDER_H
#define APP_RECORDER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "core/bridge.h"
#include "core/slow_messages.h"

enum {
    RECORDER_FAST_ENTRIES = 400,
    RECORDER_FAST_AFTER_ms = 5,
    RECORDER_SLOW_ENTRIES = 200,
    RECORDER_SLOW_PERIOD_ms = 10,
    RECORDER_SLOW_AFTER_ms = 500,
    RECORDER_CALM_ms = 1000,
    RECORDER_FIRST_COUNTED = REASON_FIRST_FAULT,
    RECORDER_COUNTED = 64, /* counters: of faults, the last ones of starts */
    RECORDER_STARTS = 9,   /* causes of a start: 0 unknown, 1 the supply, others counted */
    RECORDER_START_BY_SUPPLY = 1,
    RECORDER_FIRST_START = RECORDER_COUNTED - RECORDER_STARTS, /* counter of cause 0 */
    /* Before them those of the rows below RECORDER_FIRST_COUNTED: recorder_counted(). */
    RECORDER_FIRST_LOW = RECORDER_FIRST_START - 5,
    RECORDER_FORMAT = 1,
    RECORDER_BRIDGE_SHIFT = 14
};
#define RECORDER_MAGIC UINT32_C(0x42464F46) /* "FOFB", little endian */

/* One PWM period. The numbers as they came from the converters and went to the timer. */
typedef struct {
    uint16_t phase_code[3]; /* phase currents, 12 bits */
    uint16_t bus_code;      /* bus voltage, 12 bits; bridge_mode_t in the highest two bits */
    uint16_t rotor;         /* angle, encoder count or hall state: of the sensor there is */
    uint16_t on_a_counts;   /* compare value of phase a */
} recorder_fast_t;

/* One slow step; every field saturated. */
typedef struct {
    int16_t speed_dr_s;         /* 0.1 rad/s, mechanical */
    int16_t torque_command_dNm; /* 0.1 N m */
    int16_t torque_estimate_dNm;
    int16_t hydraulic_dNm;
    int16_t bus_dV; /* 0.1 V */
    int16_t bus_dA; /* 0.1 A, positive out of the battery */
    int8_t winding_C;
    int8_t switch_C;
    uint8_t mode;   /* operating_mode_t */
    uint8_t reason; /* the fault, else what bounds the torque */
} recorder_slow_t;

typedef enum {
    RECORDER_EMPTY = 0,
    RECORDER_RECORDING = 1, /* no fault yet */
    RECORDER_ENDING = 2,    /* after the fault, until both rings are complete */
    RECORDER_COMPLETE = 3,  /* without a CRC yet */
    RECORDER_SEALED = 4
} recorder_phase_t;

/* Little endian, without padding: what the shell prints and `hubsim blackbox` reads. */
typedef struct {
    uint32_t magic;
    uint16_t format;
    uint16_t size_bytes;
    uint8_t phase;            /* recorder_phase_t */
    uint8_t restart_expected; /* 1: the next start is not counted */
    uint16_t supply; /* the owner's number of this supply; 0: the counters began with this start */
    uint32_t counts_check; /* inverted sum of the counters */
    /* Since the supply came, saturating: of recorder_counted(index), from RECORDER_FIRST_START on
     * of starts by cause. */
    uint16_t counts[RECORDER_COUNTED];
    uint32_t crc32; /* of all bytes behind it; valid in RECORDER_SEALED */
    uint32_t pwm_frequency_Hz;
    uint32_t config_crc32; /* of the configuration in use */
    uint32_t fault_ms;     /* since the start of the program */
    uint16_t fast_next;    /* index of the oldest entry, which is the next to be written */
    uint16_t slow_next;
    uint8_t reason;      /* reason_t of the fault */
    uint8_t after_reset; /* 1: a reset ended the recording, the entries end with it */
    uint8_t started_by;  /* cause of the start of the recorded program; 0: unknown */
    uint8_t ended_by;    /* cause of the start that ended the recording; 0: none, or unknown */
    recorder_fast_t fast[RECORDER_FAST_ENTRIES];
    recorder_slow_t slow[RECORDER_SLOW_ENTRIES];
} recorder_memory_t;

_Static_assert(sizeof(recorder_memory_t) <= 8192, "more than 8 KiB");
_Static_assert(sizeof(recorder_fast_t) == 12 && sizeof(recorder_slow_t) == 16 &&
                   offsetof(recorder_memory_t, fast) == 168,
               "hubsim reads this layout");

typedef struct {
    recorder_memory_t *memory; /* NULL: this board has none */
    bool takes_samples;        /* recorder_fast() is to be called */
    uint32_t now_ms;
    uint32_t slow_left_ms;
    reason_t fault_before;
    uint32_t warned[2]; /* a bit for each counter: counted already, until it is calm */
    uint32_t calm_ms;   /* without a warning */
} recorder_t;

typedef struct {
    uint32_t pwm_frequency_Hz;
    uint32_t config_crc32;
    bool was_watchdog;   /* one caused the reset */
    uint8_t reset_cause; /* below RECORDER_STARTS */
} recorder_start_t;

/* memory: NULL if there is none; its content is whatever the reset left. A record is kept, counters
 * as well if their check agrees, and everything else is zeroed. */
void recorder_init(recorder_t *recorder, recorder_memory_t *memory, const recorder_start_t *start);

/* The code that the counter `index` is of, below RECORDER_FIRST_START. */
reason_t recorder_counted(uint32_t index);

/* Background: a restart follows on purpose, which is no fault and is not counted. A record is kept.
 */
void recorder_expect_restart(recorder_t *recorder);

/* PWM period, after the compare values are known, while recorder_t.takes_samples was true in the
 * latest slow step. memory: not NULL. */
static inline void recorder_fast(recorder_memory_t *memory, const recorder_fast_t *sample,
                                 bridge_mode_t bridge)
{
    const uint32_t next = memory->fast_next;
    recorder_fast_t *entry = &memory->fast[next];
    *entry = *sample;
    entry->bus_code = (uint16_t)(sample->bus_code | ((uint32_t)bridge << RECORDER_BRIDGE_SHIFT));
    memory->fast_next = (uint16_t)(next + 1U < RECORDER_FAST_ENTRIES ? next + 1U : 0U);
}

/* 1 kHz, after the slow step. */
void recorder_slow(recorder_t *recorder, const slow_output_t *output,
                   const wheel_temperatures_t *temperature);

/* Background. True in the call that seals the record: 8 KiB of CRC. */
bool recorder_seal(recorder_t *recorder);

#endif

/* SPDX-License-Identifier: Apache-2.0 */
/*
 * scope.h: an oscilloscope in the wheel: up to eight signals once every few PWM periods, around a
 * trigger. Pure; its memory is the caller's.
 *
 * A tool writes the settings of scope_page_t word by word and then 1 to `run`. Rows are taken into
 * a ring; the trigger counts from the row on before which there are `before_rows`. When
 * `record_rows` are there the scope is COMPLETE, and its memory can be read: the oldest row is
 * number `first_row`, the trigger's is `before_rows` rows later. In a row the signals of the
 * settings follow each other without gaps, each in as many bytes as it has, little endian.
 *
 * The same memory and the same step serve the DAQ list of the PWM period (comms/daq.h): a stream
 * has two bytes of time before each row and no trigger.
 *
 *     scope_write(), scope_start_stream(), scope_stop(), scope_next_row()   background
 *     scope_slow_step()   every millisecond, after the slow step, while scope_runs()
 *     scope_fast_step()   every PWM period, after the fast step, while scope_runs()
 *
 * Each may interrupt those before it. What starts takes effect when the background's function has
 * returned, so whoever calls the steps begins to do so then. A signal of the slow step changes in
 * the row after that step. Eight signals of two bytes take about 250 instructions a row.
 */
#ifndef COMMS_SCOPE_H
#define COMMS_SCOPE_H

#include <stdbool.h>
#include <stdint.h>

#include "comms/xcp_error.h"
#include "comms/xcp_signals.h"
#include "core/findings.h"

enum {
    SCOPE_CHANNELS = 8,
    SCOPE_TIME_BYTES = 2, /* of a stream, before each row */
    SCOPE_ROW_BYTES = SCOPE_CHANNELS * XCP_SIGNAL_BYTES,
    SCOPE_PERIODS_MOST = 10000
};

typedef enum {
    SCOPE_NO_TRIGGER = 0, /* at once */
    SCOPE_ABOVE = 1,      /* trigger_signal >= level */
    SCOPE_BELOW = 2,      /* trigger_signal <= level */
    SCOPE_RISES = 3,      /* ABOVE, and not so in the row before */
    SCOPE_FALLS = 4,      /* BELOW, and not so in the row before */
    SCOPE_FINDING = 5,    /* a finding with the reason `level` appears; 0: any finding */
    SCOPE_TRIGGERS
} scope_trigger_t;

typedef enum {
    SCOPE_OFF = 0,
    SCOPE_ARMED = 1,
    SCOPE_TRIGGERED = 2,
    SCOPE_COMPLETE = 3,
    SCOPE_STREAMS = 4 /* the DAQ list of the PWM period has memory and step */
} scope_phase_t;

/* As a tool sees it. Raw values. */
typedef struct {
    int32_t signal[SCOPE_CHANNELS]; /* places in the table of signals; -1: none */
    int32_t trigger;                /* scope_trigger_t */
    int32_t trigger_signal;         /* place in the table */
    int32_t level;
    int32_t before_rows; /* before the trigger's */
    int32_t rows;        /* of the record; 0: as many as fit */
    int32_t periods;     /* PWM periods a row, 1 .. SCOPE_PERIODS_MOST */
    int32_t run;         /* 1: begins; 0: ends, and what is there is lost */
    /* From here on read only. */
    int32_t phase; /* scope_phase_t */
    int32_t record_rows;
    int32_t row_bytes;
    int32_t row_layout;   /* bytes of signal k in bits 4k to 4k + 3 */
    int32_t first_row;    /* the oldest, when COMPLETE */
    int32_t memory_bytes; /* 0: this port has no scope */
} scope_page_t;

/* One signal of a row. */
typedef struct {
    const void *at;
    uint8_t at_bytes;
    uint8_t row_bytes;
} scope_channel_t;

/* What is wanted of a stream: a signal and how many of its bytes. */
typedef struct {
    uint8_t place;
    uint8_t bytes; /* 0: none */
} scope_entry_t;

typedef struct {
    scope_page_t page;
    uint8_t *memory;
    scope_channel_t channel[SCOPE_CHANNELS];
    uint32_t channels;
    scope_channel_t trigger;
    int32_t place[SCOPE_CHANNELS + 1];         /* of the channels and of the trigger */
    uint32_t of_slow_step[SCOPE_CHANNELS + 1]; /* those values */
    uint32_t periods, periods_left;            /* of a row */
    uint32_t time_q16, period_q16;             /* in units of DAQ_TICK_us */
    uint32_t rows, next_row, taken; /* of the ring; taken: saturates at before_rows + 1 */
    uint32_t before_rows, left_rows;
    int32_t value_before; /* of the trigger, in the row before */
    uint8_t phase;        /* scope_phase_t */
    bool finding_came;    /* millisecond */
    bool finding_present;
    uint32_t written_rows; /* of a stream, PWM period */
    uint32_t read_rows;    /* background */
    bool lost;             /* a row of a stream had no place */
} scope_t;

/* memory: bytes of it, NULL and 0: none. pwm_frequency_Hz > 0. Divides. */
void scope_init(scope_t *scope, void *memory, uint32_t bytes, uint32_t pwm_frequency_Hz);

/* True while the two steps are to be called. */
static inline bool scope_runs(const scope_t *scope)
{
    const uint32_t phase = scope->phase;
    return phase == SCOPE_ARMED || phase == SCOPE_TRIGGERED || phase == SCOPE_STREAMS;
}

/* The page as it is now. */
const scope_page_t *scope_page(scope_t *scope);

/* Writes one word of the page. Changes nothing if it returns an error: a read-only word, a value
 * out of range, a scope that runs (run = 0 ends it), a stream. */
xcp_error_t scope_write(scope_t *scope, const xcp_table_t *table, uint32_t word, int32_t value);

/* The bytes of a complete record; 0: there is none. */
uint32_t scope_record_bytes(const scope_t *scope);

/* Begins a stream of a row every `periods` PWM periods, whose time begins with time_ticks:
 * NOT_ACCESSIBLE_NOW without memory or while the scope runs. What was recorded is lost. */
xcp_error_t scope_start_stream(scope_t *scope, const xcp_table_t *table,
                               const scope_entry_t entry[SCOPE_CHANNELS], uint32_t periods,
                               uint32_t time_ticks);

/* The next row of the stream with its time, at most SCOPE_TIME_BYTES + SCOPE_ROW_BYTES; returns its
 * bytes, 0: there is none yet. */
uint32_t scope_next_row(const scope_t *scope, uint8_t *to);

/* After scope_next_row(): the next call gives the one behind it. */
void scope_row_taken(scope_t *scope);

/* A record that is complete stays. */
void scope_stop(scope_t *scope);

void scope_slow_step(scope_t *scope, const xcp_table_t *table, const findings_t *findings);
void scope_fast_step(scope_t *scope);

#endif

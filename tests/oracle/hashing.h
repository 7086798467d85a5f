/* SPDX-License-Identifier: Apache-2.0 */
/*
 * hashing.h: hashes of what both steps of all controllers of a run give, value by value
 * (accessors.h).
 *
 *     oracle_begin()    a run begins
 *
 *     the steps, through steps.c, which calls oracle_fast() and oracle_slow()
 *
 *     oracle_end()      the hashes of the run
 *
 * Controllers are told apart by the order in which they come first, so that no address is hashed.
 * One run at a time; plain declarations, so that Python reads this file (less the lines that begin
 * with '#') as the library's interface.
 */
#ifndef ORACLE_HASHING_H
#define ORACLE_HASHING_H

#include <stdint.h>

/* fast: every output of a fast step, and every report that a slow step got. slow: setpoint, output
 * and torque limits of every slow step. events: step, number of the value in ORACLE_EVENTS and new
 * value at every change. bytes: of oracle_bytes(). */
typedef struct {
    uint64_t fast, slow, events, bytes;
    int64_t fast_steps, slow_steps;
} oracle_hashes_t;

/* with_reports: the report after every fast step is hashed as well. */
void oracle_begin(int with_reports);

/* Bytes that leave the controller, as a program sees them: frames and the like. */
void oracle_bytes(const void *data, uint32_t size_bytes);

/* The hashes since oracle_begin(). */
oracle_hashes_t oracle_end(void);

/* What the runs since the start of the process have reached: lists in the order of ORACLE_COUNTED
 * and, behind them, of ORACLE_COUNTED_BY_NUMBER, where `number` is that of the mode or reason; 0
 * for the others. */
enum { ORACLE_NUMBERS = 128 };
int oracle_reached_lists(void);
const char *oracle_reached_name(int list);
int64_t oracle_reached(int list, int number);

/* Number of accessors and the name of one, "slow_output.mode", in the order of accessors.h; NULL
 * behind the last. */
int oracle_value_count(void);
const char *oracle_value_name(int place);

/* From now on every value that differs from the one before goes into this file as a line "step
 * controller name value"; NULL: no longer. 0: the file cannot be written. */
int oracle_list_values(const char *path);

/* Adds one to the value `place` in the step of that number, from 0, of the next run: to show that
 * its hash changes. */
void oracle_change(int place, int64_t step);

#endif

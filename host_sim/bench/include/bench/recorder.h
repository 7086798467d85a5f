/* SPDX-License-Identifier: Apache-2.0 */
/*
 * recorder.h: chosen signals at regular times into rows that the caller owns.
 *
 * A row is one double for each chosen signal, in the order chosen. The first row is the start of
 * the run, where rates are zero because no time has passed.
 */
#ifndef BENCH_RECORDER_H
#define BENCH_RECORDER_H

#include <stdbool.h>
#include <stdint.h>

#include "bench/bench.h"
#include "bench/signals.h"

enum { RECORDER_SIGNALS_MAX = SIGNALS_MAX };

typedef struct {
    int signals;
    int chosen[RECORDER_SIGNALS_MAX];
    bool reads_group[SIGNALS_GROUPS_MAX]; /* that a chosen signal belongs to */
    int rates;
    int rate[RECORDER_SIGNALS_MAX];       /* columns of the rates among them */
    double account[RECORDER_SIGNALS_MAX]; /* of each rate, when the last row was written */
    double account_s;
    double begin_s;
    int64_t rows;
} recorder_t;

/* False, and nothing chosen, when there are too many or an index is out of range. */
bool recorder_choose(recorder_t *recorder, const bench_t *bench, const int *indices, int count);

/* Rows are counted from now on. */
void recorder_begin(recorder_t *recorder, const bench_t *bench);

bool recorder_is_due(const recorder_t *recorder, const bench_t *bench);

/* Writes recorder->signals doubles. */
void recorder_write(recorder_t *recorder, const bench_t *bench, double *row);

#endif

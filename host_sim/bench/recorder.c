/* SPDX-License-Identifier: Apache-2.0 */
#include "bench/recorder.h"

#include "bench/signals.h"

static const double ROUNDING = 1e-6; /* of an interval */

bool recorder_choose(recorder_t *recorder, const bench_t *bench, const int *indices, int count)
{
    const int known = signals_count(bench);
    if (count < 0 || count > RECORDER_SIGNALS_MAX) {
        return false;
    }
    for (int k = 0; k < count; k++) {
        if (indices[k] < 0 || indices[k] >= known) {
            return false;
        }
    }
    for (int g = 0; g < (int)SIGNALS_GROUPS_MAX; g++) {
        recorder->reads_group[g] = false;
    }
    recorder->rates = 0;
    for (int k = 0; k < count; k++) {
        recorder->chosen[k] = indices[k];
        recorder->reads_group[signals_group(indices[k])] = true;
        if (signals_is_rate(bench, indices[k])) {
            recorder->rate[recorder->rates++] = k;
        }
    }
    recorder->signals = count;
    return true;
}

/* The chosen signals now; of rates the accounts. */
static void read(const recorder_t *recorder, const bench_t *bench, double *row)
{
    double values[SIGNALS_MAX];
    for (int g = 0; g < (int)SIGNALS_GROUPS_MAX; g++) {
        if (recorder->reads_group[g]) {
            signals_read_group(bench, g, values);
        }
    }
    for (int k = 0; k < recorder->signals; k++) {
        row[k] = values[recorder->chosen[k]];
    }
}

void recorder_begin(recorder_t *recorder, const bench_t *bench)
{
    double row[RECORDER_SIGNALS_MAX];
    read(recorder, bench, row);
    for (int r = 0; r < recorder->rates; r++) {
        recorder->account[r] = row[recorder->rate[r]];
    }
    recorder->account_s = bench->time_s;
    recorder->begin_s = bench->time_s;
    recorder->rows = 0;
}

bool recorder_is_due(const recorder_t *recorder, const bench_t *bench)
{
    if (recorder->signals == 0) {
        return false;
    }
    const double intervals =
        (bench->time_s - recorder->begin_s) / bench->params.run.record_interval_s;
    return intervals + ROUNDING >= (double)recorder->rows;
}

void recorder_write(recorder_t *recorder, const bench_t *bench, double *row)
{
    const double passed_s = bench->time_s - recorder->account_s;
    read(recorder, bench, row);
    for (int r = 0; r < recorder->rates; r++) {
        double *const at = &row[recorder->rate[r]];
        const double now = *at;
        *at = passed_s > 0.0 ? (now - recorder->account[r]) / passed_s : 0.0;
        recorder->account[r] = now;
    }
    recorder->account_s = bench->time_s;
    recorder->rows++;
}

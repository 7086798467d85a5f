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
    for (int k = 0; k < count; k++) {
        recorder->chosen[k] = indices[k];
    }
    recorder->signals = count;
    return true;
}

void recorder_begin(recorder_t *recorder, const bench_t *bench)
{
    const signals_accounts_t accounts = signals_accounts(bench);
    for (int k = 0; k < recorder->signals; k++) {
        recorder->account[k] = signals_read(bench, &accounts, recorder->chosen[k]);
    }
    recorder->account_s = bench->time_s;
    recorder->begin_s = bench->time_s;
    recorder->rows = 0;
}

bool recorder_is_due(const recorder_t *recorder, const bench_t *bench)
{
    const double intervals =
        (bench->time_s - recorder->begin_s) / bench->params.run.record_interval_s;
    return recorder->signals > 0 && intervals + ROUNDING >= (double)recorder->rows;
}

void recorder_write(recorder_t *recorder, const bench_t *bench, double *row)
{
    const signals_accounts_t accounts = signals_accounts(bench);
    const double passed_s = bench->time_s - recorder->account_s;
    for (int k = 0; k < recorder->signals; k++) {
        const double now = signals_read(bench, &accounts, recorder->chosen[k]);
        if (signals_is_rate(bench, recorder->chosen[k])) {
            row[k] = passed_s > 0.0 ? (now - recorder->account[k]) / passed_s : 0.0;
            recorder->account[k] = now;
        } else {
            row[k] = now;
        }
    }
    recorder->account_s = bench->time_s;
    recorder->rows++;
}

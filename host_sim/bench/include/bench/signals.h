/* SPDX-License-Identifier: Apache-2.0 */
/*
 * signals.h: everything that can be watched, by name "part.signal_unit"; a wheel's are "wheel0."
 * and so on.
 *
 * A signal is a value of this instant, or a rate: the mean of a power, force or torque since it was
 * last recorded, taken from the run's accounts, so that adding up a recorded power gives the
 * account's energy exactly.
 */
#ifndef BENCH_SIGNALS_H
#define BENCH_SIGNALS_H

#include <stdbool.h>
#include <stddef.h>

#include "bench/bench.h"

int signals_count(const bench_t *bench);

/* 0 <= index < signals_count(bench). Writes at most `size` characters, terminated. */
void signals_name(const bench_t *bench, int index, char *name, size_t size);

/* The unit as the FMI standard spells units ("N.m", "m/s2", "degC"), "1" for a share, "" for a code
 * or a flag; what it is. */
const char *signals_unit(const bench_t *bench, int index);
const char *signals_text(const bench_t *bench, int index);

bool signals_is_rate(const bench_t *bench, int index);

/* The accounts that signals are read from; made once for all signals of an instant. */
typedef struct {
    ledger_t run;     /* "energy." */
    ledger_t braking; /* "braking.": of the times in which the driver brakes */
} signals_accounts_t;

signals_accounts_t signals_accounts(const bench_t *bench);

/* The value now; for a rate, the account it is the rate of. */
double signals_read(const bench_t *bench, const signals_accounts_t *accounts, int index);

#endif

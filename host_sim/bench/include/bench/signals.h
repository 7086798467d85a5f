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

/* Index of a name, -1: there is none. */
int signals_find(const bench_t *bench, const char *name);

/* Signals are read by groups: vehicle, accounts ("energy." and "braking."), each wheel, and the
 * table of torque limits of each wheel ("wheel0.limit_"). */
enum {
    SIGNALS_OF_VEHICLE,
    SIGNALS_OF_ACCOUNTS,
    SIGNALS_OF_FIRST_WHEEL,
    SIGNALS_OF_FIRST_LIMITS = SIGNALS_OF_FIRST_WHEEL + BENCH_WHEELS_MAX,
    SIGNALS_GROUPS_MAX = SIGNALS_OF_FIRST_LIMITS + BENCH_WHEELS_MAX
};
enum { SIGNALS_MAX = 2048 };

int signals_group(int index);

/* The values of a group now, each at its index, and nothing else; of a rate, the account it is the
 * rate of. */
void signals_read_group(const bench_t *bench, int group, double values[SIGNALS_MAX]);

/* One of them. */
double signals_read(const bench_t *bench, int index);

#endif

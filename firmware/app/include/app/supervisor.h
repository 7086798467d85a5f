/* SPDX-License-Identifier: Apache-2.0 */
/*
 * supervisor.h: may the watchdog be fed?
 *
 * Only if everything that keeps the vehicle safe has been at work since the last time: the slow
 * reach has stepped, the fast loop has stepped as often as the PWM frequency says (a quarter
 * either way; the two run from different timers), and the monitor has given a new verdict. That the
 * question is asked at all shows that the background runs. A verdict that is fresh and bad still
 * feeds: the bridge is then in its safe state, and a restart would forget why.
 */
#ifndef APP_SUPERVISOR_H
#define APP_SUPERVISOR_H

#include <stdbool.h>
#include <stdint.h>

enum {
    SUPERVISOR_WINDOW_STEPS = 5, /* slow steps between two feedings, 5 ms */
    SUPERVISOR_TIMEOUT_ms =
        25 /* of the watchdog: three windows even if its oscillator is 47 % too fast */
};

/* Counters as they stand now; they wrap. */
typedef struct {
    uint16_t fast_steps;
    uint16_t slow_steps;
    uint16_t monitor_steps;
} supervisor_counts_t;

typedef struct {
    supervisor_counts_t last;
    uint32_t fast_least; /* fast steps in a window, in proportion to its slow steps */
    uint32_t fast_most;
} supervisor_t;

void supervisor_init(supervisor_t *supervisor, uint32_t fast_rate_Hz, uint32_t slow_rate_Hz);

/* Background, as often as it likes. True: feed now. Stays false for good once something has stopped
 * or run away. */
bool supervisor_may_feed(supervisor_t *supervisor, supervisor_counts_t now);

#endif

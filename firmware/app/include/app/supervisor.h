/* SPDX-License-Identifier: Apache-2.0 */
/*
 * supervisor.h: decides whether the watchdog is fed. Background context.
 *
 * It is fed if since the last time the slow loop has stepped, the fast loop has stepped at the PWM
 * frequency within a quarter (the two run from different timers), and the monitor has stepped. A
 * latched fault does not stop the feeding: the bridge is then in its safe state, and a restart
 * would lose the reason.
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

/* Present counts; they wrap. */
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

/* Background context, any rate. True: feed now. Stays false once a count has stopped or is too
 * fast. */
bool supervisor_may_feed(supervisor_t *supervisor, supervisor_counts_t now);

#endif

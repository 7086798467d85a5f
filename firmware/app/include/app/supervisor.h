/* SPDX-License-Identifier: Apache-2.0 */
/*
 * supervisor.h: decides whether the watchdog is fed. Background context.
 *
 * It is fed if, since the last feeding, the slow loop and the monitor have stepped and the rate of
 * fast steps was within +-25 % of the PWM frequency (the two loops run from different timers). A
 * latched fault does not stop the feeding: the bridge is then in its safe state, and a restart
 * would lose the reason.
 */
#ifndef APP_SUPERVISOR_H
#define APP_SUPERVISOR_H

#include <stdbool.h>
#include <stdint.h>

enum {
    SUPERVISOR_WINDOW_STEPS = 5, /* slow steps between two feedings, 5 ms */
    /* Of the watchdog: more than three windows even if its oscillator is 47 % fast. */
    SUPERVISOR_TIMEOUT_ms = 25
};

/* Number of steps made so far; the counts wrap. */
typedef struct {
    uint16_t fast_steps;
    uint16_t slow_steps;
    uint16_t monitor_steps;
} supervisor_counts_t;

typedef struct {
    supervisor_counts_t last; /* at the latest feeding */
    uint32_t fast_least;      /* smallest and largest permitted fast steps per window */
    uint32_t fast_most;
} supervisor_t;

void supervisor_init(supervisor_t *supervisor, uint32_t fast_rate_Hz, uint32_t slow_rate_Hz);

/* Background context, any rate. True: feed now. Stays false once a count has stopped or is too
 * fast. */
bool supervisor_may_feed(supervisor_t *supervisor, supervisor_counts_t now);

#endif

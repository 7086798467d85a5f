/* SPDX-License-Identifier: Apache-2.0 */
/*
 * monitor_window.h: what this controller has measured since a message of the battery was sent, and
 * whether the message contradicts it. Slow loop, 1 kHz.
 *
 * A message is as old as its cycle, so it is compared with the lowest and the highest value of the
 * last MONITOR_WINDOW_STEPS to twice as many milliseconds. DERIVATIONS.md, Flux and bus voltage.
 */
#ifndef MONITOR_MONITOR_WINDOW_H
#define MONITOR_MONITOR_WINDOW_H

#include <stdbool.h>
#include <stdint.h>

enum {
    MONITOR_WINDOW_STEPS = 128,         /* more than the message's cycle */
    MONITOR_WINDOW_QUALIFY_STEPS = 200, /* qualify and heal time: two messages */
    MONITOR_WINDOW_MOST = 10000000      /* magnitude of a value */
};

typedef struct {
    int32_t lowest[2], highest[2]; /* of the window that runs and of the one before */
    uint16_t steps;                /* of the window that runs */
    uint16_t windows;              /* complete ones, up to 1 */
    uint16_t level;                /* contradicting less agreeing steps */
    bool wrong;
} monitor_window_t;

/* Forgets everything. */
void monitor_window_restart(monitor_window_t *window);

/* Adds the value of this millisecond, of a magnitude up to MONITOR_WINDOW_MOST. True once a whole
 * window lies before it. */
bool monitor_window_add(monitor_window_t *window, int32_t value);

/* Of both windows; not before monitor_window_add(). */
int32_t monitor_window_lowest(const monitor_window_t *window);

/* Likewise. */
int32_t monitor_window_highest(const monitor_window_t *window);

/* Qualifies: true from MONITOR_WINDOW_QUALIFY_STEPS more contradicting than agreeing steps until
 * there are none more. */
bool monitor_window_judge(monitor_window_t *window, bool contradicts);

#endif

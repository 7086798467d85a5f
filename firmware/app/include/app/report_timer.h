/* SPDX-License-Identifier: Apache-2.0 */
/*
 * report_timer.h: in which PWM periods the fast loop's report is copied for the slow step. PWM
 * interrupt, once per period.
 *
 * The slow step's timer is not the PWM's, so that each watches the other: between two slow steps
 * there are n - 1 to n + 1 periods, n the whole part of their number in a millisecond. The report
 * is due from the period n - 1 after the slow step on, until it is taken: two copies or three in a
 * millisecond, and the slow step's report is always of the latest period.
 */
#ifndef APP_REPORT_TIMER_H
#define APP_REPORT_TIMER_H

#include <stdbool.h>
#include <stdint.h>

typedef struct {
    uint32_t due_periods;
    uint32_t periods; /* since the slow step took a report */
    unsigned buffer;  /* of the double buffer, in the latest period */
} report_timer_t;

/* At least two fast steps in a slow one. Divides. */
static inline void report_timer_init(report_timer_t *timer, uint32_t fast_rate_Hz,
                                     uint32_t slow_rate_Hz)
{
    timer->due_periods = fast_rate_Hz / slow_rate_Hz - 1U;
    timer->periods = 0;
    timer->buffer = 0;
}

/* buffer: double_buffer_high(), which changes when the slow step takes a report. */
static inline bool report_timer_is_due(report_timer_t *timer, unsigned buffer)
{
    if (buffer != timer->buffer) {
        timer->buffer = buffer;
        timer->periods = 0;
    }
    timer->periods++;
    return timer->periods >= timer->due_periods;
}

#endif

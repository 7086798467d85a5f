/* SPDX-License-Identifier: Apache-2.0 */
/*
 * report_timer.h: in which PWM periods the fast loop's report is copied for the slow step. PWM
 * interrupt, once per period.
 *
 * The slow step has a timer of its own, independent of the PWM timer, so that each can be checked
 * against the other. Between two slow steps there are therefore n - 1 to n + 1 PWM periods, where n
 * is the number of whole periods in a millisecond. The report is due in period n - 1 after a slow
 * step and in every later one until the slow step takes it: two or three copies per millisecond,
 * and the report that the slow step takes is always that of the latest period. A single copy, in
 * period n, would be missing each time the slow step comes a period early, and be a period old each
 * time it comes late.
 */
#ifndef APP_REPORT_TIMER_H
#define APP_REPORT_TIMER_H

#include <stdbool.h>
#include <stdint.h>

typedef struct {
    uint32_t due_periods; /* n - 1 */
    uint32_t periods;     /* since the slow step took a report */
    unsigned buffer;      /* of the double buffer, in the latest period */
} report_timer_t;

/* Background context, once; divides. fast_rate_Hz >= 2 slow_rate_Hz. */
static inline void report_timer_init(report_timer_t *timer, uint32_t fast_rate_Hz,
                                     uint32_t slow_rate_Hz)
{
    timer->due_periods = fast_rate_Hz / slow_rate_Hz - 1U;
    timer->periods = 0;
    timer->buffer = 0;
}

/* Once per PWM period; true if the report is to be copied in this period. buffer:
 * double_buffer_high(), which changes when the slow step takes a report. */
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

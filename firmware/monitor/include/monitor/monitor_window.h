/* SPDX-License-Identifier: Apache-2.0 */
/*
 * monitor_window.h: what this controller has measured since a message of the battery was sent, and
 * whether the message contradicts it. Slow loop, 1 kHz.
 *
 * A message is as old as its cycle, so it is compared with the lowest and the highest value of the
 * last MONITOR_WINDOW_STEPS to twice as many milliseconds. README, Flux and bus voltage.
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

/* Forgets everything.
 *
 * @post every(i, 2, window->lowest[i] == 0 && window->highest[i] == 0)
 *
 * @post window->steps == 0 && window->windows == 0 && window->level == 0 && !window->wrong
 */
void monitor_window_restart(monitor_window_t *window);

/* Adds the value of this millisecond. True once a whole window lies before it.
 *
 * @pre is_within(value, -MONITOR_WINDOW_MOST, MONITOR_WINDOW_MOST)
 *
 * @pre every(i, 2, is_within(window->lowest[i], -MONITOR_WINDOW_MOST, MONITOR_WINDOW_MOST) &&
 * is_within(window->highest[i], -MONITOR_WINDOW_MOST, MONITOR_WINDOW_MOST))
 *
 * @pre window->steps <= MONITOR_WINDOW_STEPS && window->level <= MONITOR_WINDOW_QUALIFY_STEPS
 *
 * @post every(i, 2, is_within(window->lowest[i], -MONITOR_WINDOW_MOST, MONITOR_WINDOW_MOST) &&
 * is_within(window->highest[i], -MONITOR_WINDOW_MOST, MONITOR_WINDOW_MOST))
 *
 * @post window->steps <= MONITOR_WINDOW_STEPS && window->level <= MONITOR_WINDOW_QUALIFY_STEPS
 *
 * @post window->level == old(window->level) && window->wrong == old(window->wrong)
 *
 * @post window->steps >= 1 && result == (window->windows > 0)
 */
bool monitor_window_add(monitor_window_t *window, int32_t value);

/* Of both windows; not before monitor_window_add().
 *
 * @post result <= window->lowest[0] && result <= window->lowest[1]
 *
 * @post result == window->lowest[0] || result == window->lowest[1]
 */
int32_t monitor_window_lowest(const monitor_window_t *window);

/* Likewise.
 *
 * @post result >= window->highest[0] && result >= window->highest[1]
 *
 * @post result == window->highest[0] || result == window->highest[1]
 */
int32_t monitor_window_highest(const monitor_window_t *window);

/* Qualifies: true from MONITOR_WINDOW_QUALIFY_STEPS more contradicting than agreeing steps until
 * there are none more.
 *
 * @pre every(i, 2, is_within(window->lowest[i], -MONITOR_WINDOW_MOST, MONITOR_WINDOW_MOST) &&
 * is_within(window->highest[i], -MONITOR_WINDOW_MOST, MONITOR_WINDOW_MOST))
 *
 * @pre window->steps <= MONITOR_WINDOW_STEPS && window->level <= MONITOR_WINDOW_QUALIFY_STEPS
 *
 * @post every(i, 2, is_within(window->lowest[i], -MONITOR_WINDOW_MOST, MONITOR_WINDOW_MOST) &&
 * is_within(window->highest[i], -MONITOR_WINDOW_MOST, MONITOR_WINDOW_MOST))
 *
 * @post window->steps <= MONITOR_WINDOW_STEPS && window->level <= MONITOR_WINDOW_QUALIFY_STEPS
 *
 * @post !result || window->wrong
 *
 * @post !result || old(window->wrong) || window->level == MONITOR_WINDOW_QUALIFY_STEPS
 *
 * @post window->level <= old(window->level) + 1
 */
bool monitor_window_judge(monitor_window_t *window, bool contradicts);

#endif

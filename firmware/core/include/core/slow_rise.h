/* SPDX-License-Identifier: Apache-2.0 */
/*
 * slow_rise.h: a limit that falls at once and rises slowly. Slow loop, 1 kHz.
 *
 * Where a limit comes and goes, each fall costs braking distance: the motor lets go at once, and
 * the hydraulic brake follows with its delay. So the whole range comes back in 2 s, and at each
 * return within ten seconds of the last change in twice the time, 8 s in the end. What flickers at
 * 1 Hz or more, half of the time, falls in ten seconds by less than once more the whole.
 */
#ifndef CORE_SLOW_RISE_H
#define CORE_SLOW_RISE_H

#include <stdbool.h>
#include <stdint.h>

#include "core/q15.h"

enum {
    SLOW_RISE_FIRST_LOG2 = 11, /* 2.0 s, as a power of two milliseconds */
    SLOW_RISE_LAST_LOG2 = 13,  /* 8.2 s */
    SLOW_RISE_QUIET_STEPS = 10000
};

typedef struct {
    int32_t value;        /* the limit that counts */
    uint16_t quiet_steps; /* left until its returns are forgotten */
    uint16_t rest;        /* of the last division */
    uint8_t time_log2;    /* of the rise of the whole range, milliseconds */
    bool returned;        /* it has risen since it fell last */
} slow_rise_t;

/* A limit that has not fallen yet. */
static inline slow_rise_t slow_rise_init(void)
{
    const slow_rise_t out = {.value = INT32_MAX, .time_log2 = SLOW_RISE_FIRST_LOG2};
    return out;
}

/* limit, whole: 0 .. INT32_MAX; whole is the range of the limit. Returns the limit that counts,
 * never above `limit`. */
static inline int32_t slow_rise_step(slow_rise_t *state, int32_t limit, int32_t whole)
{
    if (limit < state->value) {
        const int32_t slower = state->time_log2 + (state->returned ? 1 : 0);
        state->time_log2 = (uint8_t)q_min(slower, SLOW_RISE_LAST_LOG2);
        state->returned = false;
        state->value = limit;
        state->quiet_steps = SLOW_RISE_QUIET_STEPS;
    } else if (limit > state->value) {
        const uint32_t dividend = (uint32_t)whole + state->rest;
        const int32_t step = (int32_t)(dividend >> state->time_log2);
        state->rest = (uint16_t)(dividend - ((uint32_t)step << state->time_log2));
        state->value = limit - state->value > step ? state->value + step : limit;
        state->returned = true;
        state->quiet_steps = SLOW_RISE_QUIET_STEPS;
    } else if (state->quiet_steps > 0U) {
        state->quiet_steps--;
    } else {
        state->time_log2 = SLOW_RISE_FIRST_LOG2;
        state->returned = false;
    }
    return state->value;
}

#endif

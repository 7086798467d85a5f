/* SPDX-License-Identifier: Apache-2.0 */
/*
 * monitor_fast.h: the fast part of the monitor (monitor.h), once per PWM period in the fast step.
 */
#ifndef MONITOR_MONITOR_FAST_H
#define MONITOR_MONITOR_FAST_H

#include "monitor/monitor.h"

/* A current vector that is too long, or that has vanished from one sample to the next: OVERCURRENT,
 * CURRENT_SENSOR or REASON_NONE. square: of its length, Q30, not between in->least_square and the
 * trip. The count is of periods above the trip, or negative, of periods at zero. DERIVATIONS.md,
 * The fast trip. */
static inline reason_t monitor_fast_current(monitor_fast_state_t *state,
                                            const monitor_fast_input_t *in, uint32_t square)
{
    if (square >= in->least_square) {
        state->current_periods = q_max(state->current_periods, 0) + 1;
        return state->current_periods >= state->trip_periods ? REASON_OVERCURRENT : REASON_NONE;
    }
    /* INT16_MIN: gone by degrees, which a broken sensor does not do. */
    const bool gradual = square > MONITOR_DEAD_SQUARE || state->current_periods == INT16_MIN;
    state->current_periods = gradual ? INT16_MIN : q_min(state->current_periods, 0) - 1;
    const int32_t times =
        in->least_square < MONITOR_DEAD_SMALL_SQUARE ? MONITOR_DEAD_SMALL_TIMES : 1;
    return state->current_periods <= -state->dead_periods * times &&
                   state->current_periods != INT16_MIN
               ? REASON_CURRENT_SENSOR
               : REASON_NONE;
}

/* Reason of the first trip condition that is true in this period, or REASON_NONE. Only while no
 * trip is latched. */
static inline reason_t monitor_fast_look(monitor_fast_state_t *state,
                                         const monitor_fast_input_t *in)
{
    const int32_t bus_rise_pu = in->v_dc_pu - state->last_v_dc_pu;
    state->last_v_dc_pu = in->v_dc_pu;
    if (in->power_stage_fault) {
        return REASON_HARDWARE_BREAK;
    }
    /* The vector's length is the peak of the three phases; below 2, so its square in Q30 fits 32
     * bits unsigned. */
    const uint32_t square = q_pair_square(in->i_pu.v);
    /* Outside least_square .. overcurrent_square, as one unsigned comparison. */
    if (square - in->least_square > state->overcurrent_square - in->least_square && in->switching) {
        const reason_t wrong = monitor_fast_current(state, in, square);
        if (wrong != REASON_NONE) {
            return wrong;
        }
    } else {
        state->current_periods = 0;
    }
    if (in->v_dc_pu > state->overvoltage_pu) {
        return bus_rise_pu > state->jump_pu ? REASON_BUS_SENSOR : REASON_BUS_OVERVOLTAGE;
    }
    int32_t periods_left = state->periods_left - 1;
    if (in->slow_step_count != state->last_slow_step || !in->switching) {
        state->last_slow_step = in->slow_step_count;
        periods_left = state->stale_limit_periods;
    }
    if (periods_left < 0) {
        return REASON_PROGRAM_FLOW;
    }
    state->periods_left = periods_left;
    return REASON_NONE;
}

/* Latches a trip and its inverted copy. reason: not REASON_NONE. */
static inline void monitor_fast_trip(monitor_fast_state_t *state, reason_t reason)
{
    state->trip = reason;
    state->inverted_trip = ~(uint32_t)reason;
}

/* PWM period, last in the fast step, on what it has sampled. Returns the trip, latched until
 * in->clear_trip and judged again in that period; REASON_NONE when healthy. */
static inline reason_t monitor_fast_step(monitor_fast_state_t *state,
                                         const monitor_fast_input_t *in)
{
    /* The counters do not advance while tripped, so they cannot overflow. */
    if (state->trip != REASON_NONE) {
        if (!in->clear_trip) {
            return state->trip;
        }
        state->trip = REASON_NONE;
        state->inverted_trip = ~(uint32_t)REASON_NONE;
        state->current_periods = 0;
    }
    const reason_t wrong = monitor_fast_look(state, in);
    if (wrong != REASON_NONE) {
        monitor_fast_trip(state, wrong);
    }
    return wrong;
}

#endif

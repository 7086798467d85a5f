/*
 * monitor_fast.h: the fast part of the watcher (monitor.h), once per PWM period from the fast step.
 */
#ifndef MONITOR_MONITOR_FAST_H
#define MONITOR_MONITOR_FAST_H

#include "monitor/monitor.h"

/* What is wrong now. */
static inline reason_t monitor_fast_look(monitor_fast_state_t *state, const monitor_fast_input_t *in)
{
    /* The vector's length is the peak of the three phases; below 2, so its square in Q30 fits 32 bits unsigned. */
    const uint32_t square = (uint32_t)in->i_pu.d * (uint32_t)in->i_pu.d + (uint32_t)in->i_pu.q * (uint32_t)in->i_pu.q;
    const bool overcurrent = square > state->overcurrent_square;
    state->overcurrent_periods = overcurrent ? state->overcurrent_periods + 1 : 0;

    const bool slow_stepped = in->slow_step_count != state->last_slow_step;
    state->last_slow_step = in->slow_step_count;
    state->stale_periods = slow_stepped || !in->switching ? 0 : state->stale_periods + 1;

    if (in->power_stage_fault) {
        return REASON_HARDWARE_BREAK;
    }
    if (state->overcurrent_periods >= MONITOR_TRIP_PERIODS) {
        return REASON_OVERCURRENT;
    }
    if (in->v_dc_pu > state->overvoltage_pu) {
        return REASON_BUS_OVERVOLTAGE;
    }
    return state->stale_periods > state->stale_limit_periods ? REASON_PROGRAM_FLOW : REASON_NONE;
}

static inline monitor_fast_report_t monitor_fast_step(monitor_fast_state_t *state, const monitor_command_t *command,
                                                      const monitor_fast_input_t *in)
{
    if (command->clear_trip) {
        state->trip = REASON_NONE;
        state->overcurrent_periods = 0;
    }
    /* Without a trip the counters advance; with one they rest, so they cannot run over. */
    if (state->trip == REASON_NONE) {
        state->trip = monitor_fast_look(state, in);
    }
    const monitor_fast_report_t out = {.trip = state->trip};
    return out;
}

#endif

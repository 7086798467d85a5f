/* SPDX-License-Identifier: Apache-2.0 */
/* The fast part of the monitor: for every input it trips on a power-stage fault and on
 * over-voltage, and a trip is latched until it is cleared. Its counters never overflow. */
#include "monitor/monitor_fast.h"
#include "vectors.h"

/* After trip_periods of over-current there is a trip, and after MONITOR_DEAD_SMALL_TIMES
 * dead_periods without a current that vanished. */
static bool invariant(const monitor_fast_state_t *state)
{
    const int32_t periods = state->current_periods;
    const int32_t gone = -MONITOR_DEAD_SMALL_TIMES * state->dead_periods;
    const bool counts = (periods >= gone && periods <= state->trip_periods) || periods == INT16_MIN;
    const bool complete = periods == gone || periods == state->trip_periods;
    return counts && (state->trip != REASON_NONE || !complete) && state->periods_left >= 0 &&
           state->periods_left <= state->stale_limit_periods;
}

static monitor_fast_state_t any_state(void)
{
    const monitor_fast_state_t out = {
        .overcurrent_square = nondet_uint32(),
        .overvoltage_pu = any_within(0, 32768),
        .jump_pu = any_within(MONITOR_BUS_LEAST_JUMP_PU, MONITOR_BUS_JUMP_PU),
        .stale_limit_periods = any_within(0, 100000 / 1000 * MONITOR_STALE_STEPS),
        .trip_periods = any_within(1, 16),
        .dead_periods = any_within(2, 16),
        .trip = (reason_t)nondet_uint8(),
        .current_periods = nondet_int32(),
        .periods_left = any_within(0, 100000 / 1000 * MONITOR_STALE_STEPS),
        .last_v_dc_pu = any_within(0, 65536),
        .last_slow_step = nondet_uint16(),
    };
    ASSUME(invariant(&out));
    return out;
}

static monitor_fast_input_t any_input(void)
{
    const monitor_fast_input_t out = {
        .i_pu = dq16_of(any_vector(32767)),
        .v_dc_pu = any_within(0, 32760),
        .power_stage_fault = nondet_bool(),
        .switching = nondet_bool(),
        .clear_trip = nondet_bool(),
        .slow_step_count = nondet_uint16(),
        .least_square = nondet_uint32(),
    };
    return out;
}

void prove_monitor_fast(void)
{
    monitor_fast_state_t state = any_state();
    const monitor_fast_state_t before = state;
    const monitor_fast_input_t in = any_input();
    ASSUME(in.least_square <= state.overcurrent_square);
    const reason_t wrong = monitor_fast_step(&state, &in);
    PROVE(wrong == state.trip);
    PROVE(before.trip == REASON_NONE || in.clear_trip || wrong == before.trip);
    PROVE(!in.power_stage_fault || wrong != REASON_NONE);
    PROVE(in.v_dc_pu <= state.overvoltage_pu || wrong != REASON_NONE);
    PROVE(invariant(&state));
    PROOF_END();
}

/* SPDX-License-Identifier: Apache-2.0 */
#include "monitor/monitor_jump.h"

#include "config/bases.h"
#include "core/q15.h"

/* nH mA^2 = 1e-15 J, by way of 2^30: 7 % less. */
static int64_t part_uJ(int32_t inductance_nH, int32_t current_mA)
{
    return ((((int64_t)inductance_nH * current_mA) >> 20) * current_mA) >> 10;
}

/* Of the bus, beyond what the voltage of two milliseconds beside the jump makes of the current that
 * dips; quarters of the dip, of two milliseconds, are its share. */
static int32_t extra_mA(int32_t of_mA, int32_t beside_mA, int32_t dip_q10)
{
    return of_mA - beside_mA + (int32_t)(((int64_t)beside_mA * dip_q10) >> 10);
}

/* Of the bus, `steps` and one more milliseconds ago. */
static int32_t pair_mA(const monitor_jump_state_t *state, uint32_t steps)
{
    return state->bus_mA[(state->newest - steps) % MONITOR_JUMP_RING] +
           state->bus_mA[(state->newest - steps - 1U) % MONITOR_JUMP_RING];
}

static int32_t moved_mA(const monitor_jump_state_t *state, uint32_t steps)
{
    return q_abs(pair_mA(state, steps) -
                 2 * state->bus_mA[(state->newest - steps) % MONITOR_JUMP_RING]);
}

static int32_t energy_uJ(const monitor_jump_state_t *state, uint32_t steps)
{
    return state->energy_uJ[(state->newest - steps) % MONITOR_JUMP_RING];
}

/* Two milliseconds after the jump, two of it, two before. */
static bool jumps(const monitor_jump_state_t *state, int32_t bus_mV)
{
    const int32_t now_uJ = energy_uJ(state, 0);
    const int32_t before_uJ = energy_uJ(state, MONITOR_JUMP_STEPS - 1);
    const int32_t dip_uJ = now_uJ + before_uJ - energy_uJ(state, 2) - energy_uJ(state, 3);
    const int32_t share_uJ = now_uJ / MONITOR_JUMP_SHARE;
    if (share_uJ == 0 || q_abs(now_uJ - before_uJ) > share_uJ ||
        (dip_uJ < share_uJ * MONITOR_JUMP_DIPS / 2 && -dip_uJ < share_uJ)) {
        return false;
    }
    const int32_t dip_q10 = q_saturate16(q_saturate64((int64_t)dip_uJ * 256 / now_uJ));
    const int32_t of_mA = pair_mA(state, 2);
    const int32_t since_mA = extra_mA(of_mA, pair_mA(state, 0), dip_q10);
    const int32_t until_mA = extra_mA(of_mA, pair_mA(state, 4), dip_q10);
    /* A shown current that dips takes energy up, one that rises gives it back. */
    const int32_t least_mA = dip_uJ > 0 ? q_min(since_mA, until_mA) : -q_max(since_mA, until_mA);
    return least_mA / MONITOR_JUMP_STEADY_SHARE >= q_max(moved_mA(state, 0), moved_mA(state, 4)) &&
           (int64_t)least_mA * bus_mV >= (int64_t)MONITOR_JUMP_ENERGY * now_uJ;
}

bool monitor_jump_step(monitor_jump_state_t *state, const config_t *config,
                       const monitor_jump_input_t *in)
{
    if (!in->watched) {
        state->filled = 0;
        state->since_steps = 0;
        return false;
    }
    const config_motor_t *motor = &config->motor;
    const int32_t d_mA = bases_current_mA(config, in->i_pu.d);
    const int32_t q_mA = bases_current_mA(config, in->i_pu.q);
    const int64_t stored_uJ =
        part_uJ(motor->d_inductance_nH, d_mA) + part_uJ(motor->q_inductance_nH, q_mA);
    state->newest = (uint8_t)((state->newest + 1U) % MONITOR_JUMP_RING);
    state->bus_mA[state->newest] = q_limit(in->bus_current_mA, MONITOR_JUMP_MOST);
    state->energy_uJ[state->newest] = q_limit(q_saturate64(stored_uJ), MONITOR_JUMP_MOST);
    state->filled = (uint8_t)q_min(state->filled + 1, MONITOR_JUMP_STEPS);
    const bool enough =
        q_abs(d_mA) + q_abs(q_mA) >= motor->max_phase_current_mA / MONITOR_JUMP_LEAST_SHARE;
    const bool found =
        state->filled == MONITOR_JUMP_STEPS && enough && jumps(state, in->bus_voltage_mV);
    if (found || state->since_steps > 0) {
        state->since_steps = (uint8_t)q_min(state->since_steps + 1, MONITOR_JUMP_NAME_STEPS);
    }
    return state->since_steps == MONITOR_JUMP_NAME_STEPS;
}

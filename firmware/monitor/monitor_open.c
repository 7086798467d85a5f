/* SPDX-License-Identifier: Apache-2.0 */
#include "monitor/monitor_open.h"

#include "core/angle.h"
#include "core/q15.h"
#include "core/scaled.h"
#include "core/sqrt3.h"

enum {
    PHASES = 3,
    SUM_SHARE = 4 /* of the current: gains that differ by a tenth make a sum of an eighth at most */
};

typedef struct {
    int32_t pu[PHASES];
} phases_t;

static phases_t phases_of(dq_t x, sincos_t at)
{
    const int32_t alpha = (int32_t)(((int64_t)x.d * at.cos - (int64_t)x.q * at.sin) >> 15);
    const int32_t beta = (int32_t)(((int64_t)x.d * at.sin + (int64_t)x.q * at.cos) >> 15);
    const int32_t beta_part = (int32_t)(((int64_t)beta * SQRT3_2_Q15) >> 15);
    const phases_t out = {.pu = {alpha, beta_part - alpha / 2, -beta_part - alpha / 2}};
    return out;
}

static int32_t largest(const phases_t *x)
{
    return q_max(q_abs(x->pu[0]), q_max(q_abs(x->pu[1]), q_abs(x->pu[2])));
}

typedef enum { FLOWS, NEITHER, MISSING } evidence_t;

/* One phase whose reference is at least half of the largest. A healthy vector of whatever length
 * within 21 degrees of its reference has a sixth of the others there. Where the reference of an
 * open phase is at its peak, hardly anything flows in the others either. */
static evidence_t evidence(int32_t current_pu, int32_t wanted_pu, int32_t others_pu)
{
    const int32_t along_pu = wanted_pu > 0 ? current_pu : -current_pu;
    const int32_t reference_pu = q_abs(wanted_pu);
    if (along_pu > reference_pu / 2) {
        return FLOWS;
    }
    const int32_t size_pu = q_abs(current_pu);
    const bool none = others_pu > MONITOR_OPEN_OTHERS_PU ? size_pu < others_pu / 6
                                                         : others_pu > MONITOR_OPEN_DEAD_PU;
    return size_pu < reference_pu / 4 && none ? MISSING : NEITHER;
}

/* The vector turns through this phase's zero within 14 degrees unless the phase carries none, or
 * the reference goes with it: where less than a quarter is wanted nothing counts. Only where two
 * samples see the same half wave. */
static bool stays_zero(monitor_open_state_t *state, int x, int32_t current_pu, int32_t wanted_pu,
                       int32_t others_pu, int32_t step_turn)
{
    const bool none = q_abs(current_pu) < others_pu / 8 && step_turn < MONITOR_OPEN_FASTEST_TURN;
    if (!none) {
        state->zeros[x] = 0;
        return false;
    }
    const bool counts = state->unsettled == 0 && q_abs(wanted_pu) >= others_pu / 4;
    const int32_t counted_turn = counts ? step_turn : 0;
    const int32_t turned = state->zeros[x] > 0 ? state->turned[x] + counted_turn : 0;
    state->turned[x] = (uint16_t)q_min(turned, MONITOR_OPEN_TURN);
    state->zeros[x] = (uint8_t)q_min(state->zeros[x] + 1, MONITOR_OPEN_STEPS);
    return turned >= MONITOR_OPEN_TURN && state->zeros[x] >= MONITOR_OPEN_STEPS;
}

/* Step of the angle since the sample before. A rotor does not change it by 20 degrees in a
 * millisecond; an edge of a hall sensor at low speed does. */
static int32_t turned_since(monitor_open_state_t *state, uint16_t theta_turn)
{
    const int32_t step_turn = angle_difference(theta_turn, state->theta_turn);
    const int32_t change_turn = angle_difference((uint16_t)step_turn, (uint16_t)state->step_turn);
    const bool known = state->steps_known >= 2;
    state->steps_known = (uint8_t)(known ? 2 : state->steps_known + 1);
    if (known && q_abs(change_turn) > MONITOR_OPEN_JUMP_TURN) {
        state->unsettled = MONITOR_OPEN_JUMP_STEPS;
    } else if (state->unsettled > 0) {
        state->unsettled--;
    }
    state->theta_turn = theta_turn;
    state->step_turn = step_turn;
    return step_turn;
}

/* An open phase leaves the other two opposite currents, which add up to zero; a sensor that shows
 * none leaves a sum of what its phase carries, up to the tolerance of that check. */
static reason_t name_of(dq_t sampled_pu, int32_t current_sum_pu)
{
    const int32_t size_pu = q_max(q_abs(sampled_pu.d), q_abs(sampled_pu.q));
    return q_abs(current_sum_pu) > q_max(size_pu, MONITOR_OPEN_OTHERS_PU) / SUM_SHARE
               ? REASON_CURRENT_SUM
               : REASON_PHASE_OPEN;
}

int32_t monitor_open_edge_pu(const config_t *config, const measured_t *now)
{
    if (config->rotor.sensor != CONFIG_ROTOR_HALL) {
        return 0;
    }
    /* Of the voltage's share, in Q24, over the gain in Q16, to Q15. */
    const int32_t share_q24 = q_min(
        scaled_ratio(q_abs(now->latest_u_q_mV), q_divisor(config->drive.voltage_full_scale_mV)),
        SCALED_ONE);
    return q_min(share_q24 * ((1 << 7) / MONITOR_OPEN_EDGE_SHARE) /
                     q_divisor(config->current_loop.proportional_d_pu_q16),
                 MONITOR_OPEN_MOST_EDGE_PU);
}

reason_t monitor_open_step(monitor_open_state_t *state, const measured_t *now, dq_t reference_pu,
                           int32_t edge_pu)
{
    const int32_t step_turn = q_abs(turned_since(state, now->report->sample.theta_turn));
    if (!measured_switching(now)) {
        for (int x = 0; x < PHASES; x++) {
            state->missing[x][0] = 0;
            state->missing[x][1] = 0;
            state->turned[x] = 0;
            state->zeros[x] = 0;
        }
        return REASON_NONE;
    }
    const sincos_t at = angle_sincos(now->report->sample.theta_turn);
    const phases_t current = phases_of(dq_of(now->report->i_pu), at);
    const phases_t wanted = phases_of(reference_pu, at);
    const int32_t longest_pu = largest(&current);
    const int32_t half_pu = (int32_t)((uint32_t)largest(&wanted) / 2U);
    const int32_t judged_pu = state->unsettled == 0
                                  ? q_max(half_pu, q_max(2 * edge_pu, MONITOR_OPEN_WANTED_PU))
                                  : INT32_MAX;
    const int32_t least_pu = q_max(3 * edge_pu, MONITOR_OPEN_LEAST_PU);
    int32_t most = 0;
    bool zero = false;
    for (int x = 0; x < PHASES; x++) {
        if (q_abs(wanted.pu[x]) >= judged_pu) {
            uint8_t *missing = &state->missing[x][wanted.pu[x] > 0 ? 1 : 0];
            const evidence_t found = evidence(current.pu[x], wanted.pu[x], longest_pu);
            const int32_t counted = *missing + (found == MISSING ? 1 : 0);
            *missing = (uint8_t)(found == FLOWS ? 0 : q_min(counted, MONITOR_OPEN_STEPS));
        }
        if (longest_pu > least_pu) {
            zero = stays_zero(state, x, current.pu[x], wanted.pu[x], longest_pu, step_turn) || zero;
        } else if (q_abs(current.pu[x]) > least_pu / 2) { /* some, between samples that count */
            state->zeros[x] = 0;
        }
        most = q_max(most, q_max(state->missing[x][0], state->missing[x][1]));
    }
    state->suspected = most >= MONITOR_OPEN_SUSPECT_STEPS;
    return zero || most >= MONITOR_OPEN_STEPS
               ? name_of(dq_of(now->report->i_pu), now->report->current_sum_pu)
               : REASON_NONE;
}

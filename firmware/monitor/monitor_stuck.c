/* SPDX-License-Identifier: Apache-2.0 */
#include "monitor/monitor_stuck.h"

#include "core/divide.h"
#include "core/q15.h"
#include "core/sqrt3.h"

enum { GOOD_SHARE = 4, TURN_mrad = 6284 };

static void begin_window(monitor_stuck_state_t *state, const measured_t *now)
{
    state->steps = 0;
    state->good_steps = 0;
    state->turned_mrad = 0;
    state->begin_alpha_pu = now->report->idle_alpha_pu;
    state->begin_beta_pu = now->report->idle_beta_pu;
    state->begin_step = now->report->sequence;
}

static void forget(monitor_stuck_state_t *state, const measured_t *now)
{
    state->windows = 0;
    begin_window(state, now);
}

/* The side whose switch makes the means of this window. With a and b the sums of alpha and beta,
 * twice the phases' sums are 2 a and -a +- sqrt(3) b; of the largest the sign
 * counts, of equal ones that of the first. */
static bridge_mode_t side_of_window(const monitor_stuck_state_t *state, const config_t *config,
                                    const measured_t *now)
{
    const int64_t alpha_q10 =
        INT64_C(1024) * (int32_t)(now->report->idle_alpha_pu - state->begin_alpha_pu);
    const int64_t beta_q10 =
        INT64_C(1) * SQRT3_Q10 * (int32_t)(now->report->idle_beta_pu - state->begin_beta_pu);
    const int64_t twice_q10[3] = {2 * alpha_q10, beta_q10 - alpha_q10, -beta_q10 - alpha_q10};
    int64_t largest_q10 = 0;
    int64_t most_q10 = 0; /* its magnitude, and the second one */
    int64_t second_q10 = 0;
    for (int x = 0; x < 3; x++) {
        const int64_t magnitude_q10 = twice_q10[x] < 0 ? -twice_q10[x] : twice_q10[x];
        if (magnitude_q10 > most_q10) {
            second_q10 = most_q10;
            most_q10 = magnitude_q10;
            largest_q10 = twice_q10[x];
        } else if (magnitude_q10 > second_q10) {
            second_q10 = magnitude_q10;
        }
    }
    if (MONITOR_STUCK_PARTS * (most_q10 - second_q10) < most_q10) {
        return BRIDGE_OFF;
    }
    const int32_t periods = (uint16_t)(now->report->sequence - state->begin_step);
    const int64_t least_q10 =
        INT64_C(2048) / MONITOR_STUCK_SHARE * config->monitor.overcurrent_pu_q15 * periods;
    return largest_q10 > least_q10    ? BRIDGE_SHORT_HIGH
           : largest_q10 < -least_q10 ? BRIDGE_SHORT
                                      : BRIDGE_OFF;
}

static void end_window(monitor_stuck_state_t *state, const config_t *config, const measured_t *now)
{
    const bridge_mode_t side = side_of_window(state, config, now);
    state->windows =
        side == state->candidate ? q_min(state->windows, MONITOR_STUCK_SHORT_WINDOWS) + 1 : 1;
    state->candidate = side;
    const int32_t wanted = now->report->bridge == BRIDGE_OFF ? 1 : MONITOR_STUCK_SHORT_WINDOWS;
    const bool sums_up = state->good_steps * GOOD_SHARE >= state->steps;
    if (side != BRIDGE_OFF && sums_up && state->windows >= wanted) {
        state->side = side;
        state->release_steps = MONITOR_STUCK_RELEASE_STEPS;
    }
    begin_window(state, now);
}

static void watch(monitor_stuck_state_t *state, const config_t *config, const measured_t *now)
{
    const int64_t w_mrad_s = (int64_t)now->speed_mrad_s * config->motor.pole_pairs;
    state->turned_mrad += (int32_t)divide_by_thousand(w_mrad_s); /* 60 pole pairs: 27 bits */
    state->steps++;
    const bool adds_up = q_abs(now->report->current_sum_pu) <= config->monitor.current_sum_pu_q15;
    state->good_steps += adds_up ? 1 : 0;
    if (state->turned_mrad >= TURN_mrad || state->turned_mrad <= -TURN_mrad) {
        end_window(state, config, now);
    } else if (state->steps >= MONITOR_STUCK_STEPS) {
        forget(state, now);
    }
}

/* The direct current with which a short circuit begins decays with 2 L_d L_q/(R (L_d + L_q)), of
 * which (L_d + L_q)/R is twice or more; nH/uOhm = ms. */
static bool own_direct_current(const monitor_stuck_state_t *state, const config_t *config)
{
    const config_motor_t *motor = &config->motor;
    return bridge_is_short(state->bridge) && state->same_steps < MONITOR_STUCK_LONGEST_STEPS &&
           (int64_t)state->same_steps * motor->phase_resistance_uOhm <
               (int64_t)motor->d_inductance_nH + motor->q_inductance_nH;
}

monitor_stuck_output_t monitor_stuck_step(monitor_stuck_state_t *state, const config_t *config,
                                          const measured_t *now, bool turning)
{
    const bool tripped = now->trip != REASON_NONE;
    const bool open = now->report->bridge == BRIDGE_OFF;
    const uint8_t wrong = now->report->wrong_current_sensor;
    const bool currents_known = now->report->offsets_done && !(wrong >= 1U && wrong <= 3U) &&
                                now->trip != REASON_CURRENT_SENSOR;
    state->release_steps = tripped ? q_max(state->release_steps - 1, 0) : 0;
    state->side = tripped || turning ? state->side : BRIDGE_OFF;
    const bool looks = (tripped ? !measured_switching(now) : turning && open) && currents_known &&
                       now->angle_valid && state->side == BRIDGE_OFF;
    /* A window has one bridge mode: a short circuit's current has a mean in freewheel as well. */
    const bool same = now->report->bridge == state->bridge;
    state->bridge = now->report->bridge;
    state->same_steps = same ? q_min(state->same_steps + 1, MONITOR_STUCK_LONGEST_STEPS) : 0;
    if (looks && same && !own_direct_current(state, config)) {
        watch(state, config, now);
    } else {
        forget(state, now);
    }
    const monitor_stuck_output_t out = {.side = state->side,
                                        .release_break = tripped && state->release_steps > 0};
    return out;
}

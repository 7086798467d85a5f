/* SPDX-License-Identifier: Apache-2.0 */
#include "plant/anti_lock.h"

#include <stddef.h>

#include "plant/numbers.h"

static const double RIM_FILTER_S = 0.015; /* the teeth of the ring make steps of the speed */
/* A wheel locked on ice (mu 0.05) turns again within this time; a longer zero is the sensor's. */
static const double ZERO_SPEED_TIME_S = 2.0;
/* Below this acceleration of the rim its pressure is reduced further. */
static const double RECOVERING_M_PER_S2 = 2.0;
static const double RUNNING_M_PER_S = 3.0; /* every ring gives pulses here */

const char *anti_lock_objection(const anti_lock_params_t *params)
{
    if (params->active < 0.5) {
        return NULL;
    }
    if (!(params->slip_hold > 0.0 && params->slip_dump >= params->slip_hold &&
          params->slip_dump < 1.0)) {
        return "anti_lock.slip_dump: accepted: from anti_lock.slip_hold, itself above 0, to less "
               "than 1";
    }
    return NULL;
}

static double fastest(const anti_lock_input_t *in)
{
    double out = 0.0;
    for (int k = 0; k < in->wheels; k++) {
        out = plant_max(out, in->rim_m_per_s[k]);
    }
    return out;
}

/* The reference without braking, when wheels can only spin too fast. */
static double slowest(const anti_lock_input_t *in)
{
    double out = fastest(in);
    for (int k = 0; k < in->wheels; k++) {
        out = plant_min(out, in->rim_m_per_s[k]);
    }
    return out;
}

static void update_reference(const anti_lock_params_t *params, anti_lock_t *state,
                             const anti_lock_input_t *in, double step_s)
{
    if (!in->brakes) {
        state->reference_m_per_s = slowest(in);
        return;
    }
    const double fallen =
        state->reference_m_per_s + (in->acceleration_m_per_s2 - params->margin_m_per_s2) * step_s;
    state->reference_m_per_s = plant_max(plant_max(fastest(in), fallen), 0.0);
}

static void sample_speeds(anti_lock_t *state, const anti_lock_input_t *in, double step_s)
{
    for (int k = 0; k < in->wheels; k++) {
        anti_lock_wheel_t *w = &state->wheel[k];
        const double rate = (in->rim_m_per_s[k] - w->rim_m_per_s) / step_s;
        w->rim_m_per_s2 += (rate - w->rim_m_per_s2) * plant_min(step_s / RIM_FILTER_S, 1.0);
        w->rim_m_per_s = in->rim_m_per_s[k];
        const bool silent = in->rim_m_per_s[k] <= 0.0 && fastest(in) > RUNNING_M_PER_S;
        w->silent_s = silent ? w->silent_s + step_s : 0.0;
        state->failed = state->failed || w->silent_s > ZERO_SPEED_TIME_S;
    }
}

static hydraulic_valve_t valve_for(const anti_lock_params_t *params, const anti_lock_t *state,
                                   const anti_lock_wheel_t *w)
{
    const double slip = 1.0 - w->rim_m_per_s / state->reference_m_per_s;
    if (slip > params->slip_dump && w->rim_m_per_s2 < RECOVERING_M_PER_S2) {
        return HYDRAULIC_VALVE_DUMP;
    }
    if (slip > params->slip_hold || w->rim_m_per_s2 < -params->rim_deceleration_m_per_s2) {
        return HYDRAULIC_VALVE_HOLD;
    }
    return state->at_work ? HYDRAULIC_VALVE_BUILD : HYDRAULIC_VALVE_OPEN;
}

static void open_all(anti_lock_t *state, int wheels)
{
    for (int k = 0; k < wheels; k++) {
        state->wheel[k].valve = HYDRAULIC_VALVE_OPEN;
    }
}

void anti_lock_step(const anti_lock_params_t *params, anti_lock_t *state,
                    const anti_lock_input_t *in, double step_s)
{
    sample_speeds(state, in, step_s);
    update_reference(params, state, in, step_s);
    const bool may_work = params->active > 0.5 && !state->failed && in->brakes &&
                          state->reference_m_per_s > params->lowest_speed_m_per_s;
    bool intervenes = false;
    if (may_work) {
        for (int k = 0; k < in->wheels; k++) {
            anti_lock_wheel_t *w = &state->wheel[k];
            w->valve = valve_for(params, state, w);
            state->at_work = state->at_work || w->valve == HYDRAULIC_VALVE_DUMP;
        }
        for (int k = 0; k < in->wheels; k++) {
            intervenes =
                intervenes || state->wheel[k].valve == HYDRAULIC_VALVE_DUMP || in->below_command[k];
        }
    } else {
        open_all(state, in->wheels);
    }
    state->quiet_s = intervenes ? 0.0 : state->quiet_s + step_s;
    if (state->failed || !in->brakes || state->quiet_s > params->release_s) {
        state->at_work = false;
    }
}

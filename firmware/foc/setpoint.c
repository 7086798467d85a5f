/* SPDX-License-Identifier: Apache-2.0 */
#include "setpoint.h"

#include "core/circle.h"
#include "current_controller.h"
#include "current_predictor.h"
#include "field_weakening.h"
#include "reference_prefilter.h"
#include "rotor.h"
#include "spare_tasks.h"

Q_TARGET_INLINE dq_t inside_circle(const circle_t *circle, int32_t d, int32_t q)
{
    const int32_t limited_d = q_limit(d, circle->radius_q15);
    const dq_t out = {.d = limited_d, .q = q_limit(q, circle_other(circle, limited_d))};
    return out;
}

static bool is_due(foc_state_t *state)
{
    state->postponed = rotor_at_hall_edge(&state->rotor) && !state->postponed;
    return !state->postponed;
}

static void apply(foc_state_t *state, const fast_setpoint_t *setpoint)
{
    foc_current_state_t *current = &state->current;
    const dq_t reference =
        inside_circle(&state->current_circle,
                      setpoint->i_reference_pu.d + field_weakening_current_pu(&state->weakening),
                      setpoint->i_reference_pu.q);
    const int32_t correction =
        q_limit(setpoint->i_d_sampling_correction_pu, SETPOINT_SAMPLING_CORRECTION_PU);
    const dq_t mean = {.d = q_saturate16(reference.d + correction), .q = reference.q};
    const reference_change_t change = reference_prefilter_take(&state->prefilter, reference);
    dq_t given = reference;
    dq_t target = reference;
    if (state->prefilter.settled) {
        state->sequence = setpoint->sequence;
        current_predictor_change(&current->predictor, &change, mean, false);
    } else {
        state->sequence = FOC_NO_SETPOINT;
        current_predictor_change(&current->predictor, &change, mean, true);
        const dq_t shaped = reference_prefilter_output(&state->prefilter, &change);
        given = inside_circle(&state->current_circle, shaped.d, shaped.q);
        target = current_predictor_target(&current->predictor, &change);
    }
    state->period.i_reference_pu = dq16_of(given);
    current->gains = current_gains_of(&setpoint->tuning, current->predictor.weight_q15, target);
    current->advance = setpoint->tuning.advance;
    current->slope = setpoint->dead_time_slope;
    state->spare_step = spare_tasks_after_setpoint(state->spare_step, state->period.step_count);
    state->calibrating = false;
}

void setpoint_take(foc_state_t *state, const fast_setpoint_t *setpoint)
{
    if (is_due(state)) {
        apply(state, setpoint);
    }
}

/* SPDX-License-Identifier: Apache-2.0 */
#include "idle.h"

#include "core/angle.h"
#include "current_controller.h"
#include "current_predictor.h"
#include "emf_observer.h"
#include "reference_prefilter.h"
#include "sense.h"
#include "sensor_isolation.h"
#include "spare_tasks.h"
#include "transforms.h"

static void calibrate(foc_state_t *state, const uint16_t codes[SENSE_PHASES])
{
    sense_state_t *sense = &state->current.sense;
    if (!state->calibrating) {
        sense_calibrate_restart(sense);
    }
    sense_calibrate_step(sense, codes);
}

/* In an active short circuit the current vector turns with the magnets: forward counts up. A step
 * of two quadrants has no direction and does not count. At the speed base, 1/16 turn per period,
 * each quadrant is seen four times. */
static void count_quadrants(foc_state_t *state, ab16_t i)
{
    const uint32_t upper = q_pair_x(i.v) >= 0 ? 0 : 1;
    const uint32_t quadrant = q_pair_y(i.v) >= 0 ? upper : 3U - upper;
    const uint32_t step = (quadrant - state->quadrant) & 3U;
    state->quadrant = quadrant;
    if ((step & 1U) != 0) {
        state->quadrant_transitions =
            (uint16_t)(state->quadrant_transitions + (step == 1U ? 1U : UINT16_MAX));
        state->quadrant_step = (uint16_t)state->period.step_count;
    }
}

void idle_centre_on_times(foc_current_state_t *state)
{
    for (int x = 0; x < SENSE_PHASES; x++) {
        state->on_q16[x] = state->modulation.centre_q16;
    }
}

void idle_step(foc_state_t *state, const fast_setpoint_t *setpoint,
               const uint16_t codes[SENSE_PHASES])
{
    foc_period_t *period = &state->period;
    const sense_out_t sensed = sense_step(&state->current.sense, codes, state->current.on_q16);
    const ab16_t i = sensor_isolation_current(&state->current, codes, sensed.i);
    const voltage_out_t no_voltage = {.unsaturated_d_q25 = 0};
    const dq16_t no_current = {.v = q_pair(0, 0)};
    const ab16_t no_voltage_ab = {.v = q_pair(0, 0)};
    period->i_reference_pu = no_current;
    period->i_pu = transforms_park(i, angle_rotation(period->theta_turn));
    count_quadrants(state, i);
    state->idle_alpha_pu += (uint32_t)q_pair_x(i.v);
    state->idle_beta_pu += (uint32_t)q_pair_y(i.v);
    period->voltage = no_voltage;
    period->u_ab = no_voltage_ab;
    state->u_acting = no_voltage_ab;
    period->i_ab_pu = i;
    period->current_sum_pu = sensed.sum_pu;
    emf_observer_reset(&state->observer);
    current_controller_reset(&state->current.controller);
    reference_prefilter_reset(&state->prefilter);
    current_predictor_reset(&state->current.predictor);
    state->weakening.current_q28 = 0;
    idle_centre_on_times(&state->current);
    if (setpoint->clear_trip) {
        sensor_isolation_acknowledge(&state->current.isolation);
    }
    if (setpoint->calibrate_offsets) {
        calibrate(state, codes);
    }
    state->calibrating = setpoint->calibrate_offsets;
    state->sequence = FOC_NO_SETPOINT;
    state->spare_step = spare_tasks_next(state->period.step_count);
    state->postponed = true; /* a start applies its setpoint at once, also at a hall edge */
}

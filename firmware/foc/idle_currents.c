/* SPDX-License-Identifier: Apache-2.0 */
#include "idle_currents.h"

/* In an active short circuit the current vector turns with the magnets: forward counts up. A step
 * of two quadrants has no direction and does not count. At the speed base, 1/16 turn per period,
 * each quadrant is seen four times. */
static void count_quadrants(idle_currents_t *state, ab16_t i, uint32_t step_count)
{
    const uint32_t upper = q_pair_x(i.v) >= 0 ? 0 : 1;
    const uint32_t quadrant = q_pair_y(i.v) >= 0 ? upper : 3U - upper;
    const uint32_t step = (quadrant - state->quadrant) & 3U;
    state->quadrant = quadrant;
    if ((step & 1U) != 0) {
        state->quadrant_transitions =
            (uint16_t)(state->quadrant_transitions + (step == 1U ? 1U : UINT16_MAX));
        state->quadrant_step = (uint16_t)step_count;
    }
}

void idle_currents_step(idle_currents_t *state, ab16_t i, uint32_t step_count)
{
    count_quadrants(state, i, step_count);
    state->alpha_pu += (uint32_t)q_pair_x(i.v);
    state->beta_pu += (uint32_t)q_pair_y(i.v);
}

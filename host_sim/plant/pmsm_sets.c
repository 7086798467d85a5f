/* SPDX-License-Identifier: Apache-2.0 */
/* The steps of pmsm.h that are more than one linear set: fast rotors, iron that saturates, currents
 * near zero. */
#include <math.h>

#include "pmsm_stages.h"

pmsm_flow_t pmsm_step_in_sets(const equations_t *eq, pmsm_state_t *state, plant_ab_t u,
                              const pmsm_step_t *step)
{
    const int sets = pmsm_sets(eq, step);
    const double h = step->duration_s / sets;
    const plant_phasor_t half_turn = plant_small_phasor(0.5 * eq->w * h);
    pmsm_flow_t flow = {.charge_as = {0.0, 0.0}};
    /* pmsm_step() has tried a single linear set. */
    for (int k = 0; k < sets; k++) {
        if (eq->machine->magnetics.saturates) {
            pmsm_saturated_advance(eq->machine, eq, &step->opposition, state, u, h, half_turn,
                                   &flow);
        } else {
            pmsm_straight_advance(eq, &step->opposition, state, u, h, half_turn, sets > 1, &flow);
        }
    }
    return flow;
}

/* SPDX-License-Identifier: Apache-2.0 */
/*
 * idle_currents.h: what the sampled current shows while the bridge does not switch: its sums tell a
 * switch that conducts, the quadrant transitions of its vector a speed without a sensor. Once per
 * PWM period with the bridge off or in active short circuit.
 */
#ifndef FOC_IDLE_CURRENTS_H
#define FOC_IDLE_CURRENTS_H

#include <stdint.h>

#include "core/frames.h"
#include "foc/state.h"

/* i: sampled current; step_count: number of the period. */
void idle_currents_step(idle_currents_t *state, ab16_t i, uint32_t step_count);

#endif

/* SPDX-License-Identifier: Apache-2.0 */
/*
 * idle.h: a PWM period with the bridge off or in active short circuit. The currents are measured;
 * everything else is reset, so that the next start is bump-free.
 */
#ifndef FOC_IDLE_H
#define FOC_IDLE_H

#include "core/fast_messages.h"
#include "foc/state.h"

/* setpoint: with calibrate_offsets also a sample of the offset calibration, which restarts when it
 * was false; clear_trip acknowledges an undetermined sum of currents. */
void idle_step(foc_state_t *state, const fast_setpoint_t *setpoint,
               const uint16_t codes[SENSE_PHASES]);

/* Half the period on every leg. */
void idle_centre_on_times(foc_current_state_t *state);

#endif

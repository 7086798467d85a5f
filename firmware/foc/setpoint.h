/* SPDX-License-Identifier: Apache-2.0 */
/*
 * setpoint.h: applies the slow loop's setpoint to the current controller. Runs in the PWM periods
 * with a new setpoint, a new field-weakening current, or a reference that has not settled.
 */
#ifndef FOC_SETPOINT_H
#define FOC_SETPOINT_H

#include "core/fast_messages.h"
#include "foc/state.h"

/* Largest |i_d_sampling_correction_pu| that is used. */
enum { SETPOINT_SAMPLING_CORRECTION_PU = 200 };

/* A setpoint that is not the one in use. state->period.i_reference_pu becomes the setpoint plus the
 * field-weakening current, prefiltered and limited to the current circle with priority for d; the
 * spare tasks wait for another period. At a hall edge the setpoint waits one period, so that the
 * two longest computations never meet. */
void setpoint_take(foc_state_t *state, const fast_setpoint_t *setpoint);

/* Every period with the bridge switching. */
static inline void setpoint_step(foc_state_t *state, const fast_setpoint_t *setpoint)
{
    if (state->sequence != setpoint->sequence) {
        setpoint_take(state, setpoint);
    }
}

#endif

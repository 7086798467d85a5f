/* SPDX-License-Identifier: Apache-2.0 */
/*
 * spare_tasks.h: what any period with the bridge switching can do and none has to: field weakening
 * and the observer's acquisition, and before them the look for frozen readings. Once in four
 * periods, counted by foc_period_t.step_count; each time one period later where there is a hall
 * edge or a new setpoint, so that the long computations never meet.
 */
#ifndef FOC_SPARE_TASKS_H
#define FOC_SPARE_TASKS_H

#include <stdbool.h>
#include <stdint.h>

#include "config/config.h"
#include "emf_observer.h"
#include "foc/state.h"

enum { SPARE_TASKS_PERIODS = EMF_OBSERVER_ACQUIRE_PERIODS };

/* The next multiple of four: a delay does not add up. */
static inline uint32_t spare_tasks_next(uint32_t step_count)
{
    return (step_count | (SPARE_TASKS_PERIODS - 1U)) + 1U;
}

/* A setpoint is applied in this period: not in the same one. Returns when they are due, one to four
 * periods ahead whatever due_step is: a flipped bit of it lasts until the next setpoint. */
static inline uint32_t spare_tasks_after_setpoint(uint32_t due_step, uint32_t step_count)
{
    return due_step - step_count - 1U < SPARE_TASKS_PERIODS ? due_step : step_count + 1U;
}

/* In a period in which they are due; after the current step. Returns true if the readings are
 * frozen. A look comes one period before the other tasks. */
bool spare_tasks_run(foc_state_t *state, const config_t *config,
                     const uint16_t codes[SENSE_PHASES]);

/* Every period: runs them if they are due. */
static inline bool spare_tasks_step(foc_state_t *state, const config_t *config,
                                    const uint16_t codes[SENSE_PHASES])
{
    return state->period.step_count == state->spare_step && spare_tasks_run(state, config, codes);
}

#endif

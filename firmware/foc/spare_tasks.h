/* SPDX-License-Identifier: Apache-2.0 */
/*
 * spare_tasks.h: when the tasks are due that any period can do and none has to: field weakening and
 * the observer's acquisition, and before them the look for frozen readings. Once in four periods,
 * counted by foc_period_t.step_count; each time one period later where there is a hall edge or a
 * new setpoint, so that the long computations never meet.
 */
#ifndef FOC_SPARE_TASKS_H
#define FOC_SPARE_TASKS_H

#include <stdint.h>

#include "emf_observer.h"

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

#endif

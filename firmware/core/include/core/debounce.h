/* SPDX-License-Identifier: Apache-2.0 */
/*
 * debounce.h: a condition counts once it has lasted, and for some time after it has ended. Called
 * once a step; times in steps.
 */
#ifndef CORE_DEBOUNCE_H
#define CORE_DEBOUNCE_H

#include <stdbool.h>
#include <stdint.h>

typedef struct {
    uint16_t count; /* steps for which the condition has lasted, saturating */
    uint16_t left;  /* steps for which it still counts */
} debounce_t;

/* True from the step in which the condition has lasted `qualify` steps in a row until it has been
 * absent for `heal` steps. Both at least 1; heal = 1: until the first step without it. */
static inline bool debounce_step(debounce_t *state, bool condition, uint32_t qualify, uint32_t heal)
{
    const uint32_t counted = state->count < UINT16_MAX ? state->count + 1U : UINT16_MAX;
    state->count = (uint16_t)(condition ? counted : 0U);
    if (state->count >= qualify) {
        state->left = (uint16_t)heal;
    } else if (state->left > 0U) {
        state->left--;
    }
    return state->left > 0U;
}

#endif

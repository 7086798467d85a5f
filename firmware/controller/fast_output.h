/* SPDX-License-Identifier: Apache-2.0 */
/*
 * fast_output.h: what the fast loop gives to the bridge, by the on times of its modulation. PWM
 * interrupt, and once at initialisation; pure.
 */
#ifndef CONTROLLER_FAST_OUTPUT_H
#define CONTROLLER_FAST_OUTPUT_H

#include "controller/controller.h"

/* Whole counts of the timer, rounded down; bridge: what is to be done with them. */
static inline void fast_output_write(controller_fast_t *fast, bridge_mode_t bridge)
{
    const int32_t *on_q16 = foc_on_times_q16(&fast->foc);
    for (int x = 0; x < SENSE_PHASES; x++) {
        fast->output.compare_counts[x] = (uint16_t)((uint32_t)on_q16[x] >> 16);
    }
    fast->output.bridge = bridge;
}

#endif

/* SPDX-License-Identifier: Apache-2.0 */
/*
 * current_expectation.h: the current that must flow at a setpoint, for the monitor. 1 kHz.
 *
 * The fast monitor gets a quarter of it: a sampled current vector that falls from above that to
 * zero, from one period to the next, is a sensor's and not the motor's (monitor README, All current
 * sensors). The slow one gets the reference of the averaging window.
 */
#ifndef CONTROLLER_CURRENT_EXPECTATION_H
#define CONTROLLER_CURRENT_EXPECTATION_H

#include <stdbool.h>
#include <stdint.h>

#include "config/config.h"
#include "core/frames.h"

typedef struct {
    dq_t reference_pu;    /* of the latest setpoint, without field weakening, Q15 */
    uint32_t most_square; /* of a quarter of the largest reference, Q30 */
} current_expectation_t;

void current_expectation_init(current_expectation_t *state, const config_t *config);

/* Square of a quarter of the shorter of this setpoint's reference and the one before, Q30; 0 where
 * they point in different directions, where that is no more than twice what a dead sensor may show,
 * and where the bridge did not switch with the one before.
 * reference_pu: 16 bits. */
uint32_t current_expectation_step(current_expectation_t *state, dq_t reference_pu, bool switching);

#endif

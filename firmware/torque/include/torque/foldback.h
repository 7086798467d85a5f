/* SPDX-License-Identifier: Apache-2.0 */
/*
 * foldback.h: how much current a motor may draw, or return, near an end of the battery's voltage.
 * 1 kHz.
 *
 * An integrator of the voltage error that does not follow commands and other limits. In the steady
 * state a straight line: the whole current one width inside the end, none at the end itself. Gain
 * and stability: README, Fold-back.
 */
#ifndef TORQUE_FOLDBACK_H
#define TORQUE_FOLDBACK_H

#include <stdint.h>

typedef struct {
    int32_t most_mA;  /* away from the end of the voltage, >= 0 */
    int32_t width_mV; /* >= 1 */
    int32_t span_mV;  /* >= 1: the whole range of the battery's voltage */
} foldback_t;

enum { FOLDBACK_FRACTION_LOG2 = 6 };

typedef struct {
    int32_t allowed_q6_mA; /* 0 .. most, six more bits */
} foldback_state_t;

/* inside_mV: distance of the voltage from its end, positive inside. flowing_mA: this motor's share
 * of the current now, >= 0: where the voltage asks for less, what was allowed beyond it is given up
 * first (anti-windup). Returns the current allowed now, 0 .. most; 0 from one width outside on. */
int32_t foldback_step(foldback_state_t *state, const foldback_t *foldback, int32_t inside_mV,
                      int32_t flowing_mA);

#endif

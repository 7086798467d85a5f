/* SPDX-License-Identifier: Apache-2.0 */
/*
 * foldback.h: limit of the current that a motor draws or returns near an end of the battery's
 * voltage range. 1 kHz.
 *
 * The limit is an integrator of the voltage error, independent of commands and other limits: the
 * voltage counts as if the whole limit flowed. In the steady state the limit is a straight line
 * over that voltage: the full current one width inside the end, zero at the end. Gain and
 * stability: DERIVATIONS.md, Fold-back.
 */
#ifndef TORQUE_FOLDBACK_H
#define TORQUE_FOLDBACK_H

#include <stdint.h>

typedef struct {
    int32_t most_mA;  /* limit away from the end of the voltage range, >= 0 */
    int32_t width_mV; /* >= 1 */
    int32_t span_mV;  /* >= 1: the whole range of the battery's voltage */
    int32_t rise_mV;  /* 0 .. 4 span_mV: how far `most` flowing moves the voltage to its end */
} foldback_t;

typedef struct {
    int32_t allowed_q24; /* share of `most` that is allowed, 0 .. 2^24 */
} foldback_state_t;

/* inside_mV: distance of the voltage from its end, positive inside. flowing_mA: present current of
 * this motor towards that end, negative where it moves the voltage away from the end. Beyond the
 * end the limit first drops to this current (anti-windup). Returns the current limit, 0 .. most_mA;
 * zero from one width outside the end on. */
int32_t foldback_step(foldback_state_t *state, const foldback_t *foldback, int32_t inside_mV,
                      int32_t flowing_mA);

#endif

/* SPDX-License-Identifier: Apache-2.0 */
/*
 * observer_error.h: by how much the angle of the EMF observer may be wrong because L_q is not known
 * better. 1 kHz. L_q is taken to lie within 50 % of the configured constant, or within 10 % of a
 * flux map: DERIVATIONS.md, Uncertain L_q.
 */
#ifndef MOTOR_OBSERVER_ERROR_H
#define MOTOR_OBSERVER_ERROR_H

#include <stdbool.h>
#include <stdint.h>

#include "motor/feasible_torque.h"

/* Whether L_q alone explains an angle between rotor sensor and observer, 0 .. 30 600 of 65 536 in a
 * turn; never one beyond a quarter. i: in the sensor's frame, up to 2^23 mA. */
bool observer_error_explains(const config_t *config, motor_current_t i, int32_t angle_turn);

/* With the observer's angle in use: magnitude of the largest shaft torque on a side, mN m, at whose
 * currents L_q turns that angle by at most 15 degrees. side: its cap within voltage and phase
 * current. */
int32_t observer_error_torque_mNm(const feasible_side_t *side);

#endif

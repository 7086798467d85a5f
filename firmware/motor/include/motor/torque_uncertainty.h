/* SPDX-License-Identifier: Apache-2.0 */
/*
 * torque_uncertainty.h: how far the real torque may be from the estimate, from the limits of
 * config_t.tolerance. Slow loop, about 200 instructions; every 16th step. Information: no bound or
 * command uses it.
 *
 * DERIVATIONS.md, Uncertain torque.
 */
#ifndef MOTOR_TORQUE_UNCERTAINTY_H
#define MOTOR_TORQUE_UNCERTAINTY_H

#include "motor/motor_model.h"

/* Standard uncertainty of motor_model_torque_mNm() at the same point, >= 0: one standard deviation
 * of the torque of motors, sensors and angles that lie anywhere within the limits. Within 4 % and
 * 2 mN m of it; with a flux map from 4 % below to 8 % above. INT32_MAX: not available, on a port
 * that leaves it out. */
int32_t torque_uncertainty_mNm(const motor_model_t *model, motor_point_t at);

#endif

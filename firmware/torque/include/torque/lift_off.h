/* SPDX-License-Identifier: Apache-2.0 */
/*
 * lift_off.h: lift-off braking, by the motor beside what the brake pedal has of it. 1 kHz.
 *
 * All limits of the motor hold but those of the braking strategy: the driver may brake beyond the
 * loss optimum with the accelerator, up to the torque from which on the battery would pay for it.
 * What that and the low-speed blend-out take away is handed to the hydraulic brake, so that the
 * vehicle comes to rest and stays there, and what CURRENT_GAIN does.
 */
#ifndef TORQUE_LIFT_OFF_H
#define TORQUE_LIFT_OFF_H

#include <stdint.h>

#include "torque/torque_limits.h"

typedef struct {
    int32_t motor_mNm; /* magnitudes >= 0; together at most the demand */
    int32_t hydraulic_mNm;
    reason_t reason; /* why the motor does not take all of it; REASON_NONE if it does */
} lift_off_t;

/* demand_mNm: lift-off braking; electric_mNm: what brake blending demands of the motor; both
 * magnitudes >= 0. coasting_mNm: what the wheel brakes with at zero current, >= 0. The motor's part
 * is what these limits leave beside electric_mNm. */
lift_off_t lift_off_split(const torque_limits_t *limits, int32_t demand_mNm, int32_t electric_mNm,
                          int32_t coasting_mNm);

#endif

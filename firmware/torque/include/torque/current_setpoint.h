/* SPDX-License-Identifier: Apache-2.0 */
/*
 * current_setpoint.h: the currents that make a torque with the least loss. 1 kHz.
 *
 *     i_d  from the minimum-loss map, plus what field weakening adds to it in the fast loop
 *     i_q  from the torque and that i_d (motor_model.h), iron-loss current included
 *
 * Computing i_q from the i_d that flows keeps the torque of a salient motor while field weakening
 * lowers i_d.
 */
#ifndef TORQUE_CURRENT_SETPOINT_H
#define TORQUE_CURRENT_SETPOINT_H

#include <stdbool.h>
#include <stdint.h>

#include "config/config.h"
#include "torque/motor_model.h"

/* Peak phase, terminal, means over the PWM period. */
typedef struct {
    int32_t i_d_mA; /* without the part that field weakening adds in the fast loop */
    int32_t i_q_mA; /* for the i_d with that part */
    bool limited;   /* the phase current limit shortened i_q */
} current_setpoint_t;

/*
 * torque_mNm: signed shaft torque, within the limits of torque_limits.h. i_d_weakening_mA: reported
 * by the fast loop, <= 0 (values above count as 0). The sum of map and weakening stays above minus
 * current_loop.field_weakening_current, or above the map's own current where that is lower: beyond
 * it a motor can lose more torque than it gains voltage. Inside the circle of
 * motor.max_phase_current i_q gives way to i_d: |torque| gets smaller, i_q keeps its sign.
 */
current_setpoint_t current_setpoint_step(const motor_model_t *model, int32_t torque_mNm,
                                         int32_t i_d_weakening_mA);

#endif

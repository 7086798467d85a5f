/* SPDX-License-Identifier: Apache-2.0 */
/*
 * current_setpoint.h: the currents of minimum loss for a torque. 1 kHz.
 *
 *     i_d  of the feasible set at the torque (feasible_torque.h): that of the minimum-loss map, or
 *          of the voltage ellipse where lower
 *     i_q  from the torque, that i_d and the fast loop's field-weakening trim (motor_model.h)
 *
 * The ellipse is computed with the motor model; the trim corrects errors of its parameters.
 */
#ifndef MOTOR_CURRENT_SETPOINT_H
#define MOTOR_CURRENT_SETPOINT_H

#include <stdbool.h>
#include <stdint.h>

#include "config/config.h"
#include "motor/feasible_torque.h"

/* Peak phase, terminal, means over the PWM period. */
typedef struct {
    int32_t i_d_mA;     /* without the trim, which the fast loop adds */
    int32_t i_q_mA;     /* for the i_d with the trim */
    bool limited;       /* i_q reduced by the phase current limit */
    bool feasible;      /* the voltage suffices for the currents, limited or not */
    int32_t forced_mNm; /* braking torque that the voltage forces instead, magnitude; 0: none */
} current_setpoint_t;

/* torque_mNm: signed shaft torque, within the limits of torque_limits.h. i_d_weakening_mA: the trim
 * that the fast loop reports, <= 0 (values above count as 0). i_d with the trim stays above minus
 * current_loop.field_weakening_current, or above i_d itself where that is lower. The circle of
 * motor.max_phase_current limits i_q after i_d: |torque| gets smaller, i_q keeps its sign. */
current_setpoint_t current_setpoint_step(const feasible_set_t *set, int32_t torque_mNm,
                                         int32_t i_d_weakening_mA);

#endif

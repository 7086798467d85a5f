/* SPDX-License-Identifier: Apache-2.0 */
/*
 * current_setpoint.h: the currents that make a torque with the least loss, inside the current
 * circle.
 *
 *     i_d  from the map of least loss (loss_maps.h), plus what field weakening adds to it in the
 * fast reach i_q  from the torque and that i_d (motor_model.h), iron-loss current included
 *
 * The torque of a salient motor depends on i_d: computing i_q from the i_d that really flows keeps
 * the torque while field weakening lowers i_d, and takes i_q back where reluctance torque comes in.
 */
#ifndef TORQUE_CURRENT_SETPOINT_H
#define TORQUE_CURRENT_SETPOINT_H

#include <stdbool.h>
#include <stdint.h>

#include "config/config.h"
#include "torque/motor_model.h"

typedef struct {
    int32_t i_d_mA; /* peak phase, terminal; without the part that field weakening adds in the fast
                       reach */
    int32_t i_q_mA; /* peak phase, terminal; for the i_d with that part */
    bool limited;   /* the phase current limit bit */
} current_setpoint_t;

/*
 * What a torque takes, whatever the current limit: terminal currents, field weakening's part
 * included.
 *
 * torque_mNm: signed shaft torque. i_d_weakening_mA: reported by the fast reach, <= 0 (values above
 * count as 0). The sum of map and weakening stays above minus current_loop.field_weakening_current,
 * or above the map's own current where that is lower: beyond it a motor can lose more torque than
 * it gains voltage.
 */
motor_current_t current_setpoint_unlimited(const config_t *config, const motor_model_t *model,
                                           int32_t torque_mNm, int32_t i_d_weakening_mA);

/*
 * The same inside the circle of motor.max_phase_current. Where the two do not fit together, i_q
 * gives way to field weakening (without it there is no voltage to drive i_q), and the map's i_d
 * shrinks with the torque: |torque| gets smaller, i_q keeps its sign. torque_limits.h keeps the
 * command where nothing has to give way.
 */
current_setpoint_t current_setpoint_step(const config_t *config, const motor_model_t *model,
                                         int32_t torque_mNm, int32_t i_d_weakening_mA);

#endif

/* SPDX-License-Identifier: Apache-2.0 */
/*
 * loss_braking.h: braking with the losses of the motor where the battery takes less than the brakes
 * could return. 1 kHz.
 *
 * At a given torque a lower i_d raises the copper loss and returns less power. It is largest on the
 * current circle, and the torque that returns nothing there is
 *
 *     T = (3/2 R I^2 + P_bridge + P_fe) / w        DERIVATIONS.md, Loss braking
 *
 * The current is motor.max_phase_current, less with the derating of winding and switches.
 * brake.loss_braking switches it off. All quantities in the binary scales of the motor model.
 */
#ifndef MOTOR_LOSS_BRAKING_H
#define MOTOR_LOSS_BRAKING_H

#include <stdint.h>

#include "motor/current_setpoint.h"
#include "motor/feasible_torque.h"

typedef struct {
    int32_t current_b;            /* up to which i_d may raise |i|; 0: no loss braking */
    feasible_returned_t returned; /* what the battery takes comes first */
    int32_t by_map_mNm;           /* the torque that returns it with the i_d of the map */
    int32_t torque_mNm;           /* that returns nothing on the circle, or draws what
                                     `returned` demands; 0: not computed */
    motor_point_t at;             /* of torque_mNm where it is computed */
} loss_braking_t;

/* share_q15: derating of winding and switches, 32 767 = none. */
loss_braking_t loss_braking_at(const motor_model_t *model, feasible_returned_t returned,
                               int32_t share_q15);

/* Largest braking torque, mN m: the one that returns nothing on the current circle (less where
 * returned.power_b is below zero, more with returned.drawn_b), or by_map_mNm, what
 * feasible_by_returned_mNm() gives for the i_d of the map, where that is larger. */
int32_t loss_braking_torque_mNm(const feasible_side_t *side, loss_braking_t *losses,
                                int32_t by_map_mNm);

/* Above by_map_mNm a current setpoint of the same torque that returns what the battery takes, as
 * far as the current suffices; otherwise the same setpoint. */
current_setpoint_t loss_braking_setpoint(const feasible_set_t *set, const loss_braking_t *losses,
                                         int32_t torque_mNm, current_setpoint_t current);

#endif

/* SPDX-License-Identifier: Apache-2.0 */
/*
 * feasible_torque.h: the torques that voltage, phase current and a battery's power allow at one
 * speed, temperature and bus voltage. Derivations: README, Feasible torque.
 *
 * At every torque i_d is the minimum-loss map's, or where the voltage does not suffice with it, the
 * i_d at which the voltage ellipse is met, no further than field weakening goes. All bounds are
 * magnitudes of shaft torque, mN m, >= 0, on the driving or the braking side; FEASIBLE_UNBOUNDED
 * where there is none. Closed form with a fixed number of corrections of i_d: the cost does not
 * depend on what bounds. Precision 0.2 % of max_torque.
 */
#ifndef TORQUE_FEASIBLE_TORQUE_H
#define TORQUE_FEASIBLE_TORQUE_H

#include <stdbool.h>
#include <stdint.h>

#include "torque/loss_maps.h"
#include "torque/motor_model.h"

#define FEASIBLE_UNBOUNDED INT32_MAX

typedef enum { SIDE_DRIVING = 1, SIDE_BRAKING = -1 } side_t;

typedef struct {
    const motor_model_t *model;
    loss_maps_row_t row;
    int32_t voltage_b;   /* largest |u| */
    int32_t weakest_d_b; /* the i_d that field weakening goes down to, <= 0 */
} feasible_set_t;

/* phase_voltage_mV: peak phase, mean over the period, >= 0. */
feasible_set_t feasible_set_at(const motor_model_t *model, int32_t phase_voltage_mV);

/* Up to where some pair of currents keeps the voltage within its circle. */
int32_t feasible_by_voltage_mNm(const feasible_set_t *set, side_t side);

/* Up to where |i| stays within motor.max_phase_current: maximum torque per ampere on the current
 * circle, or where the voltage ellipse meets the circle. */
int32_t feasible_by_current_mNm(const feasible_set_t *set, side_t side);

/* Up to where a motor that drives, or brakes beyond the torque that returns the most, draws no more
 * than a current at the bus voltage, or a negligible power. cap_mNm: what the motor may do anyway;
 * unbounded where even that is within the limit. */
int32_t feasible_by_drawn_mNm(const feasible_set_t *set, side_t side, int32_t cap_mNm,
                              int32_t current_mA, int32_t bus_mV);

/* Up to where braking returns no more than a current at the bus voltage. Unbounded where even the
 * best torque returns a negligible power (a thousandth of motor.max_power). With hall sensors the
 * power that a late edge may add is counted as returned. */
int32_t feasible_by_returned_mNm(const feasible_set_t *set, int32_t cap_mNm, int32_t current_mA,
                                 int32_t bus_mV);

/* The i_d on the current circle that makes an airgap torque beyond what the map's i_d leaves there:
 * between the map's and that of maximum torque per ampere. Binary scales, along the rotation. */
int32_t feasible_circle_d_b(const motor_model_t *model, int32_t airgap_b, int32_t map_d_b);

#endif

/* SPDX-License-Identifier: Apache-2.0 */
/*
 * feasible_torque.h: the torques that voltage, phase current and a battery's power allow at one
 * speed, temperature and bus voltage, and the currents that make them. DERIVATIONS.md,
 * Feasible torque.
 *
 * At every torque i_d is that of the minimum-loss map or, where that exceeds the voltage limit,
 * that on the voltage ellipse, down to the current circle or to maximum torque per voltage. All
 * bounds are magnitudes of shaft torque, mN m, >= 0; FEASIBLE_UNBOUNDED: no bound up to the cap.
 * Closed form with a fixed number of corrections of i_d. Precision 0.2 % of max_torque; by power on
 * the voltage ellipse 0.5 % of max_power.
 */
#ifndef MOTOR_FEASIBLE_TORQUE_H
#define MOTOR_FEASIBLE_TORQUE_H

#include <stdbool.h>
#include <stdint.h>

#include "motor/loss_maps.h"
#include "motor/motor_model.h"

#define FEASIBLE_UNBOUNDED INT32_MAX

typedef enum { SIDE_DRIVING = 1, SIDE_BRAKING = -1 } side_t;

/* The sum u_d i_d + u_q i_q over i_qt = x: a x^2 + (b + b_d d) x + c + (c_d + c_dd d) d. */
typedef struct {
    int32_t a, b, b_d, c, c_d, c_dd;
} feasible_power_t;

/* Once a slow step, for bounds and setpoint. The model must outlive it. */
typedef struct {
    const motor_model_t *model;
    feasible_power_t power;
    loss_maps_row_t row;
    int64_t voltage_squared; /* of the largest |u|, binary scale */
    int32_t weakest_d_b;     /* lowest i_d, <= 0: DERIVATIONS.md, Feasible torque */
} feasible_set_t;

/* One direction of torque up to its cap, the point of the largest torque that the other limits
 * permit. Voltage and phase current lower it: no bound beyond it is solved. */
typedef struct {
    const feasible_set_t *set;
    int32_t sign; /* 1 driving, -1 braking */
    int32_t cap_mNm;
    motor_point_t cap;
    bool cap_has_voltage; /* at the cap's i_d */
} feasible_side_t;

typedef struct {
    int32_t voltage_mNm, current_mNm;
} feasible_bounds_t;

/* i_d on the current circle, of both sides: best_b for maximum torque per ampere, lowest_b of field
 * weakening; near d_b the voltage ellipse meets it, lower by by_side_b driving, higher braking. */
typedef struct {
    bool known;
    int32_t best_b, lowest_b, d_b, by_side_b;
} feasible_circle_t;

/* phase_voltage_mV: peak phase, mean over the period, >= 0. */
feasible_set_t feasible_set_at(const motor_model_t *model, int32_t phase_voltage_mV);

/* Makes model and set exact at terminal currents, i_q along the rotation: of a motor with a flux
 * map; constants are exact everywhere. model: that of the set. */
void feasible_set_around(feasible_set_t *set, motor_model_t *model, motor_current_t around);

/* cap_mNm: magnitude of a shaft torque, >= 0; with the map's i_d. */
feasible_side_t feasible_side_at(const feasible_set_t *set, side_t sign, int32_t cap_mNm);

/* Largest torque with |u| within the available voltage: an end of the voltage ellipse. */
int32_t feasible_by_voltage_mNm(feasible_side_t *side);

/* Largest torque with |i| within motor.max_phase_current, the voltage sufficing: maximum torque per
 * ampere on the current circle, or where the voltage ellipse meets the circle. circle: made by the
 * first side that needs it, for both; {.known = false} before. */
int32_t feasible_by_current_mNm(feasible_side_t *side, feasible_circle_t *circle);

/* Both, but only the one that bounds the torque is solved. */
feasible_bounds_t feasible_by_voltage_and_current(feasible_side_t *side, feasible_circle_t *circle);

/* What a battery takes, scale of feasible_power_b(); below zero the motor draws at least that. The
 * margin is what its management permits beyond that where the bus voltage is the tighter limit: the
 * fold-back regulates the measured voltage, so that an uncertain angle counts only beyond the
 * margin. drawn_b >= 0: what the motor draws beyond its model, for the torque of loss braking. */
typedef struct {
    int32_t power_b, margin_b, drawn_b;
} feasible_returned_t;

/* By how much less a point returns than the battery takes, the loss of the bridge and the uncertain
 * angle included; negative where it returns more. Without a current, at standstill, all that the
 * battery takes, less at most what an uncertain angle may return. */
int32_t feasible_excess_b(const feasible_set_t *set, motor_point_t at,
                          feasible_returned_t returned);

/* Magnitude of the shaft torque on a side, mN m, of an airgap torque along the rotation. */
int32_t feasible_magnitude_mNm(const feasible_side_t *side, int32_t airgap_b);

/* The power of a battery current, for the two bounds below. Both count the loss of the bridge. */
int32_t feasible_power_b(const motor_model_t *model, int32_t current_mA, int32_t bus_mV);

/* What the motor draws along the i_d of a side's cap, a x^2 + b x + c, and at the cap; with the
 * loss of the bridge. For both bounds, as long as the set stays as it is. */
typedef struct {
    int32_t a, b, c;
    int32_t i_q_b; /* of the cap */
    int64_t drawn_b;
} feasible_cap_power_t;

feasible_cap_power_t feasible_cap_power(const feasible_side_t *side);

/* Largest torque, in driving or in braking beyond the torque of largest regeneration, at which the
 * motor draws at most power_b or a thousandth of motor.max_power, whichever is larger. found: its
 * currents; without a bound the cap's. */
int32_t feasible_by_drawn_at(const feasible_side_t *side, const feasible_cap_power_t *cap,
                             int32_t power_b, motor_point_t *found);

static inline int32_t feasible_by_drawn_mNm(const feasible_side_t *side, int32_t power_b)
{
    const feasible_cap_power_t cap = feasible_cap_power(side);
    motor_point_t found;
    return feasible_by_drawn_at(side, &cap, power_b, &found);
}

/* Largest braking torque that returns no more than the battery takes. Unbounded where even the
 * torque of largest regeneration returns a negligible power. With hall sensors the power that the
 * angle error of a late edge may return is included. found: as above. */
int32_t feasible_by_returned_at(const feasible_side_t *side, const feasible_cap_power_t *cap,
                                feasible_returned_t returned, motor_point_t *found);

static inline int32_t feasible_by_returned_mNm(const feasible_side_t *side,
                                               feasible_returned_t returned)
{
    const feasible_cap_power_t cap = feasible_cap_power(side);
    motor_point_t found;
    return feasible_by_returned_at(side, &cap, returned, &found);
}

/* Whether the voltage suffices for a point, the fast loop's own reserve included. For zero current
 * it does at standstill; a voltage of zero does not for zero current and an EMF. */
bool feasible_holds(const feasible_set_t *set, motor_point_t at);

/* Where the voltage, reserve included, suffices neither for the point nor for zero torque at the
 * lowest i_d: replaces it by the one of least braking torque on the current circle for which it
 * suffices, or by the one of least voltage, and returns true. DERIVATIONS.md, Forced torque. */
bool feasible_forced(const feasible_set_t *set, motor_point_t *at);

/* The point of an airgap torque within the bounds, along the rotation: the map's i_d; on the
 * current circle one between the map's and that of maximum torque per ampere; on the voltage
 * ellipse the ellipse's. */
motor_point_t feasible_point(const feasible_set_t *set, int32_t airgap_b);

#endif

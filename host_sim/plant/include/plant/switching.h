/* SPDX-License-Identifier: Apache-2.0 */
/*
 * switching.h: the bridge of inverter.h edge by edge, on the machine of phases.h.
 *
 * A period T begins at the top of the count, where the firmware's converter samples: in the middle
 * of the low sides' time but for half a dead time, by which the pulses come late. Leg x is
 * commanded to rise at T (1 - d_x) / 2 and to fall at T (1 + d_x) / 2; the switch that opens opens
 * at once, the one that closes closes a dead time later. In between the diode carries the current,
 * V_f + R_ak i, and when the current ends there the leg floats until its switch closes or its
 * voltage leaves the rails. Closing and opening a switch that carries or takes over the current
 * costs half of k_on and half of k_off a ampere, the share that the paper's (12) counts
 * (inverter.h).
 *
 * The bus voltage is constant during a period. Duties 0 and 1 have no edges. A dead time that would
 * extend into the next period ends with this one.
 */
#ifndef PLANT_SWITCHING_H
#define PLANT_SWITCHING_H

#include "plant/inverter.h"
#include "plant/phases.h"
#include "plant/shunts.h"

typedef struct {
    double switch_ohm, diode_ohm, forward_v;
    double dead_s;
    double turn_on_j_per_a, turn_off_j_per_a; /* halves */
} switching_t;

/* What flowed in a period; the machine's part in the terms of the averaged bridge. */
typedef struct {
    pmsm_flow_t machine;
    inverter_flow_t bridge;
} switching_flow_t;

/* Measurements within the period. */
typedef struct {
    shunts_t *shunts; /* amplifiers that follow the low sides' currents; NULL: none */
    double settling_s;
    double until_s; /* only the first part of the period is done; 0: all of it. The angle goes to
                       the period's end. */
} switching_watch_t;

switching_t switching_model(const inverter_params_t *params, double switch_temperature_c);

/* One period of PWM, of all switches open (diodes alone), of all low sides closed. watch: may be
 * NULL. */
switching_flow_t switching_pwm(const switching_t *bridge, const pmsm_t *machine,
                               pmsm_state_t *rotor, plant_abc_t duty, double bus_voltage_v,
                               const pmsm_step_t *step, const switching_watch_t *watch);
switching_flow_t switching_off(const switching_t *bridge, const pmsm_t *machine,
                               pmsm_state_t *rotor, double bus_voltage_v, const pmsm_step_t *step,
                               const switching_watch_t *watch);
switching_flow_t switching_short(const switching_t *bridge, const pmsm_t *machine,
                                 pmsm_state_t *rotor, double bus_voltage_v, const pmsm_step_t *step,
                                 const switching_watch_t *watch);

#endif

/* SPDX-License-Identifier: Apache-2.0 */
/*
 * battery.h: a pack as open-circuit voltage over state of charge, series resistance and one RC
 * branch.
 *
 *     u_b = u_oc(SOC) - u_c - R_s i        C_t du_c/dt = i - u_c / R_t        i > 0 discharges
 *
 * battery_step() takes the power the wheels draw at the terminals (P > 0 discharges) and finds
 * the current that is constant over the step and makes exactly that power, with the exponential of
 * the RC branch solved exactly:
 *
 *     i = 2 P / (E + sqrt(E^2 - 4 R P)),    E and R of the step's mean,
 *     chemical = terminal + heat + stored, to rounding.
 *
 * Source: Lu et al. 2013 eqs (15) to (19), (24) corrected. Beyond the largest power E^2/(4 R) the
 * voltage collapses: the current is that of the largest power, and `collapsed` is set.
 */
#ifndef PLANT_BATTERY_H
#define PLANT_BATTERY_H

#include <stdbool.h>

#include "plant/curve.h"
#include "plant/parameter.h"

/* clang-format off */
#define BATTERY_PARAMETERS(X) \
    X(series_resistance_ohm,        0.0,  1e3,  "ohm", "R_s") \
    X(polarisation_resistance_ohm,  0.0,  1e3,  "ohm", "R_t; 0: no RC branch") \
    X(polarisation_capacitance_f,   1e-6, 1e9,  "F",   "C_t") \
    X(capacity_ah,                  1e-3, 1e6,  "A h", "") \
    X(initial_soc,                  0.0,  1.0,  "1", \
      "state of charge where work begins; set during a run: from then on") \
    X(max_charge_current_a,         0.0,  1e5,  "A", \
      "what the battery management allows into the pack") \
    X(max_discharge_current_a,      0.0,  1e5,  "A", \
      "what the battery management allows out of the pack")
/* clang-format on */

typedef struct {
    BATTERY_PARAMETERS(PLANT_PARAMETER_MEMBER)
    curve_t open_circuit_voltage_v; /* over state of charge */
} battery_params_t;

typedef struct {
    double soc;
    double polarisation_v; /* u_c */
    double terminal_v;     /* mean of the last step */
    double current_a;      /* of the last step, positive out of the pack */
    bool collapsed;        /* the requested power has exceeded the largest one */
    /* Of the step length: */
    double step_s;
    double decay;      /* exp(-step/tau) */
    double mean_decay; /* mean of exp(-t/tau) over the step */
} battery_state_t;

typedef struct {
    double chemical_j; /* drawn from (positive) or returned to the cells */
    double terminal_j;
    double heat_j;
} battery_flow_t;

battery_state_t battery_init(const battery_params_t *params, double step_s);

/* What the pack is to the outside during one step: an open-circuit voltage and a resistance, means
 * over the step. */
typedef struct {
    double open_v;
    double resistance_ohm;
    double cells_v; /* open-circuit voltage of the cells, which the chemical energy is of */
} battery_source_t;

battery_source_t battery_source(const battery_params_t *params, const battery_state_t *state);

/* The constant current with which a source gives power_w through resistance_ohm; *collapsed is set
 * when it cannot. */
double battery_current_a(double open_v, double resistance_ohm, double power_w, bool *collapsed);

/* Advance one step in which current_a flowed out of the pack. source: battery_source() of the same
 * state; whoever found the current has it. */
battery_flow_t battery_carry(const battery_params_t *params, battery_state_t *state,
                             const battery_source_t *source, double current_a);

/* terminal_j: energy drawn at the terminals during this step. */
battery_flow_t battery_step(const battery_params_t *params, battery_state_t *state,
                            double terminal_j);

/* Energy in the polarisation capacitance. */
double battery_stored_j(const battery_params_t *params, const battery_state_t *state);

#endif

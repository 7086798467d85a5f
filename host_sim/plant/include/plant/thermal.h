/* SPDX-License-Identifier: Apache-2.0 */
/*
 * thermal.h: two lumps of heat capacity in a row, for winding and housing, for switches and heat
 * sink.
 *
 *     C1 dT1/dt = P1 - (T1 - T2) / R1
 *     C2 dT2/dt = P2 + (T1 - T2) / R1 - (T2 - T_ambient) / R2
 *
 * Solved exactly for powers that are constant over the step (matrix exponential, worked out once).
 * R 0: no heat flow. C2 0: no outer node, the inner one is connected to the ambient by R1 + R2, and
 * P2 has no effect. C1 0: the temperatures are constant, as set by the scenario.
 */
#ifndef PLANT_THERMAL_H
#define PLANT_THERMAL_H

#include <stdbool.h>

#include "plant/parameter.h"

/* clang-format off */
#define THERMAL_PARAMETERS(X) \
    X(winding_heat_capacity_j_per_k,      0.0, 1e7,   "J/K", \
      "of one motor's winding; 0: its temperature stays") \
    X(winding_thermal_resistance_k_per_w, 0.0, 1e3,   "K/W",  "winding to housing; 0: insulated") \
    X(housing_heat_capacity_j_per_k,      0.0, 1e7,   "J/K", \
      "of one motor's iron and housing; 0: none between winding and ambient") \
    X(housing_thermal_resistance_k_per_w, 0.0, 1e3,   "K/W",  "housing to ambient; 0: insulated") \
    X(switch_heat_capacity_j_per_k,       0.0, 1e7,   "J/K", \
      "of one inverter's switches; 0: their temperature stays") \
    X(switch_thermal_resistance_k_per_w,  0.0, 1e3,   "K/W", \
      "switches to heat sink; 0: insulated") \
    X(heatsink_heat_capacity_j_per_k,     0.0, 1e7,   "J/K", \
      "of one inverter's heat sink; 0: none between switches and ambient") \
    X(heatsink_thermal_resistance_k_per_w, 0.0, 1e3,  "K/W", \
      "heat sink to ambient; 0: insulated") \
    X(winding_temperature_c,             -60.0, 300.0, "degC", \
      "where work begins, housing included") \
    X(switch_temperature_c,              -60.0, 300.0, "degC", \
      "where work begins, heat sink included") \
    X(ambient_temperature_c,             -60.0, 100.0, "degC", "") \
    X(active,                              0.0, 1.0,   "", \
      "1: heat warms what has a heat capacity; 0: temperatures stay")
/* clang-format on */

typedef struct {
    THERMAL_PARAMETERS(PLANT_PARAMETER_MEMBER)
} thermal_params_t;

/* One row of lumps as it is built. */
typedef struct {
    double inner_j_per_k, inner_k_per_w; /* C1, R1 */
    double outer_j_per_k, outer_k_per_w; /* C2, R2 */
} thermal_row_t;

typedef struct {
    double temperature_c; /* of the inner lump */
    double outer_c;
    bool fixed;
    /* Of the step length: what is left of both temperatures over ambient, and what a joule of the
     * step adds. */
    double keep[2][2];
    double gain_k_per_j[2][2];
} thermal_t;

thermal_t thermal_init(const thermal_row_t *row, double temperature_c, double step_s);

void thermal_step(thermal_t *thermal, double inner_j, double outer_j, double ambient_c);

#endif

/*
 * thermal.h: one lump of heat capacity with one way out.
 *
 *     C dT/dt = P - (T - T_ambient) / R_th
 *
 * Solved exactly for a power that is constant over the step. Capacity 0 switches the model off: the temperature is
 * then whatever the scenario set, for ever.
 */
#ifndef PLANT_THERMAL_H
#define PLANT_THERMAL_H

#include "plant/parameter.h"

/* clang-format off */
#define THERMAL_PARAMETERS(X) \
    X(winding_heat_capacity_j_per_k,      0.0, 1e7,   "J/K",  "of one motor's winding; 0: its temperature stays") \
    X(winding_thermal_resistance_k_per_w, 0.0, 1e3,   "K/W",  "winding to ambient; 0: insulated") \
    X(switch_heat_capacity_j_per_k,       0.0, 1e7,   "J/K",  "of one inverter's switches; 0: their temperature stays") \
    X(switch_thermal_resistance_k_per_w,  0.0, 1e3,   "K/W",  "switches to ambient; 0: insulated") \
    X(winding_temperature_c,             -60.0, 300.0, "degC", "where work begins") \
    X(switch_temperature_c,              -60.0, 300.0, "degC", "where work begins") \
    X(ambient_temperature_c,             -60.0, 100.0, "degC", "")
/* clang-format on */

typedef struct {
    THERMAL_PARAMETERS(PLANT_PARAMETER_MEMBER)
} thermal_params_t;

typedef struct {
    double temperature_c;
    double capacity_j_per_k;
    double resistance_k_per_w;
    double decay; /* exp(-step/(R C)), 1 when insulated */
    double step_s;
} thermal_lump_t;

thermal_lump_t thermal_init(double capacity_j_per_k, double resistance_k_per_w, double temperature_c, double step_s);

void thermal_step(thermal_lump_t *lump, double heat_j, double ambient_c);

#endif

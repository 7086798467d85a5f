#include "plant/thermal.h"

#include <math.h>

thermal_lump_t thermal_init(double capacity_j_per_k, double resistance_k_per_w, double temperature_c, double step_s)
{
    const double tau_s = capacity_j_per_k * resistance_k_per_w;
    const thermal_lump_t out = {
        .temperature_c = temperature_c,
        .capacity_j_per_k = capacity_j_per_k,
        .resistance_k_per_w = resistance_k_per_w,
        .decay = tau_s > 0.0 ? exp(-step_s / tau_s) : 1.0,
        .step_s = step_s,
    };
    return out;
}

void thermal_step(thermal_lump_t *lump, double heat_j, double ambient_c)
{
    if (lump->capacity_j_per_k <= 0.0) {
        return;
    }
    if (lump->resistance_k_per_w <= 0.0) {
        lump->temperature_c += heat_j / lump->capacity_j_per_k;
        return;
    }
    const double settled_c = ambient_c + lump->resistance_k_per_w * heat_j / lump->step_s;
    lump->temperature_c = settled_c + (lump->temperature_c - settled_c) * lump->decay;
}

/* SPDX-License-Identifier: Apache-2.0 */
#include "plant/battery.h"

#include <math.h>

static const double AS_PER_AH = 3600.0;

battery_state_t battery_init(const battery_params_t *params, double step_s)
{
    const double tau_s = params->polarisation_resistance_ohm * params->polarisation_capacitance_f;
    const double ratio = tau_s > 0.0 ? step_s / tau_s : INFINITY;
    const battery_state_t out = {
        .soc = params->initial_soc,
        .polarisation_v = 0.0,
        .terminal_v = curve_at(&params->open_circuit_voltage_v, params->initial_soc),
        .current_a = 0.0,
        .collapsed = false,
        .step_s = step_s,
        .decay = exp(-ratio),
        .mean_decay = tau_s > 0.0 ? -expm1(-ratio) / ratio : 0.0,
    };
    return out;
}

battery_source_t battery_source(const battery_params_t *params, const battery_state_t *state)
{
    /* Mean of u_c over the step: i R_t (1 - mean_decay) + u_c mean_decay. */
    const double cells_v = curve_at(&params->open_circuit_voltage_v, state->soc);
    const battery_source_t out = {
        .open_v = cells_v - state->polarisation_v * state->mean_decay,
        .resistance_ohm = params->series_resistance_ohm +
                          params->polarisation_resistance_ohm * (1.0 - state->mean_decay),
        .cells_v = cells_v,
    };
    return out;
}

double battery_current_a(double open_v, double resistance_ohm, double power_w, bool *collapsed)
{
    const double square = open_v * open_v - 4.0 * resistance_ohm * power_w;
    *collapsed = *collapsed || square < 0.0;
    return square >= 0.0 ? 2.0 * power_w / (open_v + sqrt(square))
                         : open_v / (2.0 * resistance_ohm);
}

battery_flow_t battery_carry(const battery_params_t *params, battery_state_t *state,
                             const battery_source_t *source, double current_a)
{
    const double i = current_a;
    const double charge_as = i * state->step_s;
    const double stored_before_j = battery_stored_j(params, state);
    const double settled_v = i * params->polarisation_resistance_ohm;
    const double mean_polarisation_v =
        settled_v * (1.0 - state->mean_decay) + state->polarisation_v * state->mean_decay;
    state->polarisation_v = settled_v * (1.0 - state->decay) + state->polarisation_v * state->decay;
    state->soc -= charge_as / (params->capacity_ah * AS_PER_AH);
    state->current_a = i;
    state->terminal_v = source->open_v - source->resistance_ohm * i;
    const battery_flow_t out = {
        .chemical_j = source->cells_v * charge_as,
        .terminal_j = state->terminal_v * charge_as,
        .heat_j = (params->series_resistance_ohm * i + mean_polarisation_v) * charge_as -
                  (battery_stored_j(params, state) - stored_before_j),
    };
    return out;
}

battery_flow_t battery_step(const battery_params_t *params, battery_state_t *state,
                            double terminal_j)
{
    const battery_source_t source = battery_source(params, state);
    const double power_w = terminal_j * (1.0 / state->step_s);
    return battery_carry(
        params, state, &source,
        battery_current_a(source.open_v, source.resistance_ohm, power_w, &state->collapsed));
}

double battery_stored_j(const battery_params_t *params, const battery_state_t *state)
{
    return 0.5 * params->polarisation_capacitance_f * state->polarisation_v * state->polarisation_v;
}

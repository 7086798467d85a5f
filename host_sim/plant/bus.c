/* SPDX-License-Identifier: Apache-2.0 */
#include "plant/bus.h"

#include <math.h>

#include "plant/numbers.h"

static const double OPEN = 0.5; /* a switch given as a number */
/* Energy flows into a capacitor in proportion to its voltage: from none at all it never would. */
static const double EMPTY_V = 0.1;

bus_state_t bus_init(const battery_state_t *battery)
{
    const bus_state_t out = {.voltage_v = battery->terminal_v, .collapsed = false};
    return out;
}

double bus_stored_j(const bus_params_t *params, const bus_state_t *state)
{
    return 0.5 * params->capacitance_f * state->voltage_v * state->voltage_v;
}

static bus_flow_t without_capacitor(const bus_params_t *params, bus_state_t *state,
                                    const battery_params_t *battery_params,
                                    battery_state_t *battery, double dc_j)
{
    const battery_source_t source = battery_source(battery_params, battery);
    const double cable_ohm = params->cable_resistance_ohm;
    const double i = battery_current_a(source.open_v, source.resistance_ohm + cable_ohm,
                                       dc_j * (1.0 / battery->step_s), &battery->collapsed);
    const bus_flow_t out = {
        .battery = battery_carry(battery_params, battery, &source, i),
        .cable_j = cable_ohm * i * i * battery->step_s,
    };
    state->voltage_v = battery->terminal_v - cable_ohm * i;
    return out;
}

static bus_flow_t disconnected(const bus_params_t *params, bus_state_t *state,
                               const battery_params_t *battery_params, battery_state_t *battery,
                               double dc_j)
{
    const double square = state->voltage_v * state->voltage_v - 2.0 * dc_j / params->capacitance_f;
    state->voltage_v = sqrt(plant_max(square, EMPTY_V * EMPTY_V));
    const battery_source_t source = battery_source(battery_params, battery);
    const double missing_v2 = plant_min(square - EMPTY_V * EMPTY_V, 0.0);
    const bus_flow_t out = {.battery = battery_carry(battery_params, battery, &source, 0.0),
                            .cable_j = 0.5 * params->capacitance_f * missing_v2};
    return out;
}

bus_flow_t bus_step(const bus_params_t *params, bus_state_t *state,
                    const battery_params_t *battery_params, battery_state_t *battery, double dc_j)
{
    if (params->capacitance_f <= 0.0) {
        return without_capacitor(params, state, battery_params, battery, dc_j);
    }
    if (params->contactor_open > OPEN) {
        return disconnected(params, state, battery_params, battery, dc_j);
    }
    const double h = battery->step_s;
    const double c = params->capacitance_f;
    const battery_source_t source = battery_source(battery_params, battery);
    const double r = source.resistance_ohm + params->cable_resistance_ohm;
    const double ratio = r > 0.0 ? h / (r * c) : INFINITY;
    const double decay = exp(-ratio);
    const double mean_decay = r > 0.0 ? -expm1(-ratio) / ratio : 0.0;
    const double before = state->voltage_v;

    /* Mean of v: (E - R i)(1 - m) + v0 m, and i = P / mean: the same quadratic as a source with
     * another resistance. */
    const double open_v = source.open_v * (1.0 - mean_decay) + before * mean_decay;
    const double resistance_ohm = r * (1.0 - mean_decay);
    const double i = battery_current_a(open_v, resistance_ohm, dc_j / h, &state->collapsed);
    const double mean_v = open_v - resistance_ohm * i;
    const double settled_v = source.open_v - r * i;
    state->voltage_v = settled_v + (before - settled_v) * decay;

    const double pack_a = i + c * (state->voltage_v - before) / h;
    const double stored_j = 0.5 * c * (state->voltage_v * state->voltage_v - before * before);
    bus_flow_t out = {.battery = battery_carry(battery_params, battery, &source, pack_a)};
    /* Resistances heat by the mean square of the pack's current: more than battery_carry() counts
     * for its mean. */
    const double heat_j = source.open_v * pack_a * h - mean_v * i * h - stored_j;
    const double beyond_mean_j = heat_j - r * pack_a * pack_a * h;
    const double pack_ohm = battery_params->series_resistance_ohm;
    const double series_ohm = pack_ohm + params->cable_resistance_ohm;
    const double pack_share = series_ohm > 0.0 ? pack_ohm / series_ohm : 1.0;
    out.battery.heat_j += beyond_mean_j * pack_share;
    out.battery.terminal_j -= beyond_mean_j * pack_share;
    out.cable_j =
        params->cable_resistance_ohm * pack_a * pack_a * h + beyond_mean_j * (1.0 - pack_share);
    return out;
}

/* SPDX-License-Identifier: Apache-2.0 */
#include "plant/bms.h"

#include <math.h>

#include "plant/numbers.h"

static const double SILENT = 0.5;      /* a switch given as a number */
static const double STEP_S = 1e-3;     /* of a slow step */
static const double ROUNDING_S = 1e-9; /* times are added up elsewhere */

static double faded(double left_soc, double fade_soc)
{
    if (fade_soc > 0.0) {
        return plant_clamp(left_soc / fade_soc, 0.0, 1.0);
    }
    return left_soc > 0.0 ? 1.0 : 0.0;
}

static double warm_share(const bms_params_t *params)
{
    const double range_k = params->full_charge_c - params->coldest_charge_c;
    return range_k > 0.0
               ? plant_clamp((params->temperature_c - params->coldest_charge_c) / range_k, 0.0, 1.0)
               : 1.0;
}

/* Current that takes the settled terminal voltage to its end. */
static double to_voltage(double end_v, double left_v, double resistance_ohm)
{
    if (end_v <= 0.0) {
        return INFINITY;
    }
    return left_v > 0.0 ? left_v / resistance_ohm : 0.0;
}

static double in_steps(double current_a, double step_a)
{
    return step_a > 0.0 ? step_a * floor(current_a / step_a) : current_a;
}

bms_limits_t bms_limits(const bms_params_t *params, const battery_params_t *pack,
                        const battery_state_t *battery)
{
    const double open_v = curve_at(&pack->open_circuit_voltage_v, battery->soc);
    const double settled_ohm = pack->series_resistance_ohm + pack->polarisation_resistance_ohm;
    const double charge_a = pack->max_charge_current_a *
                            faded(1.0 - battery->soc, params->fade_soc) * warm_share(params);
    const double discharge_a =
        pack->max_discharge_current_a * faded(battery->soc, params->fade_soc);
    const double full_a =
        to_voltage(params->max_voltage_v, params->max_voltage_v - open_v, settled_ohm);
    const double empty_a =
        to_voltage(params->min_voltage_v, open_v - params->min_voltage_v, settled_ohm);
    const bms_limits_t out = {
        .charge_a = in_steps(plant_min(charge_a, full_a), params->current_step_a),
        .discharge_a = in_steps(plant_min(discharge_a, empty_a), params->current_step_a),
        .peak_charge_a = in_steps(params->peak_charge_a, params->current_step_a),
    };
    return out;
}

static double measured_a(const bms_params_t *params, bms_state_t *state)
{
    const double noise_a = params->current_noise_a > 0.0
                               ? params->current_noise_a * random_gaussian(&state->random)
                               : 0.0;
    return (1.0 + params->current_error) * state->filtered_a + params->current_offset_a + noise_a;
}

bms_limits_t bms_step(const bms_params_t *params, bms_state_t *state, const battery_params_t *pack,
                      const battery_state_t *battery, bool contactor_open, double time_s)
{
    state->filtered_a +=
        (battery->current_a - state->filtered_a) / (1.0 + params->current_filter_s / STEP_S);
    if (time_s + ROUNDING_S >= state->next_s) {
        state->sent = bms_limits(params, pack, battery);
        state->sent.voltage_v = params->voltage_silent > SILENT ? 0.0 : battery->terminal_v;
        state->sent.current_given = params->current_silent <= SILENT;
        state->sent.current_a = measured_a(params, state);
        state->contactor = params->contactor_silent > SILENT ? BMS_NOT_REPORTED
                           : contactor_open                  ? BMS_OPEN
                                                             : BMS_CLOSED;
        state->next_s = time_s + params->period_s;
    }
    return state->sent;
}

/* SPDX-License-Identifier: Apache-2.0 */
#include "plant/hydraulic_brake.h"

#include <math.h>

#include "plant/numbers.h"

static const double ARRIVED_NM = 1e-12;

hydraulic_brake_state_t hydraulic_brake_init(const hydraulic_brake_params_t *params, double step_s)
{
    hydraulic_brake_state_t out = {
        .torque_nm = 0.0,
        .delay_ms = (int)lround(
            plant_min(params->hydraulic_dead_time_s * 1e3, HYDRAULIC_BRAKE_DELAY_MS_MAX)),
    };
    hydraulic_brake_refresh(params, &out, 0.0, step_s);
    return out;
}

void hydraulic_brake_refresh(const hydraulic_brake_params_t *params, hydraulic_brake_state_t *state,
                             double torque_loss, double step_s)
{
    const double tau_s = params->hydraulic_time_constant_s;
    state->approach = tau_s > 0.0 ? -expm1(-step_s / tau_s) : 1.0;
    state->largest_change_nm = params->hydraulic_rate_nm_per_s * step_s;
    state->knee_nm = params->knee_torque_nm;
    state->knee_rise_nm = plant_min(params->knee_rate_nm_per_s * step_s, state->largest_change_nm);
    state->gain = (1.0 - params->torque_loss) * (1.0 - torque_loss);
}

void hydraulic_brake_command(const hydraulic_brake_params_t *params, hydraulic_brake_state_t *state,
                             double command_nm)
{
    const int length = state->delay_ms + 1;
    state->commands_nm[state->next] = plant_clamp(command_nm, 0.0, params->max_hydraulic_torque_nm);
    state->next = state->next + 1 == length ? 0 : state->next + 1;
    state->target_nm = state->commands_nm[state->next];
}

void hydraulic_brake_valve(hydraulic_brake_state_t *state, hydraulic_valve_t valve,
                           double build_nm_per_s, double dump_nm_per_s, double step_s)
{
    state->valve = valve;
    state->build_nm = build_nm_per_s * step_s;
    state->dump_nm = dump_nm_per_s * step_s;
}

static double limited_by_valve(const hydraulic_brake_state_t *state, double change_nm)
{
    switch (state->valve) {
    case HYDRAULIC_VALVE_OPEN:
        break;
    case HYDRAULIC_VALVE_BUILD:
        return plant_min(change_nm, state->build_nm);
    case HYDRAULIC_VALVE_HOLD:
        return plant_min(change_nm, 0.0);
    case HYDRAULIC_VALVE_DUMP:
        return plant_min(change_nm, -plant_min(state->dump_nm, state->torque_nm));
    }
    return change_nm;
}

double hydraulic_brake_step(hydraulic_brake_state_t *state)
{
    const double left_nm = state->target_nm - state->torque_nm;
    if (left_nm == 0.0 && state->valve == HYDRAULIC_VALVE_OPEN) {
        return state->torque_nm * state->gain;
    }
    /* A lag never arrives: its last steps would be too small for full speed (subnormal numbers). */
    const double wanted_nm = fabs(left_nm) > ARRIVED_NM ? left_nm * state->approach : left_nm;
    const double largest_rise_nm =
        state->torque_nm < state->knee_nm ? state->knee_rise_nm : state->largest_change_nm;
    const double change_nm = plant_clamp(wanted_nm, -state->largest_change_nm, largest_rise_nm);
    state->torque_nm +=
        state->valve == HYDRAULIC_VALVE_OPEN ? change_nm : limited_by_valve(state, change_nm);
    return state->torque_nm * state->gain;
}

/* SPDX-License-Identifier: Apache-2.0 */
#include "bench/driver.h"

#include <math.h>

#include "plant/numbers.h"

static const double LEAST_m_per_s2 = 0.1; /* a deceleration whose end is hardly felt */

driver_state_t driver_init(void)
{
    const driver_state_t out = {.integral_m = 0.0, .braked_n = 0.0, .cursor = 0};
    return out;
}

bool driver_resets(const driver_params_t *params, double time_s)
{
    const double every_s = params->fault_reset_every_s;
    return every_s > 0.0 && fmod(time_s, every_s) < every_s / 2.0;
}

double driver_trace_at(const driver_trace_t *trace, int *cursor, double time_s)
{
    if (trace->points == 0) {
        return 0.0;
    }
    const int last = trace->points - 1;
    int k = *cursor;
    while (k < last && trace->time_s[k + 1] <= time_s) {
        k++;
    }
    *cursor = k;
    if (k == last || time_s <= trace->time_s[k]) {
        return trace->speed_m_per_s[k];
    }
    const double share = (time_s - trace->time_s[k]) / (trace->time_s[k + 1] - trace->time_s[k]);
    return trace->speed_m_per_s[k] +
           share * (trace->speed_m_per_s[k + 1] - trace->speed_m_per_s[k]);
}

static driver_demand_t constant_pedals(const driver_params_t *params, double reference_m_per_s)
{
    const driver_demand_t out = {
        .drive_nm = params->drive_demand_nm,
        .brake_nm = params->brake_demand_nm,
        .reference_m_per_s = reference_m_per_s,
    };
    return out;
}

/* A standing vehicle that is to stay so: the brake pedal holds the slope, with half as much again
 * to be sure. */
static driver_demand_t standing(const driver_params_t *params, const vehicle_t *vehicle,
                                int driven_wheels)
{
    const double hold_nm = 1.5 * fabs(vehicle->slope_n) * vehicle->wheel_radius_m / driven_wheels;
    const driver_demand_t out = {.drive_nm = 0.0,
                                 .brake_nm = plant_min(hold_nm, params->most_brake_nm),
                                 .reference_m_per_s = 0.0};
    return out;
}

/* Of the braking force beyond the slope's pull, as it was when the release began, what is left at
 * this speed. */
static double eased_n(const driver_params_t *params, driver_state_t *state,
                      const vehicle_t *vehicle, double force_n, double speed_m_per_s)
{
    if (state->braked_n == 0.0) {
        state->braked_n = plant_max(vehicle->slope_n - force_n, 0.0);
    }
    const double least_n = LEAST_m_per_s2 * vehicle->mass_kg - vehicle->rolling_n;
    const double left_n = state->braked_n * speed_m_per_s / params->release_speed_m_per_s;
    return plant_min(vehicle->slope_n - plant_max(left_n, plant_max(least_n, 0.0)), 0.0);
}

driver_demand_t driver_step(const driver_params_t *params, driver_state_t *state,
                            const driver_trace_t *trace, const vehicle_t *vehicle,
                            int driven_wheels, double speed_m_per_s, double time_s, double step_s)
{
    const double reference = driver_trace_at(trace, &state->cursor, time_s);
    if (params->follow_trace < 0.5) {
        return constant_pedals(params, speed_m_per_s);
    }
    int ahead_cursor = state->cursor;
    const double ahead = driver_trace_at(trace, &ahead_cursor, time_s + params->preview_s);
    const bool stays_still = reference <= 0.0 && ahead <= 0.0;
    if (stays_still && speed_m_per_s == 0.0) {
        state->integral_m = 0.0;
        state->braked_n = 0.0;
        return standing(params, vehicle, driven_wheels);
    }
    const double error = reference - speed_m_per_s;
    const double w_b = params->bandwidth_rad_per_s;
    /* No feed-forward of rolling resistance for a vehicle that must come to rest. */
    const double rolling_n = stays_still ? 0.0 : vehicle->rolling_n;
    const double known_n = vehicle->mass_kg * (ahead - reference) / params->preview_s +
                           vehicle_drag_n(vehicle, reference) + rolling_n + vehicle->slope_n;
    const double wanted_n =
        known_n +
        vehicle->mass_kg * w_b * (2.0 * error + w_b * (state->integral_m + error * step_s));
    const double torque_per_n = vehicle->wheel_radius_m / driven_wheels;
    const double torque_nm =
        plant_clamp(wanted_n * torque_per_n, -params->most_brake_nm, params->most_drive_nm);
    if (torque_nm == wanted_n * torque_per_n) {
        state->integral_m += error * step_s;
    }
    const double release = params->release_speed_m_per_s;
    const bool eases = ahead <= reference && reference < release && speed_m_per_s < release &&
                       speed_m_per_s > 0.0 && torque_nm < 0.0;
    state->braked_n = eases ? state->braked_n : 0.0;
    const double force_n = torque_nm / torque_per_n;
    const double pedal_nm =
        eases ? torque_per_n * eased_n(params, state, vehicle, force_n, speed_m_per_s) : torque_nm;
    const driver_demand_t out = {.drive_nm = plant_max(pedal_nm, 0.0),
                                 .brake_nm = plant_max(-pedal_nm, 0.0),
                                 .reference_m_per_s = reference};
    return out;
}

/* SPDX-License-Identifier: Apache-2.0 */
#include "plant/vehicle.h"

#include <math.h>

#include "plant/numbers.h"

vehicle_t vehicle_on_road(const vehicle_params_t *params, const road_params_t *road)
{
    /* The slope is the tangent of the road's angle. */
    const double cosine = 1.0 / sqrt(1.0 + road->slope * road->slope);
    const double weight_n = params->mass_kg * road->gravity_m_per_s2;
    const vehicle_t out = {
        .mass_kg = params->mass_kg,
        .wheel_radius_m = params->wheel_radius_m,
        .drag_n_s2_per_m2 =
            0.5 * road->air_density_kg_per_m3 * params->drag_coefficient * params->frontal_area_m2,
        .wind_m_per_s = road->wind_m_per_s,
        .rolling_n = params->rolling_resistance * weight_n * cosine,
        .weight_n = weight_n * cosine,
        .slope_n = weight_n * road->slope * cosine,
        .rise = road->slope * cosine,
        .per_mass_1_per_kg = 1.0 / params->mass_kg,
        .per_radius_1_per_m = 1.0 / params->wheel_radius_m,
    };
    return out;
}

double vehicle_drag_n(const vehicle_t *vehicle, double speed_m_per_s)
{
    const double against_air = speed_m_per_s + vehicle->wind_m_per_s;
    return vehicle->drag_n_s2_per_m2 * against_air * fabs(against_air);
}

vehicle_flow_t vehicle_step(const vehicle_t *vehicle, vehicle_state_t *state,
                            const vehicle_load_t *load, double step_s)
{
    const double per_step_hz = 1.0 / step_s; /* divided first: no division waits for the torque */
    const double before = state->speed_m_per_s;
    const double drag_n = vehicle_drag_n(vehicle, vehicle_expected_speed_m_per_s(state, step_s));
    const double capacity_n =
        vehicle->rolling_n + load->friction_capacity_nm * vehicle->per_radius_1_per_m;

    const double impulse_ns = load->torque_impulse_nms * vehicle->per_radius_1_per_m -
                              (drag_n + vehicle->slope_n) * step_s;
    const double unhindered = before + impulse_ns * vehicle->per_mass_1_per_kg;
    const double most_ns = capacity_n * step_s;
    const double to_stand_ns = -unhindered * vehicle->mass_kg;
    const double friction_ns = plant_clamp(to_stand_ns, -most_ns, most_ns);
    const double after =
        friction_ns == to_stand_ns ? 0.0 : unhindered + friction_ns * vehicle->per_mass_1_per_kg;
    const double mean = 0.5 * (before + after);
    const double way_m = mean * step_s;

    state->speed_m_per_s = after;
    state->acceleration_m_per_s2 = (after - before) * per_step_hz;
    state->distance_m += way_m;
    state->height_m += way_m * vehicle->rise;
    const double used = most_ns > 0.0 ? -friction_ns / most_ns : 0.0;
    const vehicle_flow_t out = {
        .mean_speed_m_per_s = mean,
        .friction_used = used,
        .drag_j = drag_n * way_m,
        .rolling_j = vehicle->rolling_n * used * way_m,
        .climbed_j = vehicle->slope_n * way_m,
    };
    return out;
}

double vehicle_expected_speed_m_per_s(const vehicle_state_t *state, double step_s)
{
    return state->speed_m_per_s + 0.5 * state->acceleration_m_per_s2 * step_s;
}

double vehicle_kinetic_energy_j(const vehicle_t *vehicle, const vehicle_state_t *state)
{
    return 0.5 * vehicle->mass_kg * state->speed_m_per_s * state->speed_m_per_s;
}

/* SPDX-License-Identifier: Apache-2.0 */
#include "plant/chassis.h"

#include <math.h>

#include "plant/numbers.h"

chassis_t chassis_on_road(const chassis_params_t *params, double mass_kg, double weight_n,
                          double slope_n, double step_s)
{
    const double tau_s = params->pitch_time_constant_s;
    const int per_axle = (int)plant_max(floor(params->wheels_per_axle), 1.0);
    const chassis_t out = {
        .weight_n = weight_n,
        .front_share = params->front_load_share,
        .transfer_kg = params->wheelbase_m > 0.0
                           ? mass_kg * params->centre_of_gravity_height_m / params->wheelbase_m
                           : 0.0,
        .slope_m_per_s2 = slope_n / mass_kg,
        .approach = tau_s > 0.0 ? -expm1(-step_s / tau_s) : 1.0,
        .wheels_per_axle = per_axle,
        .first_rear = params->rear_driven > 0.5 ? 0 : per_axle,
    };
    return out;
}

void chassis_step(const chassis_t *chassis, chassis_state_t *state, double acceleration_m_per_s2)
{
    state->filtered_m_per_s2 +=
        (acceleration_m_per_s2 - state->filtered_m_per_s2) * chassis->approach;
}

double chassis_load_n(const chassis_t *chassis, const chassis_state_t *state, int wheel)
{
    const double transferred_n =
        chassis->transfer_kg * (state->filtered_m_per_s2 + chassis->slope_m_per_s2);
    const double front_n = plant_clamp(chassis->weight_n * chassis->front_share - transferred_n,
                                       0.0, chassis->weight_n);
    const double axle_n = wheel < chassis->first_rear ? front_n : chassis->weight_n - front_n;
    return axle_n / chassis->wheels_per_axle;
}

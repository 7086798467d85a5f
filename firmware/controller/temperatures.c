/* SPDX-License-Identifier: Apache-2.0 */
#include "controller/temperatures.h"

void temperatures_init(temperatures_t *state, const config_t *config)
{
    thermal_model_init(&state->model, config);
    monitor_temperature_init(&state->winding_sensor);
    monitor_temperature_init(&state->switch_sensor);
}

/* A sensor on the switches may sit on their heat sink. */
void temperatures_step(temperatures_t *state, const config_t *config,
                       const wheel_temperatures_t *shown, measured_t *now)
{
    thermal_model_state_t *const model = &state->model;
    if (!model->started) {
        thermal_model_start(model, config, shown->winding_cC,
                            monitor_temperature_outside(config, shown->winding_cC),
                            shown->switch_cC,
                            monitor_temperature_outside(config, shown->switch_cC));
    }
    const int32_t winding_cC = thermal_model_inner_cC(&model->winding);
    const monitor_temperature_input_t winding = {
        .measured_cC = shown->winding_cC,
        .estimate_cC = winding_cC,
        .slowest_cC = winding_cC,
        .estimated = model->winding.known,
        .limit_cC = config->motor.max_winding_temperature_cC,
    };
    const monitor_temperature_output_t of_winding =
        monitor_temperature_step(&state->winding_sensor, config, &winding);
    const monitor_temperature_input_t switches = {
        .measured_cC = shown->switch_cC,
        .estimate_cC = thermal_model_inner_cC(&model->switches),
        .slowest_cC = thermal_model_outer_cC(&model->switches),
        .estimated = model->switches.known,
        .limit_cC = config->drive.max_switch_temperature_cC,
    };
    const monitor_temperature_output_t of_switches =
        monitor_temperature_step(&state->switch_sensor, config, &switches);
    now->winding_temperature_cC = of_winding.used_cC;
    now->switch_temperature_cC = of_switches.used_cC;
    now->winding_sensor_broken = of_winding.broken;
    now->switch_sensor_broken = of_switches.broken;
    thermal_model_step(model, config, now->i_d_mA, now->i_q_mA, now->speed_mrad_s);
}

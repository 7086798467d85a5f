/* SPDX-License-Identifier: Apache-2.0 */
#include "controller/temperatures.h"

void temperatures_init(temperatures_t *state, const config_t *config)
{
    thermal_model_init(&state->model, config);
    monitor_temperature_init(&state->winding_sensor);
    monitor_temperature_init(&state->switch_sensor);
    const wheel_temperatures_t reference = {.winding_cC = config->motor.reference_temperature_cC,
                                            .switch_cC = config->motor.reference_temperature_cC};
    state->used = reference;
    state->winding_broken = false;
    state->switch_broken = false;
}

/* A sensor on the switches may sit on their heat sink. */
void temperatures_step(temperatures_t *state, const config_t *config,
                       const wheel_temperatures_t *measured, const operating_point_t *at)
{
    thermal_model_state_t *const model = &state->model;
    if (!model->started) {
        thermal_model_start(model, config, measured->winding_cC,
                            monitor_temperature_outside(config, measured->winding_cC),
                            measured->switch_cC,
                            monitor_temperature_outside(config, measured->switch_cC));
    }
    const int32_t winding_cC = thermal_model_inner_cC(&model->winding);
    const monitor_temperature_input_t winding = {
        .measured_cC = measured->winding_cC,
        .estimate_cC = winding_cC,
        .slowest_cC = winding_cC,
        .estimated = model->winding.known,
        .limit_cC = config->motor.max_winding_temperature_cC,
    };
    const monitor_temperature_output_t of_winding =
        monitor_temperature_step(&state->winding_sensor, config, &winding);
    const monitor_temperature_input_t switches = {
        .measured_cC = measured->switch_cC,
        .estimate_cC = thermal_model_inner_cC(&model->switches),
        .slowest_cC = thermal_model_outer_cC(&model->switches),
        .estimated = model->switches.known,
        .limit_cC = config->drive.max_switch_temperature_cC,
    };
    const monitor_temperature_output_t of_switches =
        monitor_temperature_step(&state->switch_sensor, config, &switches);
    state->used.winding_cC = of_winding.used_cC;
    state->used.switch_cC = of_switches.used_cC;
    state->winding_broken = of_winding.broken;
    state->switch_broken = of_switches.broken;
    thermal_model_step(model, config, at->i_d_mA, at->i_q_mA, at->speed_mrad_s);
}

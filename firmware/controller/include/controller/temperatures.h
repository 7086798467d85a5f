/* SPDX-License-Identifier: Apache-2.0 */
/*
 * temperatures.h: the temperatures the controller uses: what the sensors show, or where one is
 * broken or stuck an estimate from the losses. Slow loop, 1 kHz.
 */
#ifndef CONTROLLER_TEMPERATURES_H
#define CONTROLLER_TEMPERATURES_H

#include <stdbool.h>
#include <stdint.h>

#include "config/config.h"
#include "controller/operating_point.h"
#include "core/slow_messages.h"
#include "monitor/monitor_temperature.h"
#include "torque/thermal_model.h"

typedef struct {
    thermal_model_state_t model;
    monitor_temperature_state_t winding_sensor, switch_sensor;
    wheel_temperatures_t used; /* of the latest step; before the first the reference temperature */
    bool winding_broken, switch_broken;
} temperatures_t;

/* Divides; once at start.
 *
 * @post !state->winding_broken && !state->switch_broken && !state->model.started
 *
 * @post state->used.winding_cC == config->motor.reference_temperature_cC && state->used.switch_cC
 * == config->motor.reference_temperature_cC
 *
 * @post !state->winding_sensor.started && !state->switch_sensor.started
 *
 * @post temperatures_hold(state)
 */
void temperatures_init(temperatures_t *state, const config_t *config);

/* Sets state->used and what is broken. at: of this millisecond, for the losses.
 *
 * @pre is_within(measured->winding_cC, -100000, 100000) && is_within(measured->switch_cC, -100000,
 * 100000)
 *
 * @pre temperatures_hold(state)
 *
 * @post temperatures_hold(state) && state->model.started
 *
 * @post config->motor.max_winding_temperature_cC < 30000 || (!state->winding_broken &&
 * state->used.winding_cC == measured->winding_cC)
 *
 * @post !is_within(measured->winding_cC, config->monitor.lowest_temperature_cC,
 * config->monitor.highest_temperature_cC) || state->used.winding_cC >= measured->winding_cC
 *
 * @post state->model.winding.known || state->used.winding_cC >= measured->winding_cC ||
 * state->used.winding_cC == MONITOR_TEMPERATURE_BROKEN_cC
 *
 * @post state->model.switches.known || state->used.switch_cC >= measured->switch_cC ||
 * state->used.switch_cC == MONITOR_TEMPERATURE_BROKEN_cC
 */
void temperatures_step(temperatures_t *state, const config_t *config,
                       const wheel_temperatures_t *measured, const operating_point_t *at);

#endif

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
#include "motor/thermal_model.h"

typedef struct {
    thermal_model_state_t model;
    monitor_temperature_state_t winding_sensor, switch_sensor;
    wheel_temperatures_t used; /* of the latest step; before the first the reference temperature */
    bool winding_broken, switch_broken;
} temperatures_t;

/* Divides; once at start. */
void temperatures_init(temperatures_t *state, const config_t *config);

/* Sets state->used and what is broken. at: of this millisecond, for the losses. */
void temperatures_step(temperatures_t *state, const config_t *config,
                       const wheel_temperatures_t *measured, const operating_point_t *at);

#endif

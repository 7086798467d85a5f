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
#include "core/measured.h"
#include "core/slow_messages.h"
#include "monitor/monitor_temperature.h"
#include "motor/thermal_model.h"

typedef struct {
    thermal_model_state_t model;
    monitor_temperature_state_t winding_sensor, switch_sensor;
} temperatures_t;

/* Divides; once at start. */
void temperatures_init(temperatures_t *state, const config_t *config);

/* Writes the temperatures of now and whether a sensor is broken; it has this millisecond's currents
 * and speed already. shown: by the sensors, -1000 .. 1000 degC; the estimate is used where one is
 * broken, the hotter of both where it is stuck. motor/DERIVATIONS.md, Thermal model. */
void temperatures_step(temperatures_t *state, const config_t *config,
                       const wheel_temperatures_t *shown, measured_t *now);

#endif

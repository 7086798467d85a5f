/* SPDX-License-Identifier: Apache-2.0 */
#include "plant/temperature_sensor.h"

#include <math.h>

const double TEMPERATURE_SENSOR_BROKEN_C = 299.99;

temperature_sensor_t temperature_sensor_at(double temperature_c)
{
    const temperature_sensor_t out = {.sensor_c = temperature_c, .reported_c = temperature_c};
    return out;
}

double temperature_sensor_step(const winding_sensor_params_t *params, temperature_sensor_t *sensor,
                               double temperature_c, bool broken, double step_s)
{
    if (params->lag_s > 0.0) {
        sensor->sensor_c += (temperature_c - sensor->sensor_c) * -expm1(-step_s / params->lag_s);
    } else {
        sensor->sensor_c = temperature_c;
    }
    if (params->stuck > 0.5) {
        return sensor->reported_c;
    }
    const bool lost = broken || params->open > 0.5 || params->shorted > 0.5;
    sensor->reported_c = lost ? TEMPERATURE_SENSOR_BROKEN_C
                              : sensor->sensor_c * (1.0 + params->gain_error) + params->offset_k;
    return sensor->reported_c;
}

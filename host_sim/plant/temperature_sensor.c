/* SPDX-License-Identifier: Apache-2.0 */
#include "plant/temperature_sensor.h"

#include <math.h>

const double TEMPERATURE_SENSOR_BROKEN_C = 299.99;

static double shown_c(const winding_sensor_params_t *params, const temperature_sensor_t *sensor)
{
    return sensor->sensor_c * (1.0 + params->gain_error) + params->offset_k;
}

static double resistance_ohm(const winding_sensor_params_t *params, double celsius)
{
    static const double REFERENCE_C = 25.0, ZERO_K = 273.15;
    if (params->kind < 1.5) {
        const double inverse = 1.0 / (celsius + ZERO_K) - 1.0 / (REFERENCE_C + ZERO_K);
        return params->ohm_25c * exp(params->beta_k * inverse);
    }
    const double above_k = celsius - REFERENCE_C;
    return params->ohm_25c *
           (1.0 + params->linear_per_k * above_k + params->square_per_k2 * above_k * above_k);
}

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
    sensor->reported_c = lost ? TEMPERATURE_SENSOR_BROKEN_C : shown_c(params, sensor);
    return sensor->reported_c;
}

int32_t temperature_sensor_code(const winding_sensor_params_t *params,
                                const temperature_sensor_t *sensor, bool broken)
{
    enum { CODES = 4096 };
    double of_sensor = 0.0; /* share of the supply across it */
    if (broken || params->open > 0.5) {
        of_sensor = 1.0;
    } else if (params->shorted < 0.5) {
        const double ohm = resistance_ohm(params, shown_c(params, sensor));
        of_sensor = ohm / (ohm + params->divider_ohm);
    }
    const double share = params->to_supply > 0.5 ? 1.0 - of_sensor : of_sensor;
    return (int32_t)fmin(share * CODES, CODES - 1.0);
}

/* SPDX-License-Identifier: Apache-2.0 */
/*
 * temperature_sensor.h: a thermistor on winding or switches: late, a little wrong, or broken.
 *
 *     tau dT_s/dt = T - T_s          reported = T_s (1 + gain error) + offset,  degrees Celsius
 *
 * An open or shorted line is outside the thermistor's range; a port then reports
 * TEMPERATURE_SENSOR_BROKEN_C, above any limit (as in hal/analog.h). A stuck sensor goes on
 * with its last plausible value. All parameters 0: the temperature itself.
 */
#ifndef PLANT_TEMPERATURE_SENSOR_H
#define PLANT_TEMPERATURE_SENSOR_H

#include <stdbool.h>

#include "plant/parameter.h"

/* clang-format off */
#define WINDING_SENSOR_PARAMETERS(X) \
    X(lag_s,       0.0,   1e3,   "s", "time constant of the sensor after the winding; 0: none") \
    X(offset_k,   -100.0, 100.0, "K", "reported over true") \
    X(gain_error, -0.5,   0.5,   "1", \
      "share of the temperature in degrees Celsius reported too much") \
    X(open,        0.0,   1.0,   "",  "1: the sensor's line is broken") \
    X(shorted,     0.0,   1.0,   "",  "1: the sensor's line is shorted") \
    X(stuck,       0.0,   1.0,   "",  "1: reports for ever what it reported last")
/* clang-format on */

typedef struct {
    WINDING_SENSOR_PARAMETERS(PLANT_PARAMETER_MEMBER)
} winding_sensor_params_t;

extern const double TEMPERATURE_SENSOR_BROKEN_C;

typedef struct {
    double sensor_c; /* of the sensor itself */
    double reported_c;
} temperature_sensor_t;

temperature_sensor_t temperature_sensor_at(double temperature_c);

/* broken: this sensor's own line is open or shorted. Returns what is reported. */
double temperature_sensor_step(const winding_sensor_params_t *params, temperature_sensor_t *sensor,
                               double temperature_c, bool broken, double step_s);

#endif

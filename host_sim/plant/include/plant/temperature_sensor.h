/* SPDX-License-Identifier: Apache-2.0 */
/*
 * temperature_sensor.h: a sensor on winding or switches: late, a little wrong, of another kind, or
 * broken.
 *
 *     tau dT_s/dt = T - T_s          shown = T_s (1 + gain error) + offset,  degrees Celsius
 *
 * kind 0: what is shown is reported, as by a port that converts without an error; an open or
 * shorted line as TEMPERATURE_SENSOR_BROKEN_C, above any limit (hal/analog_curve.h). Any other kind
 * is a resistance in a divider,
 *
 *     1  R = ohm_25c exp(beta_k (1/T - 1/298.15 K))       2  R = ohm_25c (1 + A (T - 25) + B (T -
 * 25)^2)
 *
 * whose code the controller converts by what it believes: temperature_sensor_code(). A stuck sensor
 * goes on with its last plausible value. All parameters 0: the temperature itself.
 */
#ifndef PLANT_TEMPERATURE_SENSOR_H
#define PLANT_TEMPERATURE_SENSOR_H

#include <stdbool.h>
#include <stdint.h>

#include "plant/parameter.h"

/* clang-format off */
#define WINDING_SENSOR_PARAMETERS(X) \
    X(lag_s,       0.0,   1e3,   "s", "time constant of the sensor after the winding; 0: none") \
    X(offset_k,   -100.0, 100.0, "K", "reported over true") \
    X(gain_error, -0.5,   0.5,   "1", \
      "share of the temperature in degrees Celsius reported too much") \
    X(open,        0.0,   1.0,   "",  "1: the sensor's line is broken") \
    X(shorted,     0.0,   1.0,   "",  "1: the sensor's line is shorted") \
    X(stuck,       0.0,   1.0,   "",  "1: reports for ever what it reported last") \
    X(kind,        0.0,   2.0,   "",  "0: no resistance, 1: NTC, 2: rising with temperature") \
    X(ohm_25c,     0.0,   1e6,   "ohm", "at 25 degC") \
    X(beta_k,      0.0,   1e4,   "K", "B of kind 1") \
    X(linear_per_k, 0.0,  0.1,   "1/K", "A of kind 2") \
    X(square_per_k2, -1e-4, 1e-4, "1/K2", "B of kind 2") \
    X(divider_ohm, 0.0,   1e6,   "ohm", "in series") \
    X(to_supply,   0.0,   1.0,   "",  "1: the sensor hangs on the supply, else on ground")
/* clang-format on */

typedef struct {
    WINDING_SENSOR_PARAMETERS(PLANT_PARAMETER_MEMBER)
} winding_sensor_params_t;

extern const double TEMPERATURE_SENSOR_BROKEN_C;

typedef struct {
    double sensor_c; /* of the sensor itself */
    double reported_c;
} temperature_sensor_t;

/* 12-bit code of its divider now; only of a kind other than 0. broken: as below. */
int32_t temperature_sensor_code(const winding_sensor_params_t *params,
                                const temperature_sensor_t *sensor, bool broken);

temperature_sensor_t temperature_sensor_at(double temperature_c);

/* broken: this sensor's own line is open or shorted. Returns what is reported. */
double temperature_sensor_step(const winding_sensor_params_t *params, temperature_sensor_t *sensor,
                               double temperature_c, bool broken, double step_s);

#endif

/* SPDX-License-Identifier: Apache-2.0 */
/*
 * brake_sensor.h: what a sensor of the hydraulic brake's torque reports to a controller.
 *
 * torque -> delay -> sampled every period -> gain, offset and noise of the sensor -> message
 *
 * 1 kHz. The message carries a flag that says whether the sensor takes its own value for plausible;
 * a sensor that is stuck does not know it. Delay and period are rounded to whole milliseconds.
 */
#ifndef PLANT_BRAKE_SENSOR_H
#define PLANT_BRAKE_SENSOR_H

#include <stdbool.h>

#include "plant/parameter.h"
#include "plant/random.h"

/* clang-format off */
#define BRAKE_SENSOR_PARAMETERS(X) \
    X(fitted,      0.0,  1.0,  "",    "1: each wheel's hydraulic torque is measured and reported") \
    X(period_s,    0.0,  1.0,  "s",   "of the message; 0: every millisecond") \
    X(delay_s,     0.0,  0.5,  "s",   "from the torque to the message that reports it") \
    X(gain_error, -1.0,  1.0,  "1",   "share by which the sensor shows too much") \
    X(offset_nm,  -1e5,  1e5,  "N m", "added to what it shows") \
    X(noise_nm,    0.0,  1e5,  "N m", "standard deviation") \
    X(stuck,       0.0,  1.0,  "",    "1: it goes on showing what it showed last") \
    X(invalid,     0.0,  1.0,  "",    "1: it says that its value is not plausible") \
    X(silent,      0.0,  1.0,  "",    "1: no more messages")
/* clang-format on */

typedef struct {
    BRAKE_SENSOR_PARAMETERS(PLANT_PARAMETER_MEMBER)
} brake_sensor_params_t;

enum { BRAKE_SENSOR_DELAY_MS_MAX = 500 };

/* The last message, and how many milliseconds ago it came. */
typedef struct {
    double torque_nm;
    int age_ms;
    bool valid; /* as the sensor says; false before the first message */
} brake_sensor_report_t;

typedef struct {
    double torques_nm[BRAKE_SENSOR_DELAY_MS_MAX + 1]; /* of the last milliseconds */
    int next;
    int due_ms; /* until the next message */
    double shown_nm;
    random_t random; /* its noise; drawn from only where there is some */
    brake_sensor_report_t report;
} brake_sensor_state_t;

/* random: of this sensor alone. */
brake_sensor_state_t brake_sensor_init(random_t random);

/* One millisecond with the brake's torque now. */
brake_sensor_report_t brake_sensor_step(const brake_sensor_params_t *params,
                                        brake_sensor_state_t *state, double torque_nm);

#endif

/* SPDX-License-Identifier: Apache-2.0 */
/*
 * pedal_sensors.h: voltages of the sensors of accelerator and brake pedal, as ratios of their
 * supply. Two channels each, straight lines over the travel of the pedal.
 *
 * A channel that is open lies at ground, where the board's resistor pulls it.
 */
#ifndef PLANT_PEDAL_SENSORS_H
#define PLANT_PEDAL_SENSORS_H

#include "plant/parameter.h"

/* clang-format off */
#define PEDAL_CHANNEL_PARAMETERS(X, channel) \
    X(channel##_released,  0.0, 1.0, "1", "ratio at 0 % of the travel") \
    X(channel##_pressed,   0.0, 1.0, "1", "ratio at 100 % of the travel") \
    X(channel##_offset,   -1.0, 1.0, "1", "added to the ratio: a drifted sensor") \
    X(channel##_broken,    0.0, 2.0, "",  "0 healthy, 1 open or at ground, 2 at the supply")
#define PEDAL_SENSORS_PARAMETERS(X) \
    PEDAL_CHANNEL_PARAMETERS(X, accelerator_a) PEDAL_CHANNEL_PARAMETERS(X, accelerator_b) \
    PEDAL_CHANNEL_PARAMETERS(X, brake_a) PEDAL_CHANNEL_PARAMETERS(X, brake_b)
/* clang-format on */

typedef struct {
    PEDAL_SENSORS_PARAMETERS(PLANT_PARAMETER_MEMBER)
} pedal_sensors_params_t;

/* Ratios 0 .. 1. */
typedef struct {
    double accelerator_a, accelerator_b, brake_a, brake_b;
} pedal_sensors_t;

/* Travels 0 .. 1. */
pedal_sensors_t pedal_sensors_read(const pedal_sensors_params_t *params, double accelerator,
                                   double brake);

#endif

/* SPDX-License-Identifier: Apache-2.0 */
/*
 * sensor_fault.h: what broken sensors of one wheel show, between the plant and sensors.h.
 *
 * Before the converters: the currents with gain, offset and drift; the bus voltage with gain; the
 * rotor's angle as a frozen, slipped, displaced or reversed sensor sees it. A slip and a jump move
 * the sensor on the shaft, so halls, encoder and angle show the same. After the converters: stuck
 * and frozen codes, hall lines that float or bounce.
 *
 * Per wheel and PWM period, only while there is such a fault.
 */
#ifndef PLANT_SENSOR_FAULT_H
#define PLANT_SENSOR_FAULT_H

#include <stdbool.h>
#include <stdint.h>

#include "plant/fault.h"
#include "plant/random.h"
#include "plant/sensors.h"
#include "plant/vectors.h"

/* What a fault remembers of its beginning. All zero: no fault yet. */
typedef struct {
    bool has_codes, has_angle; /* the kept values are those of the beginning */
    uint16_t kept_current_code[3], kept_bus_code;
    double kept_theta_turn;
    double offset_share; /* of the full scale, drifted so far */
    double slip_turn;    /* slipped so far, electrical */
    double bounce_s;     /* since the last change of a loose contact */
    bool interrupted;
} sensor_fault_t;

/* What stands in front of the converters. */
typedef struct {
    plant_abc_t current_a;
    double bus_voltage_v;
    double theta_turn; /* 0 <= theta < 1 */
} sensor_view_t;

/* Whether any of them is present. */
bool sensor_fault_present(const fault_params_t *params);

/* A period begins, period_s after the one before; full_scale_a of the current sensors. */
sensor_view_t sensor_fault_before(const fault_params_t *params, sensor_fault_t *state,
                                  const sensor_view_t *truth, double full_scale_a, double period_s);

/* Then what the converters made of it. Draws from `random` only for floating lines. */
void sensor_fault_after(const fault_params_t *params, sensor_fault_t *state, random_t *random,
                        sensors_sample_t *sample);

#endif

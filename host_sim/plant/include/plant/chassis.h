/* SPDX-License-Identifier: Apache-2.0 */
/*
 * chassis.h: which wheel carries how much.
 *
 *     front = m g cos(slope) share - m (a + g sin(slope)) h / b
 *     rear = m g cos(slope) - front
 *
 * m a is what the tyres do and the slope takes: braking (a < 0) and driving downhill load the front
 * axle. The body follows with a first-order lag (springs and dampers). An axle never lifts the
 * road: loads end at 0 and at the whole weight.
 *
 * Wheels are counted from the front left: with two on an axle 0 and 1 are in front, 2 and 3 at the
 * rear; a vehicle with fewer driven wheels than that has them in front, or at the rear with
 * rear_driven.
 */
#ifndef PLANT_CHASSIS_H
#define PLANT_CHASSIS_H

#include "plant/parameter.h"

/* clang-format off */
#define CHASSIS_PARAMETERS(X) \
    X(wheel_inertia_kg_m2,          0.0, 1e3,   "kg m2", \
      "of one driven wheel and its rotor; part of vehicle.mass_kg") \
    X(wheelbase_m,                  0.0, 50.0,  "m", \
      "b, from axle to axle; 0: no load transfer") \
    X(centre_of_gravity_height_m,   0.0, 10.0,  "m",     "h, above the road") \
    X(front_load_share,             0.0, 1.0,   "1", \
      "of the weight on the front axle, standing on the flat") \
    X(wheels_per_axle,              0.0, 8.0,   "1",     "1 for a bicycle, 2 for a car") \
    X(rear_driven,                  0.0, 1.0,   "", \
      "1: the driven wheels begin on the rear axle") \
    X(pitch_time_constant_s,        0.0, 10.0,  "s", \
      "lag of the load after the acceleration; 0: none")
/* clang-format on */

typedef struct {
    CHASSIS_PARAMETERS(PLANT_PARAMETER_MEMBER)
} chassis_params_t;

/* Worked out once. */
typedef struct {
    double weight_n; /* square to the road */
    double front_share;
    double transfer_kg;    /* m h / b */
    double slope_m_per_s2; /* g sin(slope) */
    double approach;       /* of a step: 1 - exp(-step/tau) */
    int wheels_per_axle;
    int first_rear; /* the driven wheel the rear axle begins with */
} chassis_t;

typedef struct {
    double filtered_m_per_s2; /* the acceleration the springs have followed so far */
} chassis_state_t;

/* weight_n: of the whole vehicle, square to the road; slope_n: its part along the road. */
chassis_t chassis_on_road(const chassis_params_t *params, double mass_kg, double weight_n,
                          double slope_n, double step_s);

void chassis_step(const chassis_t *chassis, chassis_state_t *state, double acceleration_m_per_s2);

/* Load of driven wheel k now, N. */
double chassis_load_n(const chassis_t *chassis, const chassis_state_t *state, int wheel);

#endif

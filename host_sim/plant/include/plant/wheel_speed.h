/* SPDX-License-Identifier: Apache-2.0 */
/*
 * wheel_speed.h: a toothed ring on the wheel and what a brake's control unit makes of its pulses.
 *
 * Every tooth gives an edge, whichever way the wheel turns. The unit stamps edges with a clock of
 * finite steps and divides: teeth since the last edge it used over the time between both stamps.
 * Between edges the wheel cannot be faster than one tooth in the time that has passed, so the speed
 * is limited to that, and below `lowest` it is zero: a passive sensor has no signal there. After
 * that two edges are needed for a speed. No teeth: the speed itself.
 */
#ifndef PLANT_WHEEL_SPEED_H
#define PLANT_WHEEL_SPEED_H

#include <stdbool.h>

#include "plant/parameter.h"

/* clang-format off */
#define WHEEL_SPEED_PARAMETERS(X) \
    X(teeth,             0.0, 1024.0, "1", \
      "edges in a turn of the wheel; 0: the true speed") \
    X(clock_s,           0.0, 1e-2,   "s",     "step of the edges' time stamps; 0: exact") \
    X(lowest_rad_per_s,  0.0, 100.0,  "rad/s", "no pulses below") \
    X(dead,              0.0, 1.0,    "",      "1: no pulses at all")
/* clang-format on */

typedef struct {
    WHEEL_SPEED_PARAMETERS(PLANT_PARAMETER_MEMBER)
} wheel_speed_params_t;

typedef struct {
    double tooth;   /* the ring's place in teeth, within one tooth */
    double stamp_s; /* of the last edge */
    bool has_stamp;
    double speed_rad_s; /* magnitude, measured */
} wheel_speed_t;

/* Call every step_s: turned_rad since the last call, speed_rad_s now, time_s now. Returns the
 * measured magnitude. */
double wheel_speed_step(const wheel_speed_params_t *params, wheel_speed_t *ring, double turned_rad,
                        double speed_rad_s, double time_s, double step_s, bool dead);

#endif

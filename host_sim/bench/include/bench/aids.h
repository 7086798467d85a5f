/* SPDX-License-Identifier: Apache-2.0 */
/*
 * aids.h: what the vehicle has besides its controllers: a speed sensor on every wheel and the
 * anti-lock system they serve.
 */
#ifndef BENCH_AIDS_H
#define BENCH_AIDS_H

#include <stdbool.h>

#include "bench/wheel.h"
#include "plant/anti_lock.h"
#include "plant/vehicle.h"

typedef struct {
    anti_lock_t anti_lock;
    double last_rad_s[ANTI_LOCK_WHEELS_MAX];
    bool busy; /* the system had a say in the last millisecond */
} aids_t;

/* A run begins: sensors and system know the wheels' speeds. */
void aids_begin(aids_t *aids, const bench_params_t *params, wheel_t *wheels, int count);

/* The millisecond, before the controllers': samples the wheels, sets their brakes' valves.
 * brake_nm: the pedal, magnitude. */
void aids_step(aids_t *aids, const wheel_world_t *world, wheel_t *wheels, int count,
               const vehicle_state_t *vehicle, double brake_nm, double time_s, double step_s);

#endif

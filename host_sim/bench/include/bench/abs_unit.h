/* SPDX-License-Identifier: Apache-2.0 */
/*
 * abs_unit.h: the vehicle's ABS unit: a speed sensor on every wheel and the anti-lock system
 * (plant/anti_lock.h) that controls the valves of the hydraulic brakes.
 */
#ifndef BENCH_ABS_UNIT_H
#define BENCH_ABS_UNIT_H

#include <stdbool.h>

#include "bench/wheel.h"
#include "plant/anti_lock.h"
#include "plant/vehicle.h"

typedef struct {
    anti_lock_t anti_lock;
    double last_rad_s[ANTI_LOCK_WHEELS_MAX];
    bool was_active; /* in the last step */
} abs_unit_t;

/* At the start of a run: sensors and anti-lock system begin with the wheels' speeds. */
void abs_unit_begin(abs_unit_t *abs_unit, const bench_params_t *params, wheel_t *wheels, int count);

/* 1 kHz, before the controllers' slow step: samples the wheel speeds, sets the valves of the
 * brakes. brake_nm: braking demand, magnitude. */
void abs_unit_step(abs_unit_t *abs_unit, const wheel_world_t *world, wheel_t *wheels, int count,
                   const vehicle_state_t *vehicle, double brake_nm, double time_s, double step_s);

#endif

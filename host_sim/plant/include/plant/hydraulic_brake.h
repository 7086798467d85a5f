/*
 * hydraulic_brake.h: a wheel brake that is told a torque and gives it late.
 *
 * command -> dead time -> first-order lag, no faster than a rate in either direction. The torque is a capacity: it
 * opposes rotation, holds a standing wheel up to its magnitude, and never drives (vehicle_step() decides how much of
 * it is used). Commands arrive at 1 kHz, so the dead time is rounded to whole milliseconds.
 */
#ifndef PLANT_HYDRAULIC_BRAKE_H
#define PLANT_HYDRAULIC_BRAKE_H

#include "plant/parameter.h"

/* clang-format off */
#define HYDRAULIC_BRAKE_PARAMETERS(X) \
    X(hydraulic_dead_time_s,       0.0,  1.0, "s",     "from command to the first change of torque") \
    X(hydraulic_time_constant_s,   0.0,  10.0, "s",    "first-order lag; 0: none") \
    X(hydraulic_rate_nm_per_s,     0.1,  1e7, "N m/s", "fastest change of torque") \
    X(max_hydraulic_torque_nm,     0.0,  1e5, "N m",   "at one wheel; 0: no such brake")
/* clang-format on */

typedef struct {
    HYDRAULIC_BRAKE_PARAMETERS(PLANT_PARAMETER_MEMBER)
} hydraulic_brake_params_t;

enum { HYDRAULIC_BRAKE_DELAY_MS_MAX = 1000 };

typedef struct {
    double torque_nm; /* capacity now, >= 0 */
    double target_nm; /* the command whose time has come */
    double commands_nm[HYDRAULIC_BRAKE_DELAY_MS_MAX + 1];
    int delay_ms;
    int next;
    /* Of the step length: */
    double approach; /* 1 - exp(-step/tau) */
    double largest_change_nm;
} hydraulic_brake_state_t;

/* step_s: length of hydraulic_brake_step(). */
hydraulic_brake_state_t hydraulic_brake_init(const hydraulic_brake_params_t *params, double step_s);

/* Once per millisecond: command_nm >= 0, clamped to the largest torque. */
void hydraulic_brake_command(const hydraulic_brake_params_t *params, hydraulic_brake_state_t *state, double command_nm);

/* Advance one step; returns the torque capacity during it. */
double hydraulic_brake_step(hydraulic_brake_state_t *state);

#endif

/* SPDX-License-Identifier: Apache-2.0 */
/*
 * hydraulic_brake.h: a wheel brake that follows a torque command with dead time and lag.
 *
 * command -> dead time -> first-order lag, no faster than a rate in either direction -> what is
 * left of the friction. Below the knee the torque rises only at the knee's rate: the fluid first
 * closes the gap between pads and disc. The torque is a capacity: it opposes rotation, holds a
 * standing wheel up to its magnitude, and never drives (vehicle_step() decides how much of it is
 * used). Commands arrive at 1 kHz, so the dead time is rounded to whole milliseconds.
 *
 * An anti-lock system (anti_lock.h) has valves at the wheel, after dead time and lag: they make
 * the torque rise slowly, keep it from rising, or let it go at once. A command that falls below the
 * torque always gets through.
 */
#ifndef PLANT_HYDRAULIC_BRAKE_H
#define PLANT_HYDRAULIC_BRAKE_H

#include "plant/parameter.h"

/* clang-format off */
#define HYDRAULIC_BRAKE_PARAMETERS(X) \
    X(hydraulic_dead_time_s,       0.0,  1.0, "s", \
      "from command to the first change of torque") \
    X(hydraulic_time_constant_s,   0.0,  10.0, "s",    "first-order lag; 0: none") \
    X(hydraulic_rate_nm_per_s,     0.1,  1e7, "N m/s", "fastest change of torque") \
    X(max_hydraulic_torque_nm,     0.0,  1e5, "N m",   "at one wheel; 0: no such brake") \
    X(knee_torque_nm,              0.0,  1e5, "N m", \
      "torque rises slowly up to here; 0: no knee") \
    X(knee_rate_nm_per_s,          0.0,  1e7, "N m/s", "of the rise below the knee") \
    X(torque_loss,                -0.5,  1.0, "1", \
      "share of the torque lost; 1: no torque, negative: more torque than commanded")
/* clang-format on */

typedef struct {
    HYDRAULIC_BRAKE_PARAMETERS(PLANT_PARAMETER_MEMBER)
} hydraulic_brake_params_t;

enum { HYDRAULIC_BRAKE_DELAY_MS_MAX = 1000 };

typedef enum {
    HYDRAULIC_VALVE_OPEN,  /* as if there were none */
    HYDRAULIC_VALVE_BUILD, /* rises at the system's rate */
    HYDRAULIC_VALVE_HOLD,  /* does not rise */
    HYDRAULIC_VALVE_DUMP   /* falls at the system's rate */
} hydraulic_valve_t;

typedef struct {
    double torque_nm; /* equivalent of the pressure, >= 0 */
    double target_nm; /* the command whose time has come */
    double commands_nm[HYDRAULIC_BRAKE_DELAY_MS_MAX + 1];
    int delay_ms;
    int next;
    /* Of the step length: */
    double approach; /* 1 - exp(-step/tau) */
    double largest_change_nm, knee_rise_nm;
    double knee_nm;
    double gain; /* capacity over torque_nm */
    hydraulic_valve_t valve;
    double build_nm, dump_nm; /* of the valve, a step */
} hydraulic_brake_state_t;

/* step_s: length of hydraulic_brake_step(). */
hydraulic_brake_state_t hydraulic_brake_init(const hydraulic_brake_params_t *params, double step_s);

/* After a change of parameters other than the dead time. torque_loss: this wheel's own, on top of
 * the parameters'. */
void hydraulic_brake_refresh(const hydraulic_brake_params_t *params, hydraulic_brake_state_t *state,
                             double torque_loss, double step_s);

/* Once per millisecond: command_nm >= 0, clamped to the largest torque. */
void hydraulic_brake_command(const hydraulic_brake_params_t *params, hydraulic_brake_state_t *state,
                             double command_nm);

/* From now on; rates of the system's own. */
void hydraulic_brake_valve(hydraulic_brake_state_t *state, hydraulic_valve_t valve,
                           double build_nm_per_s, double dump_nm_per_s, double step_s);

/* Advance one step; returns the torque capacity during it. */
double hydraulic_brake_step(hydraulic_brake_state_t *state);

#endif

/* SPDX-License-Identifier: Apache-2.0 */
/*
 * available_ahead.h: the torques available now and AVAILABLE_AHEAD_ms later, with their reasons.
 * Slow loop, once per step.
 *
 * Every line of the torque limits is carried forward: those that are plain functions of speed and
 * temperature are evaluated at the speed and temperature expected then, the others by the filtered
 * slope of the bound itself, which contains the slopes of speed, voltage, temperature and battery
 * limits. A bound that is not solved now, because it lies above the largest torque, has no slope;
 * it is solved at the expected speed and voltage, in a step that has saved effort.
 *
 * The work is spread over a round of AVAILABLE_AHEAD_ROUND_steps; results are two rounds old at
 * most. What changes by a step (torque enable, anti-lock, a new limit of the battery) is taken as
 * it is now. Error: DERIVATIONS.md, Available torque.
 */
#ifndef TORQUE_AVAILABLE_AHEAD_H
#define TORQUE_AVAILABLE_AHEAD_H

#include <stdbool.h>
#include <stdint.h>

#include "config/config.h"
#include "core/measured.h"
#include "motor/motor_model.h"
#include "torque/limit.h"
#include "torque/torque_limits.h"

/* 300 ms: the dead time and two lags of a slow hydraulic brake, so that it can be there in time. */
enum { AVAILABLE_AHEAD_ms = 300, AVAILABLE_AHEAD_ROUND_steps = 16 };

/* Of a quantity sampled once a round. */
typedef struct {
    int32_t value;
    int32_t low_passed_q3;
    bool known; /* sampled before */
} available_slope_t;

/* Largest torque along the rotation and against it; magnitudes, mN m at the shaft. */
typedef struct {
    limit_t driving, braking;
} available_t;

typedef struct {
    int32_t speed_mrad_s; /* mechanical, signed */
    int32_t phase_voltage_mV;
    int32_t winding_temperature_cC;
    int32_t switch_temperature_cC;
    int32_t brake_torque_mNm; /* demanded, magnitude; a parallel brake takes a share of it */
} available_inputs_t;

enum { AVAILABLE_SLOPED_LINES = 5 };

typedef struct {
    uint32_t step; /* of the round */
    available_slope_t speed, voltage, winding, switches;
    available_slope_t returned, drawn; /* power that the battery permits */
    available_slope_t driving[AVAILABLE_SLOPED_LINES], braking[AVAILABLE_SLOPED_LINES];
    /* Expected, of this round. */
    available_inputs_t expected;
    int32_t returned_b, drawn_b;
    limit_t driving_lines[TORQUE_LINE_COUNT], braking_lines[TORQUE_LINE_COUNT];
    /* Results of the last round. */
    available_t now, ahead;
} available_ahead_state_t;

/* Until the first round has ended both results are zero, with REASON_TORQUE_ENABLE. */
void available_ahead_init(available_ahead_state_t *state);

/* Writes now and ahead of the state in the last phase of a round. limits: the table of this step.
 * phase_voltage_mV: peak, that its bounds were solved with. brake_torque_mNm: demanded, below zero
 * counts as zero. */
void available_ahead_step(available_ahead_state_t *state, const motor_constants_t *motor,
                          const config_t *config, const torque_limits_t *limits,
                          const measured_t *now, int32_t phase_voltage_mV,
                          int32_t brake_torque_mNm);

#endif

/* SPDX-License-Identifier: Apache-2.0 */
/*
 * available_ahead.h: the torques available now and AVAILABLE_AHEAD_ms later, with their reasons.
 * Slow loop, once per step.
 *
 * Expected is the table of torque limits at the inputs expected then: speed, voltage, temperatures
 * and the battery's powers, each carried on with its filtered slope. What changes by steps (torque
 * enable, rotor angle, anti-lock, a new limit of the battery) is taken as it is now.
 *
 * The table costs about 6 000 instructions at worst, so its parts are evaluated one after the other
 * in a round of AVAILABLE_AHEAD_ROUND_steps; results are 14 to 30 ms old, which the slopes count
 * in. Error: DERIVATIONS.md, Available torque.
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

/* Inputs of the table. */
typedef struct {
    int32_t speed_mrad_s; /* mechanical, signed */
    int32_t phase_voltage_mV;
    int32_t winding_temperature_cC;
    int32_t switch_temperature_cC;
} available_inputs_t;

typedef struct {
    uint32_t step; /* of the round */
    available_slope_t speed, voltage, winding, switches;
    available_slope_t returned, drawn; /* power that the battery permits */
    available_inputs_t expected;       /* of this round */
    torque_limits_t table;             /* at them, as far as it is evaluated */
    motor_point_t cap;                 /* of a side between its two parts */
    available_t now, ahead;            /* of the last round */
} available_ahead_state_t;

/* Until the first round has ended both results are zero, with REASON_TORQUE_ENABLE. */
void available_ahead_init(available_ahead_state_t *state);

/* Writes now and ahead of the state in the last part of a round. limits: the table of this step.
 * phase_voltage_mV: peak, that its bounds were solved with. brake_torque_mNm: demanded, below zero
 * counts as zero. */
void available_ahead_step(available_ahead_state_t *state, const motor_constants_t *motor,
                          const config_t *config, const torque_limits_t *limits,
                          const measured_t *now, int32_t phase_voltage_mV,
                          int32_t brake_torque_mNm);

#endif

/* SPDX-License-Identifier: Apache-2.0 */
/*
 * torque_command.h: one signed motor torque from the driving demand and the electric part of
 * braking, within the torque limits and no faster than the torque rate. 1 kHz.
 *
 * The rate is for comfort. At once, in one slow step, go: a driving torque that is withdrawn (brake
 * pedal, lost demand, neutral), braking torque above the limit ABS, torque above the limit ROTOR
 * with the observer's angle, braking torque that would drive because the wheel has turned round,
 * and what the hydraulic brake has taken over in this step.
 *
 * A rising torque needs voltage, which field weakening makes available only after some
 * milliseconds. The rate limit for rising torque therefore falls with u^2/U^2, the square of the
 * modulation index, along a straight line: zero at brake.torque_growth_end, slope
 * brake.torque_growth_slope. Default values: full rate up to 0.94 (the setpoint of field
 * weakening), zero at 0.96, negative above: the torque falls, but not by the voltage that a torque
 * which has just risen needs besides, to move the current. The voltage is the measured one, so
 * errors of the motor parameters have no effect. Falling torque is not limited by it.
 * DERIVATIONS.md, Torque growth.
 */
#ifndef TORQUE_TORQUE_COMMAND_H
#define TORQUE_TORQUE_COMMAND_H

#include <stdbool.h>
#include <stdint.h>

#include "config/config.h"
#include "core/torque_enable.h"
#include "torque/demand.h"
#include "torque/torque_limits.h"

typedef struct {
    bool braked;        /* the command of the last step acted against the rotation */
    int32_t moving_mNm; /* negative growth that the voltage of a moving current asks for, >= 0 */
} torque_command_state_t;

/* Braking torques of the motor, magnitudes >= 0, against the rotation. */
typedef struct {
    int32_t electric_mNm;  /* demanded of it */
    int32_t uncovered_mNm; /* of the demand, beyond the hydraulic brake's torque */
    int32_t rise_mNm;      /* of the hydraulic brake's torque in this step */
} motor_braking_t;

typedef struct {
    int32_t command_mNm; /* signed, positive forward */
    reason_t reason;     /* of the limit of the command; REASON_NONE if it equals the demand */
    bool falling;        /* at the torque rate, towards a smaller torque of the same sign */
} torque_command_out_t;

/* Whether a torque acts against the rotation; none does at standstill. */
bool torque_command_is_against(int32_t torque_mNm, int32_t speed_mrad_s);

/* Permitted change of the torque's magnitude in one slow step, mN m, within the torque rate;
 * negative: it must fall. voltage_use_q15: u^2/U^2, clamped to 0 .. twice brake.torque_growth_end.
 */
int32_t torque_command_growth_mNm(const config_t *config, int32_t voltage_use_q15);

void torque_command_init(torque_command_state_t *state);

/* 1 kHz. limits, braking: of this step. last_command_mNm: of the step before, signed. bridge_open:
 * it has not switched since, so that there was no torque, whatever was commanded; the command is
 * zero at once then, without a ramp. Without a driving demand its magnitude is at most the last
 * one or what is demanded of the motor. */
torque_command_out_t torque_command_step(torque_command_state_t *state, const config_t *config,
                                         const torque_limits_t *limits, const measured_t *now,
                                         int32_t last_command_mNm, const torque_enable_t *enable,
                                         const demand_t *demand, const motor_braking_t *braking,
                                         bool bridge_open);

#endif

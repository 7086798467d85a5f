/* SPDX-License-Identifier: Apache-2.0 */
/*
 * torque_command.h: one signed motor torque from the driving demand and the electric part of
 * braking, within the torque limits and no faster than the torque rate. 1 kHz.
 *
 * The rate is for comfort. At once, in one slow step, go: a driving torque that is withdrawn (brake
 * pedal, lost demand, neutral), braking torque above the limit ABS, braking torque that would drive
 * because the wheel has turned round, and what the hydraulic brake has taken over in this step.
 *
 * A rising torque needs voltage, which field weakening makes available only after some
 * milliseconds. The rate limit for rising torque therefore falls with u^2/U^2, the square of the
 * modulation index, along a straight line: zero at brake.torque_growth_end, slope
 * brake.torque_growth_slope. Default values: full rate up to 0.94 (the setpoint of field
 * weakening), zero at 0.96, negative above (the torque falls). The voltage is the measured one, so
 * errors of the motor parameters have no effect. Falling torque is not limited by it.
 */
#ifndef TORQUE_TORQUE_COMMAND_H
#define TORQUE_TORQUE_COMMAND_H

#include <stdbool.h>
#include <stdint.h>

#include "config/config.h"
#include "core/torque_enable.h"
#include "torque/torque_limits.h"

typedef struct {
    int32_t command_mNm; /* of the last step, signed */
    bool braked;         /* it acted against the rotation */
} torque_command_state_t;

typedef struct {
    torque_enable_t torque_enable;
    int32_t speed_mrad_s;
    int32_t voltage_use_q15; /* u^2 / U^2 of the unsaturated voltage, >= 0 */
    int32_t drive_mNm;       /* demand, signed */
    int32_t electric_mNm;    /* braking magnitude, against the rotation */
    int32_t beside_mNm;      /* of the braking demand beside the hydraulic brake's torque, >= 0 */
    int32_t arrived_mNm;     /* of the hydraulic brake's torque in this step, >= 0 */
    bool drive_withdrawn;    /* a torque that drives goes at once */
    bool bridge_open;        /* since the last step: there is no torque, whatever was commanded */
} torque_command_input_t;

typedef struct {
    int32_t command_mNm; /* signed, positive forward */
    reason_t reason;     /* of the limit of the command; REASON_NONE if it equals the demand */
    bool falling;        /* at the torque rate, towards a smaller torque of the same sign */
} torque_command_out_t;

/* Whether a torque acts against the rotation; none does at standstill. */
bool torque_command_is_against(int32_t torque_mNm, int32_t speed_mrad_s);

/* Permitted change of the torque's magnitude in one slow step; negative: it must fall. */
int32_t torque_command_growth_mNm(const config_t *config, int32_t voltage_use_q15);

void torque_command_init(torque_command_state_t *state);

/* While the bridge does not switch, the command is zero at once, without a ramp. */
torque_command_out_t torque_command_step(torque_command_state_t *state, const config_t *config,
                                         const torque_limits_t *limits,
                                         const torque_command_input_t *in);

#endif

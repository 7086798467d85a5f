/* SPDX-License-Identifier: Apache-2.0 */
/*
 * torque_command.h: one signed motor torque from the driving demand and the electric part of
 * braking, within the torque limits and no faster than the torque rate. 1 kHz.
 *
 * A growing torque takes voltage, for which field weakening needs some milliseconds. So the rate
 * falls with the voltage |u| against its circle U, along a straight line over u^2/U^2 that ends at
 * brake.torque_growth_end with brake.torque_growth_slope: as generated whole up to 0.89, a third at
 * the 0.94 that field weakening regulates, zero at 0.96; beyond, the torque shrinks in the same
 * proportion. It goes by the measured voltage, so it also holds where the motor is not as
 * configured. Falling is never slowed down.
 */
#ifndef TORQUE_TORQUE_COMMAND_H
#define TORQUE_TORQUE_COMMAND_H

#include <stdint.h>

#include "config/config.h"
#include "core/torque_enable.h"
#include "torque/torque_limits.h"

typedef struct {
    int32_t command_mNm; /* of the last step, signed */
} torque_command_state_t;

typedef struct {
    torque_enable_t torque_enable;
    int32_t speed_mrad_s;
    int32_t voltage_use_q15; /* u^2 / U^2 as the current loop wants it now, >= 0 */
    int32_t drive_mNm;       /* demand, signed */
    int32_t electric_mNm;    /* braking magnitude from brake blending, against the rotation */
} torque_command_input_t;

typedef struct {
    int32_t command_mNm; /* signed, positive forward */
    reason_t reason;     /* why it is not what was asked for; REASON_NONE when it is */
} torque_command_out_t;

/* By how much a torque's magnitude may change in one step at that voltage; negative: it must
 * shrink. */
int32_t torque_command_growth_mNm(const config_t *config, int32_t voltage_use_q15);

void torque_command_init(torque_command_state_t *state);

/* With the bridge not switching, the command is 0 at once: there is nothing left to ramp. */
torque_command_out_t torque_command_step(torque_command_state_t *state, const config_t *config,
                                         const torque_limits_t *limits,
                                         const torque_command_input_t *in);

#endif

/* SPDX-License-Identifier: Apache-2.0 */
/*
 * torque_command.h: one signed motor torque from the driving demand and the electric part of
 * braking, permitted, bounded and no faster than the torque rate. The valve enters the slow loop
 * here.
 *
 * A torque that grows takes voltage, and where there is little left field weakening must make room
 * first, which takes it some milliseconds. So a torque grows the slower the nearer the voltage |u|
 * is to its circle U: at the full rate up to u^2 = 0.89 U^2, not at all at 0.96 U^2, where field
 * weakening has not kept up; beyond, it shrinks in the same proportion. At the 0.94 U^2 that field
 * weakening holds, a third of the rate is left. It goes by the measured voltage, so it also holds
 * where the motor is not as configured: what the voltage cannot carry is given back, before i_q is
 * no longer regulated and before the d axis runs into its own bound (current_loop_give_back_d(),
 * 0.97 U^2). Falling is never slowed down.
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

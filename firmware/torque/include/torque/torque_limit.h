/*
 * torque_limit.h: one signed motor torque from the driving demand and the electric part of braking, permitted,
 * bounded and no faster than the torque rate. The valve enters the slow reach here.
 */
#ifndef TORQUE_TORQUE_LIMIT_H
#define TORQUE_TORQUE_LIMIT_H

#include <stdint.h>

#include "config/config.h"
#include "core/permission.h"
#include "torque/capability.h"

typedef struct {
    int32_t command_mNm; /* of the last step, signed */
} torque_limit_state_t;

typedef struct {
    int32_t command_mNm; /* signed, positive forward */
    reason_t reason;     /* why it is not what was asked for; REASON_NONE when it is */
} torque_limit_out_t;

void torque_limit_init(torque_limit_state_t *state);

/* drive_mNm: signed demand. electric_mNm: braking magnitude from the arbiter, against the rotation. With the bridge not
 * switching, the command is 0 at once: there is nothing left to ramp. */
torque_limit_out_t torque_limit_step(torque_limit_state_t *state, const config_t *config,
                                     const capability_t *capability, const permission_t *permission,
                                     int32_t speed_mrad_s, int32_t drive_mNm, int32_t electric_mNm);

#endif

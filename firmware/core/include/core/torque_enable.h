/* SPDX-License-Identifier: Apache-2.0 */
/*
 * torque_enable.h: the permitted share of driving and of braking torque, with its reason. Made by
 * modes at 1 kHz from the findings; it computes no torque.
 *
 * It acts at two places: as a line of the torque limits, and on the bridge, which switches while
 * either share is above zero.
 */
#ifndef CORE_TORQUE_ENABLE_H
#define CORE_TORQUE_ENABLE_H

#include <stdbool.h>
#include <stdint.h>

#include "core/reason.h"

typedef struct {
    int16_t drive_q15; /* permitted share of the driving torque, 0 .. 32767 */
    int16_t brake_q15; /* permitted share of the electric braking torque, 0 .. 32767 */
    reason_t reason;   /* why a share is below one; REASON_NONE at full enable */
} torque_enable_t;

/* True if any torque is permitted. */
static inline bool torque_enable_any(torque_enable_t enable)
{
    return enable.drive_q15 > 0 || enable.brake_q15 > 0;
}

#endif

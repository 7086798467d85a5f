/* SPDX-License-Identifier: Apache-2.0 */
/*
 * torque_enable.h: the valve. Modes and monitor never compute torque; they only open and close
 * this.
 *
 * It enters the river at two places: the torque limit (how much torque may be asked for, each
 * direction of power on its own) and the bridge mode (whether and how the switches may be driven).
 */
#ifndef CORE_TORQUE_ENABLE_H
#define CORE_TORQUE_ENABLE_H

#include "core/reason.h"

/* What the six switches do. OFF freewheels through the diodes and is harmless only while the
 * rectified back-EMF stays below the bus; SHORT closes the three low-side switches: no bus current,
 * braking torque of the short. */
typedef enum { BRIDGE_OFF = 0, BRIDGE_PWM = 1, BRIDGE_SHORT = 2 } bridge_mode_t;

typedef struct {
    bridge_mode_t bridge;
    int16_t drive_q15; /* share of the driving torque that is permitted, 0 .. 32767 */
    int16_t brake_q15; /* share of the electric braking torque that is permitted, 0 .. 32767 */
    reason_t reason;   /* why less than everything is permitted; REASON_NONE when fully open */
} torque_enable_t;

#endif

/* SPDX-License-Identifier: Apache-2.0 */
/*
 * torque_enable.h: the torque enable: the bridge mode, and the permitted share of driving and of
 * braking torque, with its reason. Made by modes at 1 kHz from the monitor's results; neither of
 * them computes torque.
 *
 * It acts at two places: as a line of the torque limits, and on the bridge.
 */
#ifndef CORE_TORQUE_ENABLE_H
#define CORE_TORQUE_ENABLE_H

#include "core/reason.h"

/* What the six switches do. OFF: all open, freewheel; the diodes conduct only while the rectified
 * back-EMF exceeds the bus voltage. SHORT: the three low-side switches closed, active short circuit
 * (ASC): no bus current, braking torque of the short-circuited machine. */
typedef enum { BRIDGE_OFF = 0, BRIDGE_PWM = 1, BRIDGE_SHORT = 2 } bridge_mode_t;

typedef struct {
    bridge_mode_t bridge;
    int16_t drive_q15; /* permitted share of the driving torque, 0 .. 32767 */
    int16_t brake_q15; /* permitted share of the electric braking torque, 0 .. 32767 */
    reason_t reason;   /* why a share is below one; REASON_NONE at full enable */
} torque_enable_t;

#endif

/* SPDX-License-Identifier: Apache-2.0 */
/*
 * bridge.h: modes of the inverter bridge.
 *
 * OFF: all open, freewheel; the diodes conduct only while the rectified back-EMF exceeds the bus
 * voltage. PWM: switched by the compare values. SHORT: the three low-side switches closed, active
 * short circuit (ASC): no bus current, braking torque of the short-circuited machine.
 */
#ifndef CORE_BRIDGE_H
#define CORE_BRIDGE_H

typedef enum { BRIDGE_OFF = 0, BRIDGE_PWM = 1, BRIDGE_SHORT = 2 } bridge_mode_t;

#endif

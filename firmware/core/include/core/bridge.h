/* SPDX-License-Identifier: Apache-2.0 */
/*
 * bridge.h: modes of the inverter bridge.
 *
 * OFF: all open, freewheel; the diodes conduct only while the rectified back-EMF exceeds the bus
 * voltage. PWM: switched by the compare values. SHORT: the three low-side switches closed, active
 * short circuit (ASC): no bus current, braking torque of the short-circuited machine. SHORT_HIGH:
 * the same with the three high-side switches, for a high-side switch that is stuck closed.
 */
#ifndef CORE_BRIDGE_H
#define CORE_BRIDGE_H

#include <stdbool.h>

typedef enum {
    BRIDGE_OFF = 0,
    BRIDGE_PWM = 1,
    BRIDGE_SHORT = 2,
    BRIDGE_SHORT_HIGH = 3
} bridge_mode_t;

/* Active short circuit, on either side. */
static inline bool bridge_is_short(bridge_mode_t bridge)
{
    return bridge == BRIDGE_SHORT || bridge == BRIDGE_SHORT_HIGH;
}

#endif

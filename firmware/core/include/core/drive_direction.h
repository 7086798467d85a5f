/* SPDX-License-Identifier: Apache-2.0 */
/*
 * drive_direction.h: the direction that the driver has selected. The numbers are part of the CAN
 * protocol; zero drives in neither direction, so a message of zeros is harmless.
 */
#ifndef CORE_DRIVE_DIRECTION_H
#define CORE_DRIVE_DIRECTION_H

#include <stdint.h>

typedef enum {
    DRIVE_DIRECTION_NEUTRAL = 0,
    DRIVE_DIRECTION_FORWARD = 1,
    DRIVE_DIRECTION_REVERSE = 2
} drive_direction_t;

/* Sign of a driving torque in this direction: 1 forward, -1 reverse, 0 for everything else. */
int32_t drive_direction_sign(drive_direction_t direction);

#endif

/* SPDX-License-Identifier: Apache-2.0 */
#include "core/drive_direction.h"

int32_t drive_direction_sign(drive_direction_t direction)
{
    if (direction == DRIVE_DIRECTION_FORWARD) {
        return 1;
    }
    return direction == DRIVE_DIRECTION_REVERSE ? -1 : 0;
}

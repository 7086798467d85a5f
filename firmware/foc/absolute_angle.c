/* SPDX-License-Identifier: Apache-2.0 */
#include "absolute_angle.h"

#include "angle_tracker.h"
#include "core/angle.h"
#include "core/q15.h"

void absolute_angle_init(absolute_angle_t *angle)
{
    const absolute_angle_t fresh = {.valid = true};
    *angle = fresh;
}

void absolute_angle_step(absolute_angle_t *angle, const config_t *config, uint16_t angle_turn)
{
    const uint32_t next_q32 = angle->tracker.theta_q32 + (uint32_t)angle->tracker.speed_q32;
    const int32_t apart_turn = angle_difference(angle_turn, (uint16_t)(next_q32 >> 16));
    const bool jumped = q_abs(apart_turn) > ABSOLUTE_ANGLE_JUMP_TURN;
    if (jumped && angle->settled == ABSOLUTE_ANGLE_SETTLED) {
        angle->apart++;
        if (angle->apart > ABSOLUTE_ANGLE_APART && angle->valid) {
            angle->faults++;
            angle->valid = false;
        }
        if (angle->apart < ABSOLUTE_ANGLE_GIVEN_UP) {
            angle->tracker.theta_q32 = next_q32;
            return;
        }
        angle->apart = 0;
        angle->tracker.started = false;
    } else if (angle->apart > 0) {
        angle->apart--;
    }
    angle->settled =
        jumped ? (uint8_t)0 : (uint8_t)q_min(angle->settled + 1, ABSOLUTE_ANGLE_SETTLED);
    angle->valid = angle->valid || (angle->settled == ABSOLUTE_ANGLE_SETTLED && angle->apart == 0);
    angle_tracker_step(&angle->tracker, config, angle_turn);
}

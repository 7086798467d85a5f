/* SPDX-License-Identifier: Apache-2.0 */
/*
 * absolute_angle.h: an absolute rotor angle (resolver, magnetic sensor), filtered by the tracking
 * loop and checked for jumps, once per PWM period.
 *
 * No rotor turns by more than 1/8 electrical turn beyond its speed within a period: such a sample
 * is skipped, the angle goes on with its speed. With 33 more such samples than others the sensor
 * has moved, or stands: faults counts it, the angle is invalid, and goes on with its speed so that
 * nothing follows the sensor until something else is used. With 96 it is taken as the sensor has
 * it; it is valid again after 255 samples in a row within 1/8 turn of their prediction.
 * DERIVATIONS.md, Absolute angle.
 */
#ifndef FOC_ABSOLUTE_ANGLE_H
#define FOC_ABSOLUTE_ANGLE_H

#include <stdint.h>

#include "config/config.h"
#include "foc/state.h"

enum {
    ABSOLUTE_ANGLE_JUMP_TURN = 8192, /* 45 degrees, 65 536 = one turn */
    ABSOLUTE_ANGLE_APART = 32,
    ABSOLUTE_ANGLE_GIVEN_UP = 96,
    ABSOLUTE_ANGLE_SETTLED = 255 /* periods; jumps are judged from then on */
};

/* Valid, without a filter for the first sample. */
void absolute_angle_init(absolute_angle_t *angle);

/* One period. angle_turn: 65 536 = one electrical turn. Results: tracker.theta_q32, .speed_q32,
 * faults (wrapping), valid. */
void absolute_angle_step(absolute_angle_t *angle, const config_t *config, uint16_t angle_turn);

#endif

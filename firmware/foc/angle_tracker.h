/* SPDX-License-Identifier: Apache-2.0 */
/*
 * angle_tracker.h: second-order tracking loop (PLL) on a measured angle, once per PWM period. No
 * steady error at constant speed; both poles at the same place (config.rotor.pll_*).
 *
 *     theta += speed;   e = angle - theta;   theta += k_p e;   speed += k_i e
 */
#ifndef FOC_ANGLE_TRACKER_H
#define FOC_ANGLE_TRACKER_H

#include <stdint.h>

#include "config/config.h"
#include "foc/state.h"

/* One period. The first angle is taken without filtering. */
void angle_tracker_step(angle_tracker_t *tracker, const config_t *config, uint16_t angle_turn);

#endif

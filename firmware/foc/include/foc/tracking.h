/* SPDX-License-Identifier: Apache-2.0 */
/*
 * tracking.h: a second-order tracking loop for a measured angle. Follows a constant speed without a
 * steady error, and its speed is that of the angle seen through the loop's bandwidth
 * (config.rotor.pll_*, both poles at the same place).
 *
 *     theta += speed;   e = angle - theta;   theta += k_p e;   speed += k_i e
 */
#ifndef FOC_TRACKING_H
#define FOC_TRACKING_H

#include <stdbool.h>
#include <stdint.h>

#include "config/config.h"

typedef struct {
    uint32_t theta_q32; /* turns */
    int32_t speed_q32;  /* turns per period */
    bool started;
} tracking_t;

/* One period. The first angle is taken as it is. */
void tracking_step(tracking_t *tracking, const config_t *config, uint16_t angle_turn);

#endif

/* SPDX-License-Identifier: Apache-2.0 */
#include "foc/tracking.h"

#include "core/angle.h"
#include "core/q15.h"

void tracking_step(tracking_t *tracking, const config_t *config, uint16_t angle_turn)
{
    if (!tracking->started) {
        tracking->started = true;
        tracking->theta_q32 = (uint32_t)angle_turn << 16;
    }
    tracking->theta_q32 += (uint32_t)tracking->speed_q32;
    const int32_t error_turn = angle_difference(angle_turn, (uint16_t)(tracking->theta_q32 >> 16));
    /* error in turn Q16 times a gain in Q16 is Q32; times a gain in Q24 is Q40. */
    tracking->theta_q32 +=
        (uint32_t)q_saturate64((int64_t)error_turn * config->rotor.pll_proportional_q16);
    tracking->speed_q32 = q_saturate64(
        tracking->speed_q32 + (((int64_t)error_turn * config->rotor.pll_integral_q24) >> 8));
}

/* SPDX-License-Identifier: Apache-2.0 */
#include "angle_tracker.h"

#include "core/angle.h"
#include "core/q15.h"

void angle_tracker_step(angle_tracker_t *tracker, const config_t *config, uint16_t angle_turn)
{
    if (!tracker->started) {
        tracker->started = true;
        tracker->theta_q32 = (uint32_t)angle_turn << 16;
    }
    tracker->theta_q32 += (uint32_t)tracker->speed_q32;
    const int32_t error_turn = angle_difference(angle_turn, (uint16_t)(tracker->theta_q32 >> 16));
    /* error in turn Q16 times a gain in Q16 is Q32; times a gain in Q24 is Q40. */
    tracker->theta_q32 += (uint32_t)error_turn * (uint32_t)config->rotor.pll_proportional_q16;
    tracker->speed_q32 = q_saturate64(
        tracker->speed_q32 + (((int64_t)error_turn * config->rotor.pll_integral_q24) >> 8));
}

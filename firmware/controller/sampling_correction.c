/* SPDX-License-Identifier: Apache-2.0 */
#include "sampling_correction.h"

#include "config/bases.h"
#include "core/q15.h"
#include "core/scaled.h"

enum { LARGEST_GAIN_Q24 = 1 << 20, LARGEST_MAGNETS_PU = 16 * 32768 };

/* (2 pi)^2 / 12 = 3.28987 in Q20 */
static const int64_t TURN_SQUARED_TWELFTH_Q20 = 3449675;

int32_t sampling_correction_magnets_pu(const config_t *config)
{
    /* Flux and inductance have the same format. */
    return q_scale(config->current_loop.flux_pu_q16, 32768,
                   config->current_loop.inductance_d_pu_q16);
}

sampling_correction_t sampling_correction_at(const config_t *config, int32_t magnets_pu,
                                             int32_t speed_q32, int32_t winding_temperature_cC)
{
    const int64_t turn_q20 = speed_q32 / 4096;
    /* At most half a turn: 2^38 times 2^22, and Q60 to Q24. */
    const int64_t gain_q24 = (turn_q20 * turn_q20 * TURN_SQUARED_TWELFTH_Q20) >> 36;
    const int32_t within_q24 = gain_q24 < LARGEST_GAIN_Q24 ? (int32_t)gain_q24 : LARGEST_GAIN_Q24;
    const int64_t share_q24 =
        bases_share_at_q24(config, config->motor.flux_coefficient_ppm_K, winding_temperature_cC);
    const sampling_correction_t out = {
        .gain_q24 = within_q24,
        .inverse_q24 = scaled_ratio(within_q24, SCALED_ONE + within_q24),
        .magnets_pu = q_min(q_saturate64((magnets_pu * share_q24) >> 24), LARGEST_MAGNETS_PU),
    };
    return out;
}

/* x times a share, rounded to nearest */
static int32_t share_of(int32_t share_q24, int32_t x)
{
    return (int32_t)(((int64_t)x * share_q24 + (1 << 23)) >> 24);
}

int32_t sampling_correction_mean_change(const sampling_correction_t *at, int32_t sampled_change)
{
    return sampled_change - share_of(at->inverse_q24, sampled_change);
}

dq_t sampling_correction_to_mean(const sampling_correction_t *at, dq_t sampled)
{
    const dq_t out = {
        .d = sampled.d - share_of(at->inverse_q24, sampled.d + at->magnets_pu),
        .q = sampling_correction_mean_change(at, sampled.q),
    };
    return out;
}

dq_t sampling_correction_to_sampled(const sampling_correction_t *at, dq_t mean)
{
    const dq_t out = {
        .d = mean.d + share_of(at->gain_q24, mean.d + at->magnets_pu),
        .q = mean.q + share_of(at->gain_q24, mean.q),
    };
    return out;
}

int32_t sampling_correction_d_pu(const sampling_correction_t *at)
{
    return -q_saturate16(share_of(at->inverse_q24, at->magnets_pu));
}

int32_t sampling_correction_mean_voltage(const sampling_correction_t *at, int32_t commanded)
{
    return commanded - share_of(at->gain_q24, commanded) / 2;
}

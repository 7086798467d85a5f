/* SPDX-License-Identifier: Apache-2.0 */
#include "modulation.h"

#include "config/bases.h"
#include "core/sqrt3.h"

enum { SMALLEST_LIMIT_Q15 = 8192, ROUNDING_COUNTS = 2 };

modulation_t modulation_of(int32_t period_counts, int32_t min_pulse_counts, int32_t trim_counts,
                           int32_t limit_q15)
{
    /* A vector on the circle spans at most limit * period between its lines: the outer pulses keep
     * period/2 (1 - limit) counts for the shortest pulse, the correction and the rounding. */
    const int32_t margin_counts = min_pulse_counts + trim_counts + ROUNDING_COUNTS;
    const int32_t widest_q15 = Q15_ONE - q_scale(2 * margin_counts, 32768, period_counts);
    const int32_t radius_q15 = q_max(q_min(limit_q15, widest_q15), SMALLEST_LIMIT_Q15);
    /* Both factors are whole numbers of counts; the limit is recomputed from them, so that the
     * applied voltage equals the commanded one. */
    const int32_t beta_counts = (int32_t)(((int64_t)period_counts * radius_q15) >> 15);
    const int32_t alpha_counts = (int32_t)((beta_counts * SQRT3_Q30 + (1 << 29)) >> 30);
    const modulation_t out = {
        .centre_q16 = period_counts * (1 << 15) + (1 << 15),
        .trim_doubled_counts = 2 * trim_counts,
        .alpha_counts = alpha_counts,
        .beta_counts = beta_counts,
        .limit_q15 = q_scale(beta_counts, 32768, period_counts),
    };
    return out;
}

int32_t modulation_dead_time_counts(const config_t *config, int32_t timer_Hz)
{
    /* Lost share of the bus voltage times the counts of the full swing: t_d f (1 + 2 V_f/v_dc). */
    const int64_t share_1e9 = bases_dead_time_share_1e9(config);
    const int32_t period_counts = bases_pwm_period_counts(config, timer_Hz);
    return q_saturate64((share_1e9 * period_counts + 500000000) / 1000000000);
}

modulation_t modulation_init(const config_t *config, int32_t timer_Hz)
{
    return modulation_of(bases_pwm_period_counts(config, timer_Hz),
                         bases_min_pulse_counts(config, timer_Hz),
                         modulation_dead_time_counts(config, timer_Hz),
                         config->current_loop.modulation_limit_pu_q15);
}

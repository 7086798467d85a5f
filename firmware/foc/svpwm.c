/* SPDX-License-Identifier: Apache-2.0 */
#include "foc/svpwm.h"

enum { SMALLEST_LIMIT_Q15 = 8192, ROUNDING_COUNTS = 2 };

svpwm_t svpwm_init(int32_t period_counts, int32_t min_pulse_counts, int32_t trim_counts,
                   int32_t wanted_limit_q15)
{
    /* A vector on the circle spans at most limit * period between its lines, so the outer pulses
     * keep period/2 (1 - limit) counts, of which the trim and the rounding may take their part. */
    const int32_t kept_counts = min_pulse_counts + trim_counts + ROUNDING_COUNTS;
    const int32_t widest_q15 = Q15_ONE - q_scale(2 * kept_counts, 32768, period_counts);
    const int32_t limit_q15 = q_max(q_min(wanted_limit_q15, widest_q15), SMALLEST_LIMIT_Q15);
    /* One modulation unit is that many counts between two lines. Both factors are whole numbers;
     * the limit is made to fit the one and the other to fit that, so that the voltage that is
     * realised is the voltage that was meant. sqrt 3 in Q30. */
    const int32_t beta_counts = (int32_t)(((int64_t)period_counts * limit_q15) >> 15);
    const int32_t alpha_counts = (int32_t)(((int64_t)beta_counts * 1859775393 + (1 << 29)) >> 30);
    const svpwm_t out = {
        .centre_q16 = period_counts * (1 << 15) + (1 << 15),
        .trim_doubled_counts = 2 * trim_counts,
        .alpha_counts = alpha_counts,
        .beta_counts = beta_counts,
        .modulation_limit_q15 = q_scale(beta_counts, 32768, period_counts),
    };
    return out;
}

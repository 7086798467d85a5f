/* SPDX-License-Identifier: Apache-2.0 */
#include "current_predictor.h"

#include "design_response.h"

/* 1/16: a smaller lag would leave a remainder of more than 16 LSB by rounding, an eighth of the
 * narrowest zone of the dead-time compensation. */
enum { SMALLEST_LAG_Q15 = 2048 };

/* a = b^2; m = 1 - a (1 + a)/2; the shares: DERIVATIONS.md, Current predictor. */
void current_predictor_init(current_predictor_t *predictor, const config_t *config)
{
    const int64_t one_q24 = DESIGN_ONE_Q24;
    const int64_t b_q24 = design_half_period_q24(config);
    const int64_t a_q24 = (b_q24 * b_q24) >> 24;
    const int64_t second_q24 = one_q24 - ((b_q24 * (one_q24 + a_q24)) >> 25);
    const int64_t weight_q24 = one_q24 - ((a_q24 * (one_q24 + a_q24)) >> 25);
    const int32_t lag_q15 = q_max(design_q15(one_q24 - a_q24), SMALLEST_LAG_Q15);
    const current_predictor_t out = {
        .lag_q16 = 2 * lag_q15,
        .first_q15 = design_q15((one_q24 - b_q24) / 2),
        .second_q15 = design_q15((b_q24 - a_q24) / 2),
        .weight_q15 = design_q15(weight_q24),
        .target_first_q15 = design_q15(one_q24 - ((one_q24 - b_q24) << 23) / weight_q24),
        .target_second_q15 = design_q15(one_q24 - (second_q24 << 24) / weight_q24),
    };
    *predictor = out;
}

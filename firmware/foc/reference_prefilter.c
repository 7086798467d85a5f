/* SPDX-License-Identifier: Apache-2.0 */
#include "reference_prefilter.h"

#include "design_response.h"

/* b0 = 1 / (b^2 (1 + b)), b2 = 1 - 1/b */
void reference_prefilter_init(reference_prefilter_t *prefilter, const config_t *config)
{
    const int64_t b_q24 = design_half_period_q24(config);
    const int64_t a_q24 = (b_q24 * b_q24) >> 24;
    const int64_t b0_inverse_q24 = (a_q24 * (DESIGN_ONE_Q24 + b_q24)) >> 24;
    const reference_prefilter_t out = {
        .one_minus_b0_q15 = design_q15(DESIGN_ONE_Q24 - (DESIGN_ONE_Q24 << 24) / b0_inverse_q24),
        .minus_b2_q15 = design_q15((DESIGN_ONE_Q24 << 24) / b_q24 - DESIGN_ONE_Q24),
    };
    *prefilter = out;
}

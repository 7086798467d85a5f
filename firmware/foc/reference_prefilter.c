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

static int32_t above_threshold(int32_t change)
{
    const bool small =
        change > -REFERENCE_PREFILTER_THRESHOLD_PU && change < REFERENCE_PREFILTER_THRESHOLD_PU;
    return small ? 0 : change;
}

reference_change_t reference_prefilter_take(reference_prefilter_t *prefilter, dq_t reference)
{
    reference_change_t change = {
        .reference = reference,
        .total = {.d = reference.d - prefilter->reference_pu.d,
                  .q = reference.q - prefilter->reference_pu.q},
        .before = prefilter->change_pu,
    };
    change.now.d = above_threshold(change.total.d);
    change.now.q = above_threshold(change.total.q);
    prefilter->reference_pu = reference;
    prefilter->change_pu = change.now;
    prefilter->settled = (change.now.d | change.now.q | change.before.d | change.before.q) == 0;
    return change;
}

/* b0 r[n] + b1 r[n-1] + b2 r[n-2] = r[n] - (1 - b0) (r[n] - r[n-1]) - b2 (r[n-1] - r[n-2]) */
static int32_t output(const reference_prefilter_t *prefilter, int32_t reference, int32_t now,
                      int32_t before)
{
    return reference + ((prefilter->minus_b2_q15 * before) >> 15) -
           ((prefilter->one_minus_b0_q15 * now) >> 15);
}

dq_t reference_prefilter_output(const reference_prefilter_t *prefilter,
                                const reference_change_t *change)
{
    const dq_t out = {
        .d = output(prefilter, prefilter->reference_pu.d, change->now.d, change->before.d),
        .q = output(prefilter, prefilter->reference_pu.q, change->now.q, change->before.q),
    };
    return out;
}

void reference_prefilter_reset(reference_prefilter_t *prefilter)
{
    const dq_t zero = {.d = 0, .q = 0};
    prefilter->reference_pu = zero;
    prefilter->change_pu = zero;
}

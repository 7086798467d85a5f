/* SPDX-License-Identifier: Apache-2.0 */
#include "current_predictor.h"

#include "design_response.h"

/* 1/16: a smaller lag would leave a remainder of more than 16 LSB by rounding, an eighth of the
 * narrowest zone of the dead-time compensation. */
enum { SMALLEST_LAG_Q15 = 2048 };

/* a = b^2; m = 1 - a (1 + a)/2; the shares: README, Current predictor. */
void current_predictor_init(current_predictor_t *predictor, const config_t *config)
{
    const int64_t one_q24 = DESIGN_ONE_Q24;
    const int64_t b_q24 = design_half_period_q24(config);
    const int64_t a_q24 = (b_q24 * b_q24) >> 24;
    const int64_t second_q24 = one_q24 - ((b_q24 * (one_q24 + a_q24)) >> 25);
    const int64_t weight_q24 = one_q24 - ((a_q24 * (one_q24 + a_q24)) >> 25);
    const current_predictor_t out = {
        .lag_q15 = q_max(design_q15(one_q24 - a_q24), SMALLEST_LAG_Q15),
        .first_q15 = design_q15((one_q24 - b_q24) / 2),
        .second_q15 = design_q15((b_q24 - a_q24) / 2),
        .weight_q15 = design_q15(weight_q24),
        .target_first_q15 = design_q15(one_q24 - ((one_q24 - b_q24) << 23) / weight_q24),
        .target_second_q15 = design_q15(one_q24 - (second_q24 << 24) / weight_q24),
    };
    *predictor = out;
}

static int32_t share_of(int32_t share_q15, int32_t change)
{
    return (share_q15 * change) >> 15;
}

void current_predictor_change(current_predictor_t *predictor, const reference_change_t *change,
                              dq_t settled)
{
    const int32_t first_q15 = predictor->first_q15;
    const int32_t second_q15 = predictor->second_q15;
    predictor->settled_pu = settled;
    predictor->remaining_pu.d += change->total.d + share_of(second_q15, change->before.d) -
                                 share_of(first_q15, change->now.d);
    predictor->remaining_pu.q += change->total.q + share_of(second_q15, change->before.q) -
                                 share_of(first_q15, change->now.q);
}

dq_t current_predictor_target(const current_predictor_t *predictor,
                              const reference_change_t *change)
{
    const int32_t first_q15 = predictor->target_first_q15;
    const int32_t second_q15 = predictor->target_second_q15;
    const dq_t target = {
        .d = change->reference.d - share_of(second_q15, change->before.d) -
             share_of(first_q15, change->now.d),
        .q = change->reference.q - share_of(second_q15, change->before.q) -
             share_of(first_q15, change->now.q),
    };
    return target;
}

void current_predictor_reset(current_predictor_t *predictor)
{
    const dq_t zero = {.d = 0, .q = 0};
    predictor->settled_pu = zero;
    predictor->remaining_pu = zero;
}

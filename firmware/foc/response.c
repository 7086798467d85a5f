/* SPDX-License-Identifier: Apache-2.0 */
#include "foc/response.h"

enum {
    SLOWEST_LAG_Q15 =
        2048 /* 1/16: less would leave more than 16 LSB undone, an eighth of the narrowest zone */
};

static const int64_t ONE_Q24 = 1 << 24;
static const int64_t PI_Q24 = 52707179;

/* b = exp(-y), y = w T/2 up to 1/4, by its second Pade approximation: right to y^5/720, less than
 * half a unit of Q15. */
static int64_t half_period_q24(const config_t *config)
{
    const int64_t exact_q24 =
        config->current_loop.bandwidth_Hz * PI_Q24 / config->drive.pwm_frequency_Hz;
    const int64_t y_q24 = exact_q24 < ONE_Q24 / 4 ? exact_q24 : ONE_Q24 / 4;
    const int64_t even_q24 = ONE_Q24 + ((y_q24 * y_q24) >> 24) / 12;
    return ((even_q24 - y_q24 / 2) << 24) / (even_q24 + y_q24 / 2);
}

/* To nearest. */
static int32_t q15_of(int64_t x_q24)
{
    return (int32_t)((x_q24 + (1 << 8)) >> 9);
}

void response_init(response_t *response, response_expected_t *expected, const config_t *config)
{
    const int64_t b_q24 = half_period_q24(config);
    const int64_t a_q24 = (b_q24 * b_q24) >> 24;
    const int64_t w1_inverse_q24 = (a_q24 * (ONE_Q24 + b_q24)) >> 24;
    const int64_t next_q24 = ONE_Q24 - ((b_q24 * (ONE_Q24 + a_q24)) >> 25);
    const int64_t nearer_q24 = ONE_Q24 - ((a_q24 * (ONE_Q24 + a_q24)) >> 25);
    const response_expected_t nothing = {.lag_q15 =
                                             q_max(q15_of(ONE_Q24 - a_q24), SLOWEST_LAG_Q15)};
    const response_t made = {
        .held_q15 = q15_of(ONE_Q24 - (ONE_Q24 << 24) / w1_inverse_q24),
        .exceeded_q15 = q15_of((ONE_Q24 << 24) / b_q24 - ONE_Q24),
        .begun_q15 = q15_of((ONE_Q24 - b_q24) / 2),
        .begun_next_q15 = q15_of((b_q24 - a_q24) / 2),
        .nearer_q15 = q15_of(nearer_q24),
        .short_q15 = q15_of(ONE_Q24 - ((ONE_Q24 - b_q24) << 23) / nearer_q24),
        .short_next_q15 = q15_of(ONE_Q24 - (next_q24 << 24) / nearer_q24),
    };
    *expected = nothing;
    *response = made;
}

static int32_t share_of(int32_t share_q15, int32_t change)
{
    return (share_q15 * change) >> 15;
}

static int32_t worth_shaping(int32_t change)
{
    return change > -RESPONSE_LEAST_PU && change < RESPONSE_LEAST_PU ? 0 : change;
}

/* One axis: reference and aim, and what is missing of the current. change: now, before: one period
 * ago, within 2^16. */
static void shape(const response_t *response, int32_t change, int32_t before, int32_t *reference,
                  int32_t *aim, int32_t *behind)
{
    *reference += share_of(response->exceeded_q15, before) - share_of(response->held_q15, change);
    *aim -= share_of(response->short_next_q15, before) + share_of(response->short_q15, change);
    *behind += share_of(response->begun_next_q15, before) - share_of(response->begun_q15, change);
}

response_given_t response_follow(response_t *response, dq_t reference,
                                 response_expected_t *expected, dq_t mean)
{
    const dq_t before = response->change_pu;
    const int32_t change_d = reference.d - response->reference_pu.d;
    const int32_t change_q = reference.q - response->reference_pu.q;
    const dq_t change = {.d = worth_shaping(change_d), .q = worth_shaping(change_q)};
    response->reference_pu = reference;
    response->change_pu = change;
    response->settled = (change.d | change.q | before.d | before.q) == 0;
    expected->settled_pu = mean;
    expected->behind_pu.d += change_d;
    expected->behind_pu.q += change_q;
    response_given_t given = {.reference_pu = reference, .aim_pu = reference};
    if (!response->settled) {
        shape(response, change.d, before.d, &given.reference_pu.d, &given.aim_pu.d,
              &expected->behind_pu.d);
        shape(response, change.q, before.q, &given.reference_pu.q, &given.aim_pu.q,
              &expected->behind_pu.q);
    }
    return given;
}

void response_rest(response_t *response, response_expected_t *expected)
{
    const dq_t nothing = {.d = 0, .q = 0};
    response->reference_pu = nothing;
    expected->settled_pu = nothing;
    expected->behind_pu = nothing;
    response->change_pu = nothing;
}

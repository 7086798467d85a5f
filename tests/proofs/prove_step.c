/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Between the boxes of the fast reach: what becomes of a command.
 */
#include "foc/foc.h"
#include "proof.h"

static current_loop_tuning_t no_tuning(void)
{
    const current_loop_tuning_t out = {.forward_d_q25 = 0};
    return out;
}

/* The limiter of the current vector: any command and any field weakening. What the circle leaves of
 * q beside any d is proved of circle_other(). */
static void follow_any_command(int32_t radius)
{
    static foc_state_t state;
    state.current_circle = circle_init(radius);
    state.weakening.current_q28 = any_within(-32767 * 8192, 0);
    response_t *response =
        &state.response; /* without shares: what they make of a change is the next proof */
    response->reference_pu.d = any_within(-32768, 32768);
    response->reference_pu.q = any_within(-32768, 32768);
    response->change_pu.d = any_within(-65536, 65536);
    response->change_pu.q = any_within(-65536, 65536);
    state.current.expected.behind_pu.d = any_within(-65536, 65536);
    state.current.expected.behind_pu.q = any_within(-65536, 65536);
    const foc_command_t command = {
        .number = nondet_uint16(),
        .i_d_mean_less_sample_pu = 0, /* the mean goes through the same limiter */
        .i_reference_pu = {.d = nondet_int16(), .q = nondet_int16()},
        .tuning = no_tuning(),
    };
    foc_period_t period;
    foc_follow(&state, &command, &period);
    const dq_t reference = response->reference_pu;
    PROMISE(reference.d >= -radius && reference.d <= radius);
    PROMISE(command.i_reference_pu.q >= 0
                ? reference.q >= 0 && reference.q <= command.i_reference_pu.q
                : reference.q <= 0 && reference.q >= command.i_reference_pu.q);
    const dq_t given = period.i_reference_pu;
    PROMISE(given.d >= -radius && given.d <= radius && given.q >= -radius && given.q <= radius);
    if (state.followed == FOC_NOTHING_FOLLOWED) {
        PROMISE(!response->settled); /* the next period looks again */
    } else {
        PROMISE(state.followed == command.number && given.d == reference.d &&
                given.q == reference.q);
    }
}

void prove_reference_in_the_papers_circle(void)
{
    follow_any_command(14895);
    PROOF_END();
}

void prove_reference_in_the_largest_circle(void)
{
    follow_any_command(Q15_ONE);
    PROOF_END();
}

/* The largest shares that response_init() makes (tests/unit): smaller ones overflow less. */
void prove_shape(void)
{
    response_t response = {
        .held_q15 = 16384,
        .exceeded_q15 = 9400,
        .begun_q15 = 4096,
        .begun_next_q15 = 4096,
        .nearer_q15 = 17040,
        .short_q15 = 27525,
        .short_next_q15 = 11141,
        .reference_pu = {.d = any_within(-32768, 32768), .q = any_within(-32768, 32768)},
        .change_pu = {.d = any_within(-65536, 65536), .q = any_within(-65536, 65536)},
    };
    response_expected_t expected = {
        .behind_pu = {.d = any_within(-65536, 65536), .q = any_within(-65536, 65536)},
    };
    const dq_t reference = {.d = any_within(-32768, 32768), .q = any_within(-32768, 32768)};
    const response_given_t given = response_follow(&response, reference, &expected, reference);
    PROMISE(response.reference_pu.d == reference.d && response.reference_pu.q == reference.q);
    PROMISE(given.reference_pu.d >= -131072 && given.reference_pu.d <= 131072);
    PROMISE(given.reference_pu.q >= -131072 && given.reference_pu.q <= 131072);
    PROMISE(!response.settled ||
            (given.reference_pu.d == reference.d && given.reference_pu.q == reference.q));
    PROOF_END();
}

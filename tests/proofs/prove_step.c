/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Fast loop: a setpoint is applied.
 */
#include "core/circle.h"
#include "current_predictor.h"
#include "fast_ranges.h"
#include "proof.h"
#include "reference_prefilter.h"

/* circle_other() replaced by its specification, which prove_circle_of_any_radius() proves for every
 * circle of circle_init(): for |x| up to the radius the result is within zero and the radius. The
 * function's own products would take the checker a minute. */
static int32_t circle_other_by_contract(const circle_t *circle, int32_t x)
{
    PROVE(circle->radius_q15 >= 164 && circle->radius_q15 <= Q15_ONE);
    PROVE(circle->inverse_q14 == (1 << 29) / circle->radius_q15 + 1);
    PROVE(x >= -circle->radius_q15 && x <= circle->radius_q15);
    return any_within(0, circle->radius_q15);
}
#define circle_other circle_other_by_contract
#include "setpoint.c"

static current_tuning_t no_tuning(void)
{
    const current_tuning_t out = {.forward_d_q25 = 0};
    return out;
}

/* The limiter of the current vector: any setpoint and any field weakening. */
static void apply_any_setpoint(int32_t radius)
{
    static foc_state_t state;
    state.current_circle = circle_init(radius);
    state.weakening.current_q28 = any_within(-32767 * 8192, 0);
    reference_prefilter_t *prefilter = &state.prefilter; /* coefficients: the next proof */
    prefilter->reference_pu.d = any_within(-32768, 32768);
    prefilter->reference_pu.q = any_within(-32768, 32768);
    prefilter->change_pu.d = any_within(-65536, 65536);
    prefilter->change_pu.q = any_within(-65536, 65536);
    state.current.predictor.settled_pu.v =
        q_pair(any_within(-32768, 32767), any_within(-32768, 32767));
    state.current.predictor.predicted_pu.v =
        q_pair(any_within(-32768, 32767), any_within(-32768, 32767));
    const fast_setpoint_t setpoint = {
        .sequence = nondet_uint16(),
        .i_d_sampling_correction_pu = nondet_int32(),
        .i_reference_pu = {.d = nondet_int16(), .q = nondet_int16()},
        .tuning = no_tuning(),
    };
    apply(&state, &setpoint);
    const dq_t reference = prefilter->reference_pu;
    PROVE(reference.d >= -radius && reference.d <= radius);
    PROVE(setpoint.i_reference_pu.q >= 0
              ? reference.q >= 0 && reference.q <= setpoint.i_reference_pu.q
              : reference.q <= 0 && reference.q >= setpoint.i_reference_pu.q);
    const dq_t given = dq_of(state.period.i_reference_pu);
    PROVE(given.d >= -radius && given.d <= radius && given.q >= -radius && given.q <= radius);
    if (state.sequence == FOC_NO_SETPOINT) {
        PROVE(!prefilter->settled); /* the next period checks again */
    } else {
        PROVE(state.sequence == setpoint.sequence && given.d == reference.d &&
              given.q == reference.q);
    }
}

void prove_reference_in_the_papers_circle(void)
{
    apply_any_setpoint(14895);
    PROOF_END();
}

void prove_reference_in_the_largest_circle(void)
{
    apply_any_setpoint(Q15_ONE);
    PROOF_END();
}

static reference_change_t any_change(void)
{
    reference_change_t out;
    ASSUME(change_holds(&out));
    return out;
}

/* The largest coefficients of the initialisation (tests/unit); the products of smaller ones are
 * smaller. */
void prove_change_of_reference(void)
{
    reference_prefilter_t prefilter;
    current_predictor_t predictor;
    ASSUME(prefilter_holds(&prefilter) && predictor_holds(&predictor));
    prefilter.one_minus_b0_q15 = MOST_ONE_MINUS_B0_Q15;
    prefilter.minus_b2_q15 = MOST_MINUS_B2_Q15;
    predictor.first_q15 = MOST_SHARE_Q15;
    predictor.second_q15 = MOST_SHARE_Q15;
    const dq_t reference = {.d = any_within(-32768, 32768), .q = any_within(-32768, 32768)};
    const dq_t mean = {.d = any_within(-32768, 32767), .q = any_within(-32768, 32767)};
    const reference_change_t change = reference_prefilter_take(&prefilter, reference);
    PROVE(prefilter.reference_pu.d == reference.d && prefilter.reference_pu.q == reference.q);
    PROVE(prefilter_holds(&prefilter) && change_holds(&change));
    const dq_t out = reference_prefilter_output(&prefilter, &change);
    current_predictor_change(&predictor, &change, mean, nondet_bool());
    PROVE(predictor_holds(&predictor));
    PROVE(vector_holds(out, 131072));
    PROVE(!prefilter.settled || (out.d == reference.d && out.q == reference.q));
    PROOF_END();
}

/* The target is linear in each of the two coefficients, so it is largest at the ends of their
 * ranges; the other products are smaller. */
static void prove_target_with(int32_t first_q15, int32_t second_q15)
{
    const current_predictor_t predictor = {.target_first_q15 = first_q15,
                                           .target_second_q15 = second_q15};
    const reference_change_t change = any_change();
    PROVE(vector_holds(current_predictor_target(&predictor, &change), MOST_TARGET_PU));
    PROOF_END();
}

void prove_target_of_the_least_coefficients(void)
{
    prove_target_with(LEAST_TARGET_FIRST_Q15, LEAST_TARGET_SECOND_Q15);
}

void prove_target_of_the_least_and_the_largest(void)
{
    prove_target_with(LEAST_TARGET_FIRST_Q15, MOST_TARGET_SECOND_Q15);
}

void prove_target_of_the_largest_and_the_least(void)
{
    prove_target_with(MOST_TARGET_FIRST_Q15, LEAST_TARGET_SECOND_Q15);
}

void prove_target_of_the_largest_coefficients(void)
{
    prove_target_with(MOST_TARGET_FIRST_Q15, MOST_TARGET_SECOND_Q15);
}

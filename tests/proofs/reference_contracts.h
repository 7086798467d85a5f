/* SPDX-License-Identifier: Apache-2.0 */
/*
 * reference_contracts.h: predictor and prefilter of the current reference by their contracts, for
 * prove_composition.c.
 */
#ifndef REFERENCE_CONTRACTS_H
#define REFERENCE_CONTRACTS_H

#include "current_predictor.h"
#include "fast_ranges.h"
#include "reference_prefilter.h"

/* prove_change_of_reference */
static void current_predictor_change_by_contract(current_predictor_t *predictor,
                                                 const reference_change_t *change, dq_t settled,
                                                 bool in_first_periods)
{
    (void)in_first_periods;
    PROVE(predictor_holds(predictor) && change_holds(change));
    PROVE(within(settled.d, Q15_MIN, Q15_ONE) && within(settled.q, Q15_MIN, Q15_ONE));
    predictor->settled_pu = dq16_of(settled);
    predictor->predicted_pu.v = any_pair();
    ASSUME(predictor_holds(predictor));
}
#define current_predictor_change current_predictor_change_by_contract

/* prove_target_with */
static dq_t current_predictor_target_by_contract(const current_predictor_t *predictor,
                                                 const reference_change_t *change)
{
    const dq_t out = {.d = any_within(-MOST_TARGET_PU, MOST_TARGET_PU),
                      .q = any_within(-MOST_TARGET_PU, MOST_TARGET_PU)};
    PROVE(predictor_holds(predictor) && change_holds(change));
    return out;
}
#define current_predictor_target current_predictor_target_by_contract

/* prove_change_of_reference */
static dq_t reference_prefilter_output_by_contract(const reference_prefilter_t *prefilter,
                                                   const reference_change_t *change)
{
    const dq_t out = {.d = any_within(-131072, 131072), .q = any_within(-131072, 131072)};
    PROVE(prefilter_holds(prefilter) && change_holds(change));
    return out;
}
#define reference_prefilter_output reference_prefilter_output_by_contract

#endif

/* SPDX-License-Identifier: Apache-2.0 */
/*
 * field_weakening.h: demagnetising d current at the voltage limit, driving and braking alike. An
 * integrator of the voltage margin: a voltage above current_loop.modulation_target lowers i_d, one
 * below returns it to zero. Once in four PWM periods, because the margin changes with the speed.
 */
#ifndef FOC_FIELD_WEAKENING_H
#define FOC_FIELD_WEAKENING_H

#include <stdint.h>

#include "core/frames.h"
#include "core/q15.h"
#include "foc/state.h"
#include "modulation_index.h"

/* The current to add to the d reference, Q15, <= 0. */
static inline int32_t field_weakening_current_pu(const field_weakening_t *state)
{
    return state->current_q28 >> 13;
}

static inline void field_weakening_init(field_weakening_t *state, const config_t *config)
{
    const int32_t target_q15 = config->current_loop.modulation_target_pu_q15;
    state->current_q28 = 0;
    state->target_square_q15 = (target_q15 * target_q15 + (1 << 14)) >> 15;
}

/* Remaining squared voltage, below the target's: -1.75 .. 0.96. */
static inline int32_t field_weakening_margin_q15(const field_weakening_t *state, dq_t unsaturated)
{
    return state->target_square_q15 - modulation_index_square_q15(unsaturated);
}

/* Four periods. gain_q15: current per unit of missing squared voltage and period, 0 .. 32 767; the
 * product of one period in Q30 is that of four in Q28. limit_q15: largest demagnetising current; 0
 * switches field weakening off. */
static inline void field_weakening_step(field_weakening_t *state, int32_t margin_q15,
                                        int32_t gain_q15, int32_t limit_q15)
{
    state->current_q28 =
        q_clamp(state->current_q28 + q_saturate16(margin_q15) * gain_q15, -(limit_q15 * 8192), 0);
}

#endif

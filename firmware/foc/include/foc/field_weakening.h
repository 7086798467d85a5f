/* SPDX-License-Identifier: Apache-2.0 */
/*
 * field_weakening.h: demagnetising current when the voltage runs out.
 *
 * An integrator on the voltage margin: when the voltage the current loop wants comes nearer to the
 * circle than the margin, i_d is lowered; when there is voltage to spare, it returns to zero. Works
 * the same driving and braking. The margin moves with the speed and is looked at every fourth PWM
 * period.
 */
#ifndef FOC_FIELD_WEAKENING_H
#define FOC_FIELD_WEAKENING_H

#include <stdint.h>

#include "core/q15.h"

enum {
    FIELD_WEAKENING_AIM_Q15 =
        30760, /* of |u|^2: the loop keeps 3 % of the voltage for its dynamics */
    FIELD_WEAKENING_AIM_VOLTAGE_Q15 = 31748 /* the same of |u| */
};

typedef struct {
    int32_t current_q28; /* -most .. 0 */
} field_weakening_t;

/* The current to add to the d reference, Q15, <= 0. */
static inline int32_t field_weakening_current_pu(const field_weakening_t *state)
{
    return state->current_q28 >> 13;
}

/* What is left of the squared voltage, -1.06 .. 0.94. d: voltage of this step inside its limit, q:
 * before its limit; modulation units (1.0 = the circle). */
static inline int32_t field_weakening_margin_q15(int32_t d, int32_t q)
{
    const int32_t limited_q = q_saturate16(q);
    const uint32_t square_q30 = (uint32_t)(d * d) + (uint32_t)(limited_q * limited_q); /* up to 2 */
    return FIELD_WEAKENING_AIM_Q15 - (int32_t)(square_q30 >> 15);
}

/* Four periods. With a margin and no current there is nothing to do, and no need to call. gain_q15:
 * current per unit of missing squared voltage and period, 0 .. 32767; the product of one period in
 * Q30 is that of four in Q28. most_q15: largest demagnetising current, 0 = off. */
static inline void field_weakening_step(field_weakening_t *state, int32_t margin_q15,
                                        int32_t gain_q15, int32_t most_q15)
{
    state->current_q28 =
        q_clamp(state->current_q28 + q_saturate16(margin_q15) * gain_q15, -(most_q15 * 8192), 0);
}

#endif

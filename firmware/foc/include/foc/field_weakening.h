/*
 * field_weakening.h: demagnetising current when the voltage runs out.
 *
 * An integrator on the voltage margin: when the voltage the current loop wants comes nearer to the circle than the
 * margin, i_d is lowered; when there is voltage to spare, it returns to zero. Works the same driving and braking.
 */
#ifndef FOC_FIELD_WEAKENING_H
#define FOC_FIELD_WEAKENING_H

#include <stdint.h>

#include "core/q15.h"

enum { FIELD_WEAKENING_AIM_Q15 = 30760 /* of |u|^2: the loop keeps 3 % of the voltage for its dynamics */ };

typedef struct {
    int32_t current_q30; /* -most .. 0 */
} field_weakening_t;

/* The current to add to the d reference, Q15, <= 0. */
static inline int32_t field_weakening_current_pu(const field_weakening_t *state)
{
    return state->current_q30 >> 15;
}

/* wanted_d, wanted_q: voltage of this step before its limit, modulation units (1.0 = the circle). gain_q15: current per
 * unit of missing squared voltage and period, 0 .. 32767. most_q15: largest demagnetising current, 0 = off. */
static inline void field_weakening_step(field_weakening_t *state, int32_t wanted_d, int32_t wanted_q, int32_t gain_q15,
                                        int32_t most_q15)
{
    const int32_t d = q_saturate16(wanted_d);
    const int32_t q = q_saturate16(wanted_q);
    const uint32_t square_q30 = (uint32_t)(d * d) + (uint32_t)(q * q);                /* up to 2 */
    const int32_t margin_q15 = FIELD_WEAKENING_AIM_Q15 - (int32_t)(square_q30 >> 15); /* -1.06 .. 0.94 */
    if (margin_q15 < 0 || state->current_q30 != 0) {
        state->current_q30 = q_clamp(state->current_q30 + q_saturate16(margin_q15) * gain_q15, -(most_q15 * 32768), 0);
    }
}

#endif

/* SPDX-License-Identifier: Apache-2.0 */
/*
 * modulation.h: space-vector modulation by min/max injection, and dead-time compensation.
 *
 * The pulses are centred in the period: the low-side and the high-side margins are equal. Line
 * voltages are exact to one timer count. A vector inside the unit circle plus the largest dead-time
 * correction always keeps the shortest pulse (modulation_init()), so nothing is clamped here and
 * the voltage of the current controller is the applied one.
 *
 * Dead-time compensation: a leg loses sign(i) t_d (v_dc + 2 V_f)/T of its mean voltage. The on-time
 * is corrected by that, proportionally to the current inside a zone around zero (DERIVATIONS.md,
 * Dead time).
 */
#ifndef FOC_MODULATION_H
#define FOC_MODULATION_H

#include <stdint.h>

#include "config/config.h"
#include "core/fast_messages.h"
#include "core/frames.h"
#include "core/q15.h"
#include "foc/state.h"

/* For the configured period, shortest pulse and dead time in counts of the port's timer; the circle
 * of the configuration is reduced if the shortest pulse and the correction need it, never below a
 * quarter. Divides. */
modulation_t modulation_init(const config_t *config, int32_t timer_Hz);

/* The same from plain numbers; trim_counts: full dead-time correction, 0 .. 2048. */
modulation_t modulation_of(int32_t period_counts, int32_t min_pulse_counts, int32_t trim_counts,
                           int32_t limit_q15);

/* Full dead-time correction of the configuration, counts, at the battery's middle voltage. */
int32_t modulation_dead_time_counts(const config_t *config, int32_t timer_Hz);

/* Half the period on every leg. */
static inline void modulation_centre(const modulation_t *modulation, int32_t on_q16[SENSE_PHASES])
{
    for (int x = 0; x < SENSE_PHASES; x++) {
        on_q16[x] = modulation->centre_q16;
    }
}

/*
 * Dead-time correction of each phase as a share of the full one, Q15, -1 .. 1. i: predicted
 * current, |i| <= 1.007. Phase a is alpha, b and c are +-sqrt(3)/2 beta - alpha/2, over the zone.
 */
Q_TARGET_INLINE abc_t modulation_dead_time(dead_time_slope_t slope, ab_t i)
{
    const int32_t alpha_q23 = i.alpha * slope.alpha_q8;
    const int32_t beta_q23 = i.beta * slope.beta_q8;
    const int32_t half_alpha_q23 = alpha_q23 >> 1;
    const abc_t out = {
        .a = q_saturate16(alpha_q23 >> 8),
        .b = q_saturate16((beta_q23 - half_alpha_q23) >> 8),
        .c = -q_saturate16((beta_q23 + half_alpha_q23) >> 8),
    };
    return out;
}

/*
 * On-times from the voltage u, inside the unit circle, and the shares of modulation_dead_time().
 * Relative to -alpha/2 the phases are a = 3/2 alpha, b = sqrt(3)/2 beta and -b, here in counts. The
 * part of a outside -|b| .. |b| makes a the outermost phase; minus half of it centres the three.
 */
Q_TARGET_INLINE void modulation_step(const modulation_t *modulation, ab_t u, abc_t trim_q15,
                                     int32_t on_q16[SENSE_PHASES])
{
    const int32_t trim = modulation->trim_doubled_counts;
    const int32_t a_q16 = u.alpha * modulation->alpha_counts;
    const int32_t b_q16 = u.beta * modulation->beta_counts;
    const int32_t b_size_q16 = b_q16 < 0 ? -b_q16 : b_q16;
    const int32_t outside_q16 = q_positive(a_q16 - b_size_q16) + q_negative(a_q16 + b_size_q16);
    const int32_t centre_q16 = modulation->centre_q16 - (outside_q16 >> 1);
    const int32_t on_a_q16 = trim_q15.a * trim + centre_q16 + a_q16;
    /* The rounding error of a leg is added to the other legs as far as they can follow. */
    const int32_t from_a_q16 = centre_q16 - (int32_t)((uint32_t)on_a_q16 & 0xFFFFU) + 0x8000;
    const int32_t on_b_q16 = trim_q15.b * trim + from_a_q16 + b_q16;
    const int32_t from_b_q16 = from_a_q16 - (int32_t)(((uint32_t)on_b_q16 & 0xFFFFU) >> 1) + 0x4000;
    on_q16[0] = on_a_q16;
    on_q16[1] = on_b_q16;
    on_q16[2] = trim_q15.c * trim + from_b_q16 - b_q16;
}

#endif

/* SPDX-License-Identifier: Apache-2.0 */
/*
 * svpwm.h: space-vector modulation by min/max injection.
 *
 * Input in modulation units: 1.0 = modulation_limit * u_dc/sqrt 3. With u_0 = -(max + min)/2 added
 * to all phases the three line voltages are untouched and the pulses are centred in the period, so
 * the low-side and the high-side margins are equal. Because the three phases add up to zero, (max +
 * min)/2 is minus half of the middle one.
 *
 * The line voltages are realised to within one timer count. The unit circle was chosen such that a
 * vector inside it, plus the largest trim, leaves the shortest pulse on either side (svpwm_init()):
 * nothing is clamped here, so what the current loop was told is what happens.
 */
#ifndef FOC_SVPWM_H
#define FOC_SVPWM_H

#include <stdint.h>

#include "core/frames.h"
#include "core/q15.h"
#include "foc/transforms.h"

typedef struct {
    int32_t centre_q16;          /* half the period in counts, and half a count for rounding */
    int32_t trim_doubled_counts; /* twice the full dead-time correction, 0 .. 4096 */
    int32_t alpha_counts,
        beta_counts; /* sqrt(3) * limit * period and limit * period, of one modulation unit */
    int32_t modulation_limit_q15; /* radius of the circle that was chosen, share of u_dc/sqrt 3 */
} svpwm_t;

/* wanted_limit_q15: from the configuration; made smaller if the shortest pulse and the trim need
 * it, never below a quarter. Divides. */
svpwm_t svpwm_init(int32_t period_counts, int32_t min_pulse_counts, int32_t trim_counts,
                   int32_t wanted_limit_q15);

/*
 * u: modulation units, within the unit circle. trim_q15: share of trim_counts added to each phase,
 * for dead time.
 *
 * Counted from -alpha/2, the phases are a = 3/2 alpha, b = sqrt(3)/2 beta and -b; in on-times,
 * times limit * period / sqrt 3. Half of a lies above |b|, or below -|b|, by how much it is the
 * outermost one; minus half of that centres the three.
 */
Q_TARGET_INLINE void svpwm_step(const svpwm_t *svpwm, ab_t u, abc_t trim_q15, int32_t on_q16[3])
{
    const int32_t trim = svpwm->trim_doubled_counts;
    const int32_t a_q16 = u.alpha * svpwm->alpha_counts;
    const int32_t b_q16 = u.beta * svpwm->beta_counts;
    const int32_t b_size_q16 = b_q16 < 0 ? -b_q16 : b_q16;
    const int32_t outside_q16 = q_max(a_q16 - b_size_q16, 0) + q_min(a_q16 + b_size_q16, 0);
    const int32_t centre_q16 = svpwm->centre_q16 - (outside_q16 >> 1);
    const int32_t on_a_q16 = trim_q15.a * trim + centre_q16 + a_q16;
    /* What rounding does to one leg is done to the others too, as far as they can follow. */
    const int32_t from_a_q16 = centre_q16 - (int32_t)((uint32_t)on_a_q16 & 0xFFFFU) + 0x8000;
    const int32_t on_b_q16 = trim_q15.b * trim + from_a_q16 + b_q16;
    const int32_t from_b_q16 = from_a_q16 - (int32_t)(((uint32_t)on_b_q16 & 0xFFFFU) >> 1) + 0x4000;
    on_q16[0] = on_a_q16;
    on_q16[1] = on_b_q16;
    on_q16[2] = trim_q15.c * trim + from_b_q16 - b_q16;
}

#endif

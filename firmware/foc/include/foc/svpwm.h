/*
 * svpwm.h: space-vector modulation by min/max injection.
 *
 * Input in modulation units: 1.0 = modulation_limit * u_dc/sqrt 3. With u_0 = -(max + min)/2 added to all phases the
 * three line voltages are untouched and the pulses are centred in the period, so the low-side and the high-side margins
 * are equal. Because the three phases add up to zero, (max + min)/2 is minus half of the middle one.
 *
 * The line voltages are realised to within one timer count. The unit circle was chosen such that a vector inside it,
 * plus the largest trim, leaves the shortest pulse on either side (svpwm_init()): nothing is clamped here, so what
 * the current loop was told is what happens.
 */
#ifndef FOC_SVPWM_H
#define FOC_SVPWM_H

#include <stdint.h>

#include "core/frames.h"
#include "core/q15.h"
#include "foc/transforms.h"

typedef struct {
    int32_t centre_q16;           /* half the period in counts, and half a count for rounding */
    int32_t trim_doubled_counts;  /* twice the full dead-time correction, 0 .. 4096 */
    int32_t scale_counts;         /* counts of one modulation unit: limit * period / sqrt 3 */
    int32_t modulation_limit_q15; /* radius of the circle that was chosen, share of u_dc/sqrt 3 */
} svpwm_t;

/* wanted_limit_q15: from the configuration; made smaller if the shortest pulse and the trim need it, never below a
 * quarter. Divides. */
svpwm_t svpwm_init(int32_t period_counts, int32_t min_pulse_counts, int32_t trim_counts, int32_t wanted_limit_q15);

/*
 * u: modulation units, within the unit circle. trim_q15: share of trim_counts added to each phase, for dead time.
 *
 * With B = sqrt(3)/2 beta and h = alpha/2 the phases are 2h, B - h and -B - h. Counted from -h they are 3h, B and -B, and the
 * middle one is 3h clamped to +-|B|; half of it, less the 3h that make all sum to zero, centres them. All of them are kept
 * doubled, so that halving loses nothing.
 */
Q_TARGET_INLINE void svpwm_step(const svpwm_t *svpwm, ab_t u, abc_t trim_q15, uint16_t compare_counts[3])
{
    const int32_t scale = svpwm->scale_counts;
    const int32_t trim = svpwm->trim_doubled_counts;
    const int32_t b = (u.beta * TRANSFORMS_SQRT3_2_Q15) >> 14;
    const int32_t b_size = b < 0 ? -b : b;
    const int32_t a = 3 * u.alpha;
    const int32_t middle = q_limit(a, b_size);
    const int32_t centre_q16 = ((middle - a) >> 1) * scale + svpwm->centre_q16;
    compare_counts[0] = (uint16_t)((a * scale + (trim_q15.a * trim + centre_q16)) >> 16);
    compare_counts[1] = (uint16_t)((b * scale + (trim_q15.b * trim + centre_q16)) >> 16);
    compare_counts[2] = (uint16_t)((trim_q15.c * trim + centre_q16 - b * scale) >> 16);
}

#endif

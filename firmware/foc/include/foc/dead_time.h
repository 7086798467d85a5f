/*
 * dead_time.h: giving back the voltage that dead time takes.
 *
 * During both dead intervals of a period the sign of the phase current decides which diode conducts: the leg's mean
 * voltage is wrong by -sign(i) t_d f_pwm v_dc. The compensation lengthens or shortens the high-side pulse by half the
 * dead time in each half period; within a zone around zero current, where the dead interval may end without current, it
 * is proportional to the current.
 *
 * The current that counts is the one that will flow while the voltage acts. The reference, rotated to that moment, is the
 * best estimate of it: it leads where a measurement lags, and it has no noise.
 */
#ifndef FOC_DEAD_TIME_H
#define FOC_DEAD_TIME_H

#include <stdint.h>

#include "config/config.h"
#include "core/frames.h"
#include "core/q15.h"
#include "foc/transforms.h"

typedef struct {
    int32_t full_counts;                   /* correction outside the zone, 0 .. 2048 */
    int32_t slope_alpha_q8, slope_beta_q8; /* 1 and sqrt(3)/2 over the zone */
} dead_time_t;

/* Divides. */
dead_time_t dead_time_init(const config_t *config);

/*
 * i: the expected current, |i| <= 1. For each phase the share of the full correction to add, Q15, -1 .. 1.
 * With alpha and sqrt(3)/2 beta, both over the zone, the phases are the first, and plus or minus the second less its half.
 */
Q_TARGET_INLINE abc_t dead_time_shares(const dead_time_t *dead_time, ab_t i)
{
    const int32_t alpha_q23 = i.alpha * dead_time->slope_alpha_q8;
    const int32_t beta_q23 = i.beta * dead_time->slope_beta_q8;
    const int32_t half_alpha_q23 = alpha_q23 >> 1;
    const abc_t out = {
        .a = q_saturate16(alpha_q23 >> 8),
        .b = q_saturate16((beta_q23 - half_alpha_q23) >> 8),
        .c = -q_saturate16((beta_q23 + half_alpha_q23) >> 8),
    };
    return out;
}

#endif

/* SPDX-License-Identifier: Apache-2.0 */
/*
 * dead_time.h: giving back the voltage that dead time takes.
 *
 * During both dead intervals of a period the sign of the phase current decides which diode
 * conducts: the leg's mean voltage is wrong by -sign(i) t_d f_pwm (v_dc + 2 V_f). The compensation
 * lengthens or shortens the high-side pulse by half of that, in time, in each half period, with the
 * diodes' drop as a share of the battery's middle voltage (bases_dead_time_share_1e9()); within a
 * zone around zero current, where the dead interval may end without current, it is proportional to
 * the current. What can end is what the lost voltage moves in a period, t_d (v_dc + 2 V_f) / L: the
 * zone goes with the bus voltage, so that in volts the compensation's slope is always L/T.
 *
 * The current that counts is the one that will flow while the voltage acts, in the middle of
 * that 1.5 periods after the sample. It is worked out from the reference (response_expect()), which
 * has no noise, and not from a measurement, which lags.
 */
#ifndef FOC_DEAD_TIME_H
#define FOC_DEAD_TIME_H

#include <stdint.h>

#include "config/config.h"
#include "core/frames.h"
#include "core/q15.h"
#include "foc/transforms.h"

typedef struct {
    int32_t alpha_q8, beta_q8; /* 1 and sqrt(3)/2 over the zone */
} dead_time_slope_t;

typedef struct {
    int32_t full_counts;     /* correction outside the zone, 0 .. 2048 */
    dead_time_slope_t slope; /* for the present bus voltage, from the slow reach */
} dead_time_t;

/* For the middle of the battery's range. Divides. */
dead_time_t dead_time_init(const config_t *config);

/* v_dc_pu: bus voltage, Q15 of the voltage base; values below 1/16 count as 1/16. Divides: slow
 * reach. */
dead_time_slope_t dead_time_slope_at(const config_t *config, int32_t v_dc_pu);

/*
 * i: the expected current, |i| <= 1.007. For each phase the share of the full correction to add,
 * Q15, -1 .. 1. With alpha and sqrt(3)/2 beta, both over the zone, the phases are the first, and
 * plus or minus the second less its half.
 */
Q_TARGET_INLINE abc_t dead_time_shares(const dead_time_t *dead_time, ab_t i)
{
    const int32_t alpha_q23 = i.alpha * dead_time->slope.alpha_q8;
    const int32_t beta_q23 = i.beta * dead_time->slope.beta_q8;
    const int32_t half_alpha_q23 = alpha_q23 >> 1;
    const abc_t out = {
        .a = q_saturate16(alpha_q23 >> 8),
        .b = q_saturate16((beta_q23 - half_alpha_q23) >> 8),
        .c = -q_saturate16((beta_q23 + half_alpha_q23) >> 8),
    };
    return out;
}

#endif

/*
 * dead_time.h: giving back the voltage that dead time takes.
 *
 * During both dead intervals of a period the sign of the phase current decides which diode conducts: the leg's mean
 * voltage is wrong by -sign(i) t_d f_pwm (v_dc + 2 V_f). The compensation lengthens or shortens the high-side pulse by half of
 * that, in time, in each half period, with the diodes' drop as a share of the battery's middle voltage
 * (bases_dead_time_share_1e9()); within a zone around zero current, where the dead interval may end without current, it is
 * proportional to the current.
 *
 * The current that counts is the one that will flow while the voltage acts, in the middle of that 1.5 periods after the
 * sample. It is worked out from the reference, which has no noise, and not from a measurement, which lags: from then on the
 * current loop answers like a first-order system (current_loop.h), so what is still missing of a reference shrinks by 1 -
 * exp(-w T) every period. In the very first one the sampled loop has begun already: it goes w T/(1 + 2 w T) of the way,
 * half of that on average, for which a sixteenth stands (0.05 to 0.11 do as well). Filtered like this a reference inside the
 * circle stays there, but for 24 LSB of rounding.
 */
#ifndef FOC_DEAD_TIME_H
#define FOC_DEAD_TIME_H

#include <stdint.h>

#include "config/config.h"
#include "core/frames.h"
#include "core/q15.h"
#include "foc/transforms.h"

enum { DEAD_TIME_BEGUN_LOG2 = 4 /* of a change, when the first voltage acts */ };

typedef struct {
    int32_t full_counts;                   /* correction outside the zone, 0 .. 2048 */
    int32_t slope_alpha_q8, slope_beta_q8; /* 1 and sqrt(3)/2 over the zone */
    int32_t lag_q15;                       /* 1 - exp(-w T), at least 1/16 */
    /* State. */
    dq_t reference_pu; /* in the current circle */
    dq_t behind_pu;    /* what will be missing of it while the next voltage acts */
} dead_time_t;

/* Divides. */
dead_time_t dead_time_init(const config_t *config);

/* A new reference, inside the unit circle. */
void dead_time_follow(dead_time_t *dead_time, dq_t reference);

/* Nothing flows, and nothing is to flow. */
void dead_time_rest(dead_time_t *dead_time);

/* The current expected while this period's voltage acts. Once a period. */
Q_TARGET_INLINE dq_t dead_time_expect(dead_time_t *dead_time)
{
    const dq_t behind = dead_time->behind_pu;
    const int32_t lag = dead_time->lag_q15;
    const dq_t next = {.d = behind.d - ((behind.d * lag) >> 15), .q = behind.q - ((behind.q * lag) >> 15)};
    dead_time->behind_pu = next;
    const dq_t out = {.d = dead_time->reference_pu.d - behind.d, .q = dead_time->reference_pu.q - behind.q};
    return out;
}

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

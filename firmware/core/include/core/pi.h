/* SPDX-License-Identifier: Apache-2.0 */
/*
 * pi.h: proportional-integral controller with anti-windup by back-calculation. Fast loop, once per
 * PWM period and axis, in two calls:
 *
 *     u = pi_output_q25(&pi, &gains, error, forward)       unsaturated output, with feed-forward
 *     pi_update(&pi, &gains, error, u, u_realised)         update with the applied output
 *
 * When u was limited, the integrator advances with the error that would just have produced the
 * realised output (self-conditioning, Hanus 1987), e_realised = e + (u_realised - u) / k_p, so
 *     integrator += k_i e + k_i/k_p (u_realised - u)
 * It leaves a limit without overshoot and needs no switching logic.
 *
 * Formats: error within Q15 (-32768 .. 32767); proportional gain Q10 (< 16); feed-forward and
 * output Q25, so that everything is added up before anything is rounded, the feed-forward within
 * 46; integral gain per step Q15, below one half; anti-windup gain k_i/k_p Q15, below one eighth,
 * and what is missing (Q15) counts up to 4, so that no sum overflows; integrator Q30, |.| < 1.
 */
#ifndef CORE_PI_H
#define CORE_PI_H

#include <stdint.h>

#include "core/q15.h"

enum {
    PI_LARGEST_PROPORTIONAL_Q10 = 16383,
    PI_LARGEST_INTEGRAL_Q15 = 16383,
    PI_LARGEST_ANTI_WINDUP_Q15 = 4095
};

typedef struct {
    int32_t proportional_q10; /* 0 .. 16383 */
    int32_t integral_q15;     /* 0 .. PI_LARGEST_INTEGRAL_Q15 */
    int32_t anti_windup_q15;  /* 0 .. PI_LARGEST_ANTI_WINDUP_Q15 */
} pi_gains_t;

typedef struct {
    int32_t integrator_q30;
} pi_state_t;

Q_TARGET_INLINE int32_t pi_output_q25(const pi_state_t *state, const pi_gains_t *gains,
                                      int32_t error, int32_t forward_q25)
{
    return gains->proportional_q10 * error + forward_q25 + (state->integrator_q30 >> 5);
}

Q_TARGET_INLINE void pi_update(pi_state_t *state, const pi_gains_t *gains, int32_t error,
                               int32_t wanted, int32_t realised)
{
    int32_t integrator_q30 = state->integrator_q30 + gains->integral_q15 * error;
    const int32_t missing = realised - wanted;
    if (missing != 0) {
        integrator_q30 += gains->anti_windup_q15 * q_saturate18(missing);
    }
    /* Magnitude below 2^30 + 2^29 + 2^29, so the sum above does not overflow. */
    state->integrator_q30 = q_saturate31(integrator_q30);
}

#endif

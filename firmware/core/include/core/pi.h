/*
 * pi.h: proportional-integral regulator that is told what was really realised.
 *
 * Two calls a step, so that anti-windup cannot be forgotten:
 *
 *     u = pi_output(&pi, &gains, error)                    what the regulator wants
 *     pi_update(&pi, &gains, error, u, u_realised)         what the actuator could do
 *
 * When u was limited, the integrator advances with the error that would just have produced the realised output
 * (self-conditioning, Hanus 1987), e_realised = e + (u_realised - u) / k_p, so
 *     integrator += k_i e + k_i/k_p (u_realised - u)
 * It leaves a limit without overshoot and needs no switching logic.
 *
 * Formats: error within Q15 (-32768 .. 32767); output per-unit Q15, which before limiting may exceed 1 (|u| < 18);
 * proportional gain Q11 (< 16); integral gain per step Q15, below one half; anti-windup gain k_i/k_p Q15, below one
 * eighth, and what is missing counts up to 4, so that no sum overflows; integrator Q30, |.| < 1.
 */
#ifndef CORE_PI_H
#define CORE_PI_H

#include <stdint.h>

#include "core/q15.h"

enum { PI_LARGEST_INTEGRAL_Q15 = 16383, PI_LARGEST_ANTI_WINDUP_Q15 = 4095 };

typedef struct {
    int32_t proportional_q11; /* 0 .. 32767 */
    int32_t integral_q15;     /* 0 .. PI_LARGEST_INTEGRAL_Q15 */
    int32_t anti_windup_q15;  /* 0 .. PI_LARGEST_ANTI_WINDUP_Q15 */
} pi_gains_t;

typedef struct {
    int32_t integrator_q30;
} pi_state_t;

static inline int32_t pi_output(const pi_state_t *state, const pi_gains_t *gains, int32_t error)
{
    return ((gains->proportional_q11 * error) >> 11) + (state->integrator_q30 >> 15);
}

static inline void pi_update(pi_state_t *state, const pi_gains_t *gains, int32_t error, int32_t wanted,
                             int32_t realised)
{
    const int32_t missing = q_saturate18(realised - wanted);
    /* 2^30 + 2^29 + 2^29, each less a little. */
    state->integrator_q30 =
        q_saturate31(state->integrator_q30 + gains->integral_q15 * error + gains->anti_windup_q15 * missing);
}

#endif

/* SPDX-License-Identifier: Apache-2.0 */
/*
 * current_loop.h: the current regulator in the rotor frame, once per PWM period.
 *
 * Voltages are in modulation units: 1.0 is the largest voltage vector the loop may ask for,
 * modulation_limit * u_dc / sqrt 3. The voltage limit is therefore the unit circle: one saturating
 * instruction limits the d axis, a table gives q what the circle leaves, and no step divides by the
 * bus voltage. Everything that depends on bus voltage and speed is rescaled by the slow reach every
 * millisecond (current_loop_tuning()).
 *
 *     u_d = PI(i_d* - i_d) - w L_q i_q            u_q = PI(i_q* - i_q) + w L_d i_d + w psi
 *
 * The d axis goes first (field weakening needs it), and both regulators are told the realised
 * voltage. Gains: k_i = a (1 - a) R, k_p = k_i / (1 - exp(-R T / L)), a = exp(-w_c T), R at the
 * winding's temperature in k_i: the zero cancels the motor's pole, and what is left with the delay
 * of 1.5 periods inside the loop has the poles a, as designed, and 1 - a (derivation:
 * tools/regen_table/README.md). With the reference as response.h shapes it the current answers like
 * a first-order system of bandwidth w_c that starts 1.5 periods late.
 */
#ifndef FOC_CURRENT_LOOP_H
#define FOC_CURRENT_LOOP_H

#include <stdbool.h>
#include <stdint.h>

#include "config/config.h"
#include "core/angle.h"
#include "core/circle.h"
#include "core/frames.h"
#include "core/pi.h"
#include "core/q15.h"

/* From the slow reach: gains for the present bus voltage, feed-forward for the present speed. */
typedef struct {
    pi_gains_t d, q;
    int32_t w_l_d_q10, w_l_q_q10; /* w L I_base in modulation units, sign of speed, |.| < 16 */
    /* Fed forward besides: nothing, and the back-EMF w psi, sign of speed, up to 8.
     * current_loop_bring_forward() adds its part. */
    int32_t forward_d_q25, forward_q_q25;
    sincos_t advance; /* the electrical angle of 1.5 periods */
} current_loop_tuning_t;

typedef struct {
    pi_state_t d, q;
} current_loop_state_t;

typedef struct {
    int32_t wanted_d, wanted_q; /* before the circle, Q15, |.| may exceed 1 */
    dq_t realised;              /* inside the unit circle */
} current_loop_out_t;

/*
 * v_dc_pu: bus voltage, Q15 of the voltage base; values below 1/16 count as 1/16.
 * modulation_limit_q15: radius of the voltage circle as a share of u_dc/sqrt 3, 8192 .. 32767.
 * speed_q32: electrical turns per period. winding_temperature_cC moves the integral gains; when it
 * is not known, the reference temperature is right. Divides: slow reach.
 */
current_loop_tuning_t current_loop_tuning(const config_t *config, int32_t modulation_limit_q15,
                                          int32_t v_dc_pu, int32_t speed_q32,
                                          int32_t winding_temperature_cC);

/*
 * Lets cross-coupling go by the current that will flow while the voltage acts, nearer * aim + (1 -
 * nearer) * i (response.h), and not by the one that was sampled 1.5 periods before: without it the
 * other axis would be 1.5 w T of a change off, as an integral over periods, 4.4 % of a step at its
 * worst at w T = 0.05. What is measured keeps the rest of the weight, so nothing else than that can
 * be wrong by an aim that is not reached. tuning: as current_loop_tuning() made it; nearer_q15: 0
 * .. 32767; aim inside the unit circle.
 */
static inline void current_loop_bring_forward(current_loop_tuning_t *tuning, int32_t nearer_q15,
                                              dq_t aim)
{
    const int32_t ahead_d_q10 = (tuning->w_l_d_q10 * nearer_q15) >> 15;
    const int32_t ahead_q_q10 = (tuning->w_l_q_q10 * nearer_q15) >> 15;
    tuning->w_l_d_q10 -= ahead_d_q10;
    tuning->w_l_q_q10 -= ahead_q_q10;
    tuning->forward_d_q25 -= ahead_q_q10 * aim.q;
    tuning->forward_q_q25 += ahead_d_q10 * aim.d;
}

static inline void current_loop_reset(current_loop_state_t *state)
{
    state->d.integrator_q30 = 0;
    state->q.integrator_q30 = 0;
}

/* One period. reference: inside the unit circle; i: up to 1.53 long. */
Q_TARGET_INLINE void current_loop_step(current_loop_state_t *restrict state,
                                       const current_loop_tuning_t *restrict tuning, dq_t reference,
                                       dq_t i, current_loop_out_t *restrict out)
{
    const int32_t error_d = q_saturate16(reference.d - i.d);
    const int32_t forward_d_q25 = tuning->forward_d_q25 - tuning->w_l_q_q10 * i.q;
    const int32_t u_d = pi_output_q25(&state->d, &tuning->d, error_d, forward_d_q25) >> 10;
    const int32_t real_d = q_saturate16(u_d);
    out->wanted_d = u_d;
    pi_update(&state->d, &tuning->d, error_d, u_d, real_d);

    const int32_t error_q = q_saturate16(reference.q - i.q);
    const int32_t forward_q_q25 = tuning->w_l_d_q10 * i.d + tuning->forward_q_q25;
    const int32_t u_q = pi_output_q25(&state->q, &tuning->q, error_q, forward_q_q25) >> 10;
    const int32_t real_q = q_limit(u_q, circle_other_q15(real_d));
    out->wanted_q = u_q;
    pi_update(&state->q, &tuning->q, error_q, u_q, real_q);

    out->realised.d = real_d;
    out->realised.q = real_q;
}

/*
 * Every few periods, while the voltage is short: the d axis gives back what it takes beyond 98 % of
 * the circle, so that q always keeps 18 %. Braking, a u_d that takes all of it leaves i_q to
 * itself: i_q grows, w L_q i_q asks for still more u_d, and nothing leads back; there would be more
 * braking torque than commanded for as long as the speed lasts. With that rest for u_q, i_q comes
 * back as soon as i_d has gone down far enough, which it then does by itself, because w L_q i_q is
 * more than u_d can hold.
 */
enum { CURRENT_LOOP_MOST_D_Q15 = 32256 };

static inline void current_loop_give_back_d(current_loop_state_t *state,
                                            const current_loop_out_t *last)
{
    const int32_t beyond = last->wanted_d - q_limit(last->wanted_d, CURRENT_LOOP_MOST_D_Q15);
    /* Both within 31 bits. */
    state->d.integrator_q30 = q_saturate31(state->d.integrator_q30 - q_saturate16(beyond) * 32768);
}

#endif

/* SPDX-License-Identifier: Apache-2.0 */
/*
 * current_controller.h: PI current control in the rotor frame, once per PWM period.
 *
 *     u_d = PI(i_d* - i_d) - w L_q i_q            u_q = PI(i_q* - i_q) + w L_d i_d + w psi
 *
 * Voltages are in modulation units: the voltage limit is the unit circle. The d axis has priority
 * where its voltage weakens the field, but for 1/64 of it, and beside what holds the q
 * current where its voltage strengthens it; q gets the remaining voltage. Gains for the present bus
 * voltage and speed come from tuning.h.
 *
 * Anti-windup by back-calculation: when u was limited, the integrator advances with the error that
 * would just have produced the applied voltage (self-conditioning, Hanus 1987), e_applied = e +
 * (u_applied - u) / k_p, so
 *     integrator += k_i e + k_i/k_p (u_applied - u)
 * It leaves a limit without overshoot and needs no switching logic.
 *
 * Everything is added up in Q25 before it is rounded once; what the limit takes counts up to 4, so
 * that no sum overflows.
 */
#ifndef FOC_CURRENT_CONTROLLER_H
#define FOC_CURRENT_CONTROLLER_H

#include <stdint.h>

#include "core/circle.h"
#include "core/fast_messages.h"
#include "core/frames.h"
#include "core/q15.h"
#include "foc/state.h"

enum {
    CURRENT_CONTROLLER_RESERVE_Q15 = 5898,    /* 18 % of the circle: leaves 98 % for d */
    CURRENT_CONTROLLER_WEAKENING_Q15 = 32256, /* 63/64: leaves 17.6 % for q */
    CURRENT_CONTROLLER_CORRECTION_Q15 = 3277, /* a tenth */
    CURRENT_CONTROLLER_FREE_Q15 = 16384,      /* a half of the circle leaves 87 % for q */
    CURRENT_CONTROLLER_MOST_RESERVE_Q15 = 28377
};

/* Bridge off. */
static inline void current_controller_reset(current_controller_t *state)
{
    state->d.integrator_q30 = 0;
    state->q.integrator_q30 = 0;
}

/*
 * The tuning with delay compensation: the decoupling uses (1 - m) i + m target instead of the
 * sampled current i (current_predictor_target()); weight_q15: m. The sampled current keeps the
 * weight 1 - m, so that a current that does not reach its target adds no other error.
 */
static inline current_gains_t current_gains_of(const current_tuning_t *tuning, int32_t weight_q15,
                                               dq_t target)
{
    const int32_t share_d_q10 = (tuning->w_l_d_q10 * weight_q15) >> 15;
    const int32_t share_q_q10 = (tuning->w_l_q_q10 * weight_q15) >> 15;
    const current_gains_t out = {
        .d_gain_q10 = q_pair(tuning->d.proportional_q10, share_q_q10 - tuning->w_l_q_q10),
        .q_gain_q10 = q_pair(tuning->w_l_d_q10 - share_d_q10, tuning->q.proportional_q10),
        .integral_q15 = q_pair(tuning->d.integral_q15, tuning->q.integral_q15),
        .anti_windup_q15 = q_pair(tuning->d.anti_windup_q15, tuning->q.anti_windup_q15),
        .forward_d_q25 = tuning->forward_d_q25 - share_q_q10 * target.q,
        .forward_q_q25 = tuning->forward_q_q25 + share_d_q10 * target.d,
    };
    return out;
}

/* The largest u_d > 0, which is that of a braking motor: steady_q holds i_q, and a tenth of
 * the circle corrects it, if it is wanted. Without this reserve a braking current escapes control
 * at the voltage limit; with less of u_d i_d falls, which weakens the field. DERIVATIONS.md, d-axis
 * voltage reserve. */
Q_TARGET_INLINE int32_t current_controller_most_d(int32_t steady_q_q25, int32_t wanted_q_q25)
{
    const int32_t steady = q_abs(steady_q_q25 >> 10);
    const int32_t wanted =
        q_min(q_abs(wanted_q_q25 >> 10), steady + CURRENT_CONTROLLER_CORRECTION_Q15);
    return circle_other_q15(
        q_clamp(wanted, CURRENT_CONTROLLER_RESERVE_Q15, CURRENT_CONTROLLER_MOST_RESERVE_Q15));
}

/* One period. reference: inside the unit circle. */
Q_TARGET_INLINE void current_controller_step(current_controller_t *restrict state,
                                             const current_gains_t *restrict gains,
                                             dq16_t reference, dq16_t i,
                                             voltage_out_t *restrict out)
{
    const q_pair_t error = q_pair_subtract(reference.v, i.v);

    const int32_t integral_q_q30 = state->q.integrator_q30;
    const int32_t base_q_q25 = gains->forward_q_q25 + (integral_q_q30 >> 5);
    const q_pair_t q_gain_q10 = q_pair_load(&gains->q_gain_q10);
    const int32_t steady_q_q25 = q_pair_mac_x(base_q_q25, q_gain_q10, i.v);
    const int32_t u_q_q25 = q_pair_mac_y(steady_q_q25, q_gain_q10, error);
    out->unsaturated_q_q25 = u_q_q25;

    const int32_t integral_d_q30 = state->d.integrator_q30;
    const int32_t base_d_q25 = gains->forward_d_q25 + (integral_d_q30 >> 5);
    const q_pair_t d_gain_q10 = q_pair_load(&gains->d_gain_q10);
    const int32_t p_d_q25 = q_pair_mac_x(base_d_q25, d_gain_q10, error);
    const int32_t u_d_q25 = q_pair_mac_y(p_d_q25, d_gain_q10, i.v);
    const int32_t u_d = u_d_q25 >> 10;
    int32_t applied_d = u_d;
    out->unsaturated_d_q25 = u_d_q25;
    const q_pair_t integral_q15 = q_pair_load(&gains->integral_q15);
    int32_t next_d_q30 = q_pair_mac_x(integral_d_q30, integral_q15, error);
    /* Outside -weakening .. free, as one unsigned comparison. */
    if ((uint32_t)u_d + CURRENT_CONTROLLER_WEAKENING_Q15 >
        (uint32_t)CURRENT_CONTROLLER_WEAKENING_Q15 + CURRENT_CONTROLLER_FREE_Q15) {
        applied_d = u_d < 0 ? -CURRENT_CONTROLLER_WEAKENING_Q15
                            : q_min(u_d, current_controller_most_d(steady_q_q25, u_q_q25));
        next_d_q30 += q_pair_x(gains->anti_windup_q15) * q_saturate18(applied_d - u_d);
    }
    state->d.integrator_q30 = q_saturate31(next_d_q30);

    const int32_t limit_q = circle_other_q15(applied_d);
    int32_t applied_q_q25 = u_q_q25;
    int32_t next_q_q30 = q_pair_mac_y(integral_q_q30, integral_q15, error);
    /* Outside -limit .. limit, as one unsigned comparison in Q25. */
    if ((uint32_t)u_q_q25 + ((uint32_t)limit_q << 10) > (uint32_t)limit_q << 11) {
        const int32_t sign = u_q_q25 >> 31;
        const int32_t applied_q = (limit_q ^ sign) - sign;
        applied_q_q25 = applied_q * 1024;
        next_q_q30 += q_pair_y(gains->anti_windup_q15) * q_saturate18(applied_q - (u_q_q25 >> 10));
    }
    state->q.integrator_q30 = q_saturate31(next_q_q30);

    out->applied.v = q_pair_of_q25(applied_d, applied_q_q25);
}

/* The voltage before the circle, Q15. */
static inline dq_t voltage_unsaturated(const voltage_out_t *voltage)
{
    const dq_t out = {.d = voltage->unsaturated_d_q25 >> 10, .q = voltage->unsaturated_q_q25 >> 10};
    return out;
}

#endif

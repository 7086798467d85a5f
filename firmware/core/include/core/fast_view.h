/* SPDX-License-Identifier: Apache-2.0 */
/*
 * fast_view.h: the current loop of the latest PWM period, for tools that measure (core/signals.h).
 * No control step reads it.
 */
#ifndef CORE_FAST_VIEW_H
#define CORE_FAST_VIEW_H

#include <stdint.h>

/* Currents: Q15 of the current base. Voltages: Q15 of the voltage circle. */
typedef struct {
    int32_t i_d_pu, i_q_pu;                     /* sampled */
    int32_t i_d_reference_pu, i_q_reference_pu; /* for that sample, before the prefilter */
    int32_t u_d_pu, u_q_pu;                     /* act in the next period */
    uint16_t theta_turn;                        /* electrical angle of i_d, i_q */
} fast_view_t;

#endif

/* SPDX-License-Identifier: Apache-2.0 */
/*
 * sampled_current.h: what a current that is looked at once a period is beside its mean over the
 * period. Slow reach.
 *
 * In the stator's frame the bridge's voltage stands still for a period T while the rotor turns by w
 * T. Seen from the rotor it is u (1 - j w t) for t = -T/2 .. T/2 beside its mean u, so the current
 * has a ripple with the slope -j w t u/L. Its mean over the period is nothing, at the sample, in
 * the corner between two periods, it is -j w T^2 u / (12 L): with u = u_d + j u_q,
 *
 *     i_sampled - i_mean = w T^2/12 (u_q/L_d, -u_d/L_q) = g (i_d + psi/L_d, i_q),    g = (w T)^2/12
 *
 * where u is what the inductances and the magnets take: u_d = -w L_q i_q, u_q = w (L_d i_d + psi).
 * Resistance adds g R/(w L) of the other current, below 0.1 % of it. Torque and power go with the
 * mean, the regulator sees the sample: at 18 periods in an electrical turn g is 1 %. The mean of
 * the voltage itself is shorter than what the bridge is told, by (w T)^2/24.
 */
#ifndef FOC_SAMPLED_CURRENT_H
#define FOC_SAMPLED_CURRENT_H

#include <stdint.h>

#include "config/config.h"
#include "core/frames.h"

/* At one speed and temperature. */
typedef struct {
    int32_t gain_q24;    /* g, 0 .. 2^20: 1/16, 7 periods in a turn */
    int32_t inverse_q24; /* g/(1 + g), for the way back */
    int32_t magnets_pu;  /* psi/L_d, Q15 of the current base, at most 16 */
} sampled_current_t;

/* speed_q32: electrical turns per period. Divides. */
sampled_current_t sampled_current_at(const config_t *config, int32_t speed_q32,
                                     int32_t winding_temperature_cC);

/* Q15 of the current base, |.| <= 4. */
dq_t sampled_current_to_mean(const sampled_current_t *at, dq_t sampled);
dq_t sampled_current_of_mean(const sampled_current_t *at, dq_t mean);

/* The mean of i_d less its sample, when one of them is nothing: -g psi/L_d; Q15, 16 bits. */
int32_t sampled_current_offset_pu(const sampled_current_t *at);

/* The mean of a voltage of which the bridge is told `told`, any unit >= 0. */
int32_t sampled_current_voltage_mean(const sampled_current_t *at, int32_t told);

#endif

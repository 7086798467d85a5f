/* SPDX-License-Identifier: Apache-2.0 */
/*
 * sampling_correction.h: difference between the current sampled once per PWM period and its mean
 * over the period. Torque follows the mean, the current controller sees the sample. Slow loop,
 * 1 kHz. With g = (w T)^2/12 (DERIVATIONS.md, Sampling correction):
 *
 *     i_sampled - i_mean = g (i_d + psi/L_d, i_q)          u_mean = (1 - g/2) u_commanded
 */
#ifndef CONTROLLER_SAMPLING_CORRECTION_H
#define CONTROLLER_SAMPLING_CORRECTION_H

#include <stdint.h>

#include "config/config.h"
#include "controller/operating_point.h"
#include "core/frames.h"

/* psi/L_d at the reference temperature, Q15 of the current base. Divides. */
int32_t sampling_correction_magnets_pu(const config_t *config);

/* magnets_pu: sampling_correction_magnets_pu(). speed_q32: electrical turns per period. Divides. */
sampling_correction_t sampling_correction_at(const config_t *config, int32_t magnets_pu,
                                             int32_t speed_q32, int32_t winding_temperature_cC);

/* Q15 of the current base, |.| <= 4. */
dq_t sampling_correction_to_mean(const sampling_correction_t *at, dq_t sampled);
dq_t sampling_correction_to_sampled(const sampling_correction_t *at, dq_t mean);

/* Change of the mean current with a change of the sampled one, either axis. */
int32_t sampling_correction_mean_change(const sampling_correction_t *at, int32_t sampled_change);

/* Mean minus sampled i_d at zero mean current: -g/(1 + g) psi/L_d; Q15, 16 bits, <= 0. */
int32_t sampling_correction_d_pu(const sampling_correction_t *at);

/* Mean of a commanded voltage, any unit >= 0. */
int32_t sampling_correction_mean_voltage(const sampling_correction_t *at, int32_t commanded);

#endif

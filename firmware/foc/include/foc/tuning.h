/* SPDX-License-Identifier: Apache-2.0 */
/*
 * tuning.h: the fast loop's coefficients for the present bus voltage, speed and winding
 * temperature. Slow loop, 1 kHz; pure; divides.
 *
 * Voltages are in modulation units: 1.0 is the radius of the voltage circle,
 * modulation_limit * u_dc / sqrt 3. Gains: README, Current controller.
 */
#ifndef FOC_TUNING_H
#define FOC_TUNING_H

#include <stdint.h>

#include "config/config.h"
#include "core/angle.h"
#include "core/pi.h"

typedef struct {
    pi_gains_t d, q;
    int32_t w_l_d_q10, w_l_q_q10; /* decoupling: w L I_base, sign of speed, |.| < 16 */
    int32_t forward_d_q25;        /* feed-forward: zero */
    int32_t forward_q_q25;        /* feed-forward: back-EMF w psi, sign of speed, |.| <= 8 */
    rotation_t advance;           /* electrical angle of 1.5 periods */
} current_tuning_t;

/* Slope of the dead-time correction over the current: 1 and sqrt(3)/2 over the zone around zero
 * current, 0 .. 65 000. */
typedef struct {
    int32_t alpha_q8, beta_q8;
} dead_time_slope_t;

/*
 * modulation_limit_q15: foc_modulation_limit_q15(). v_dc_pu: Q15 of the voltage base; values below
 * 1/16 count as 1/16. speed_q32: electrical turns per period, any. The winding temperature scales
 * the integral gains; when it is unknown, pass the reference temperature.
 */
current_tuning_t current_tuning(const config_t *config, int32_t modulation_limit_q15,
                                int32_t v_dc_pu, int32_t speed_q32, int32_t winding_temperature_cC);

/* v_dc_pu: clamped to 1/16 .. 1. */
dead_time_slope_t dead_time_slope_at(const config_t *config, int32_t v_dc_pu);

/* The same at the middle of the battery's voltage range. */
dead_time_slope_t dead_time_slope_nominal(const config_t *config);

#endif

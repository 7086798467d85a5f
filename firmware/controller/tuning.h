/* SPDX-License-Identifier: Apache-2.0 */
/*
 * tuning.h: the fast loop's coefficients for the present bus voltage, speed and winding
 * temperature. Slow loop, 1 kHz; pure; divides.
 *
 * Voltages are in modulation units: 1.0 is the radius of the voltage circle,
 * modulation_limit * u_dc / sqrt 3. DERIVATIONS.md, Tuning; gains: foc, Current controller.
 */
#ifndef CONTROLLER_TUNING_H
#define CONTROLLER_TUNING_H

#include <stdint.h>

#include "config/config.h"
#include "controller/operating_point.h"
#include "core/fast_messages.h"

/*
 * modulation_limit_q15: foc_modulation_limit_q15(). v_dc_pu: Q15 of the voltage base; values below
 * 1/16 count as 1/16. speed_q32: electrical turns per period, any. The winding temperature scales
 * the integral gains; when it is unknown, pass the reference temperature.
 */
current_tuning_t current_tuning(const config_t *config, const winding_t *winding,
                                int32_t modulation_limit_q15, int32_t v_dc_pu, int32_t speed_q32,
                                int32_t winding_temperature_cC);

/* v_dc_pu: clamped to 1/16 .. 1. */
dead_time_slope_t dead_time_slope_at(const config_t *config, int32_t v_dc_pu);

#endif

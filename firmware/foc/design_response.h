/* SPDX-License-Identifier: Apache-2.0 */
/*
 * design_response.h: b = exp(-w T/2), the designed closed-loop pole over half a PWM period; w from
 * config.current_loop.bandwidth_Hz. For initialisation; divides.
 */
#ifndef FOC_DESIGN_RESPONSE_H
#define FOC_DESIGN_RESPONSE_H

#include <stdint.h>

#include "config/config.h"
#include "core/angle.h"

#define DESIGN_ONE_Q24 (INT64_C(1) << 24)

/* Second Pade approximation of exp(-y), y = w T/2 up to 1/4: error y^5/720, less than half a unit
 * of Q15. */
static inline int64_t design_half_period_q24(const config_t *config)
{
    const int64_t exact_q24 =
        config->current_loop.bandwidth_Hz * ANGLE_PI_Q24 / config->drive.pwm_frequency_Hz;
    const int64_t y_q24 = exact_q24 < DESIGN_ONE_Q24 / 4 ? exact_q24 : DESIGN_ONE_Q24 / 4;
    const int64_t even_q24 = DESIGN_ONE_Q24 + ((y_q24 * y_q24) >> 24) / 12;
    return ((even_q24 - y_q24 / 2) << 24) / (even_q24 + y_q24 / 2);
}

/* Rounded to nearest. */
static inline int32_t design_q15(int64_t x_q24)
{
    return (int32_t)((x_q24 + (1 << 8)) >> 9);
}

#endif

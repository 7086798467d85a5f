/* SPDX-License-Identifier: Apache-2.0 */
/*
 * mean_values.h: means over the fast steps since the previous slow step (averaging window). Slow
 * loop, 1 kHz; divides. The window removes PWM and sampling ripple and lags by half its length.
 */
#ifndef FOC_MEAN_VALUES_H
#define FOC_MEAN_VALUES_H

#include <stdint.h>

#include "core/frames.h"
#include "foc/exchange.h"

typedef struct {
    dq_t i_pu;        /* mean, Q15 of the current base */
    int32_t power_pu; /* mean of u_d i_d + u_q i_q, Q15; DC current = sqrt(3)/2 * modulation limit *
                         current base * power */
    int32_t v_dc_pu;  /* mean, Q15 of the voltage base */
} mean_values_t;

typedef struct {
    foc_sums_t sums; /* at the previous step */
    uint16_t sequence;
    mean_values_t latest;
} mean_values_state_t;

/* v_dc_pu: bus voltage until the first fast step; the currents are zero until then. */
void mean_values_init(mean_values_state_t *state, int32_t v_dc_pu);

/* At most 40 000 periods since the previous call. Without a new one the result stays unchanged. */
mean_values_t mean_values_step(mean_values_state_t *state, const fast_report_t *report);

#endif

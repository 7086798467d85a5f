/* SPDX-License-Identifier: Apache-2.0 */
/*
 * mean_values.h: means over the fast steps since the previous slow step (averaging window), and
 * flags of the latest fast step. Slow loop, 1 kHz; divides. The window removes PWM and sampling
 * ripple and lags by half its length.
 */
#ifndef FOC_MEAN_VALUES_H
#define FOC_MEAN_VALUES_H

#include <stdbool.h>
#include <stdint.h>

#include "core/frames.h"
#include "foc/foc.h"

typedef struct {
    dq_t i_pu;        /* mean, Q15 of the current base */
    int32_t power_pu; /* mean of u_d i_d + u_q i_q, Q15; DC current = sqrt(3)/2 * modulation limit *
                         current base * power */
    int32_t v_dc_pu;  /* mean, Q15 of the voltage base */
    int32_t modulation_square_q15; /* modulation_index_square_q15() of the latest period */
    bool voltage_limited;          /* the voltage circle limited the latest period */
    bool adc_saturated; /* a converter in use is at an end of its range in the latest period */
} mean_values_t;

typedef struct {
    foc_sums_t sums; /* at the previous step */
    uint16_t fast_step_count;
    mean_values_t latest;
} mean_values_state_t;

/* v_dc_pu: bus voltage until the first fast step; the currents are zero until then. */
void mean_values_init(mean_values_state_t *state, int32_t v_dc_pu);

/* fast_step_count: steps in the report's sums, wrapping; at most 40 000 since the previous call.
 * Without a new fast step the result stays unchanged. */
mean_values_t mean_values_step(mean_values_state_t *state, const foc_report_t *report,
                               uint16_t fast_step_count);

#endif

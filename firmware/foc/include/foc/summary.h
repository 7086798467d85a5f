/* SPDX-License-Identifier: Apache-2.0 */
/*
 * summary.h: what the slow reach makes of the fast reach's report: means over the fast steps since
 * it last looked, and judgements of the latest one. 1 kHz; divides.
 *
 * A mean over the slow reach's own period passes no ripple of the PWM or of the sampling on and
 * lags by half that period.
 */
#ifndef FOC_SUMMARY_H
#define FOC_SUMMARY_H

#include <stdbool.h>
#include <stdint.h>

#include "core/frames.h"
#include "foc/foc.h"

typedef struct {
    dq_t i_pu;        /* mean, Q15 of the current base */
    int32_t power_pu; /* mean of u_d i_d + u_q i_q, Q15: DC current = sqrt(3)/2 * limit * I_base *
                         power */
    int32_t v_dc_pu;  /* mean, Q15 of the voltage base */
    int32_t voltage_use_q15; /* |u|^2 of the latest period, 0 .. 65534; q as wanted, so more than 1
                                means too little */
    bool voltage_limited;    /* the circle bit in the latest period */
    bool current_saturated;  /* a converter that was used stands at an end of its range, in the
                                latest period */
} foc_summary_t;

typedef struct {
    foc_sums_t sums; /* when last looked at */
    uint16_t fast_step_count;
    foc_summary_t latest;
} foc_summary_state_t;

/* v_dc_pu: taken for the bus voltage until the first fast step; the currents count as zero. */
void foc_summary_init(foc_summary_state_t *state, int32_t v_dc_pu);

/* fast_step_count: how many steps the report's sums hold, wrapping. Without a new step everything
 * stays as it was. Up to 40 000 steps between two looks. */
foc_summary_t foc_summary_step(foc_summary_state_t *state, const foc_report_t *report,
                               uint16_t fast_step_count);

#endif

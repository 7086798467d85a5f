/* SPDX-License-Identifier: Apache-2.0 */
#include "foc/summary.h"

#include "core/angle.h"
#include "foc/transforms.h"

void foc_summary_init(foc_summary_state_t *state, int32_t v_dc_pu)
{
    const foc_summary_state_t zero = {.fast_step_count = 0};
    *state = zero;
    state->latest.v_dc_pu = v_dc_pu;
}

/* The difference of two wrapping sums, as long as it is below 2^31. */
static int32_t mean(uint32_t now, uint32_t before, int32_t steps)
{
    const uint32_t rise = now - before;
    return (rise <= INT32_MAX ? (int32_t)rise : -(int32_t)(UINT32_MAX - rise) - 1) / steps;
}

/* The period's phase currents, worked back from its dq vector. */
static abc_t phases(const foc_report_t *report)
{
    const ab_t i = transforms_inverse_park(report->current.i_pu,
                                           angle_sincos(report->current.rotor.theta_turn));
    const int32_t beta_part = (i.beta * TRANSFORMS_SQRT3_2_Q15) >> 15;
    const int32_t half_alpha = i.alpha >> 1;
    const abc_t out = {.a = i.alpha, .b = beta_part - half_alpha, .c = -beta_part - half_alpha};
    return out;
}

foc_summary_t foc_summary_step(foc_summary_state_t *state, const foc_report_t *report,
                               uint16_t fast_step_count)
{
    const int32_t steps = (uint16_t)(fast_step_count - state->fast_step_count);
    if (steps > 0) {
        const foc_sums_t *now = &report->sums;
        const foc_sums_t *before = &state->sums;
        const current_loop_out_t *voltage = &report->current.voltage;
        const foc_summary_t summary = {
            .i_pu = {.d = mean(now->i_d_pu, before->i_d_pu, steps),
                     .q = mean(now->i_q_pu, before->i_q_pu, steps)},
            .power_pu = mean(now->power_pu, before->power_pu, steps),
            .v_dc_pu = mean(now->v_dc_pu, before->v_dc_pu, steps),
            .voltage_use_q15 = FIELD_WEAKENING_AIM_Q15 -
                               field_weakening_margin_q15(voltage->realised.d, voltage->wanted_q),
            .voltage_limited = voltage->wanted_q != voltage->realised.q ||
                               voltage->wanted_d != voltage->realised.d,
            .current_saturated = sense_at_end(report->offset_q4, phases(report)),
        };
        state->latest = summary;
        state->sums = *now;
        state->fast_step_count = fast_step_count;
    }
    return state->latest;
}

/* SPDX-License-Identifier: Apache-2.0 */
#include "foc/mean_values.h"

#include "core/angle.h"
#include "foc/modulation_index.h"
#include "sense.h"
#include "transforms.h"

void mean_values_init(mean_values_state_t *state, int32_t v_dc_pu)
{
    const mean_values_state_t zero = {.fast_step_count = 0};
    *state = zero;
    state->latest.v_dc_pu = v_dc_pu;
}

/* The difference of two wrapping sums, as long as it is below 2^31. */
static int32_t mean(uint32_t now, uint32_t before, int32_t steps)
{
    const uint32_t rise = now - before;
    return (rise <= INT32_MAX ? (int32_t)rise : -(int32_t)(UINT32_MAX - rise) - 1) / steps;
}

/* Phase currents of the period, recomputed from its dq vector. */
static abc_t phases(const foc_report_t *report)
{
    const ab_t i = transforms_inverse_park(report->current.i_pu,
                                           angle_rotation(report->current.rotor.theta_turn));
    const int32_t beta_part = (i.beta * TRANSFORMS_SQRT3_2_Q15) >> 15;
    const int32_t half_alpha = i.alpha >> 1;
    const abc_t out = {.a = i.alpha, .b = beta_part - half_alpha, .c = -beta_part - half_alpha};
    return out;
}

mean_values_t mean_values_step(mean_values_state_t *state, const foc_report_t *report,
                               uint16_t fast_step_count)
{
    const int32_t steps = (uint16_t)(fast_step_count - state->fast_step_count);
    if (steps > 0) {
        const foc_sums_t *now = &report->sums;
        const foc_sums_t *before = &state->sums;
        const voltage_out_t *voltage = &report->current.voltage;
        const dq_t applied = dq_of(voltage->applied);
        const mean_values_t values = {
            .i_pu = {.d = mean(now->i_d_pu, before->i_d_pu, steps),
                     .q = mean(now->i_q_pu, before->i_q_pu, steps)},
            .power_pu = mean(now->power_pu, before->power_pu, steps),
            .v_dc_pu = mean(now->v_dc_pu, before->v_dc_pu, steps),
            .modulation_square_q15 = modulation_index_square_q15(applied.d, voltage->unsaturated_q),
            .voltage_limited =
                voltage->unsaturated_q != applied.q || voltage->unsaturated_d != applied.d,
            .adc_saturated = sense_adc_saturated(report->offset_q4, phases(report)),
        };
        state->latest = values;
        state->sums = *now;
        state->fast_step_count = fast_step_count;
    }
    return state->latest;
}

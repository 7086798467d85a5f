/* SPDX-License-Identifier: Apache-2.0 */
#include "foc/foc.h"

#include "core/angle.h"
#include "current_controller.h"
#include "current_predictor.h"
#include "field_weakening.h"
#include "modulation.h"
#include "reference_prefilter.h"
#include "rotor.h"
#include "sense.h"
#include "transforms.h"

enum { FIELD_WEAKENING_PERIODS = 4 };

void foc_current_step(foc_current_state_t *restrict state, const uint16_t *restrict codes,
                      foc_period_t *restrict period)
{
    const sense_out_t sensed = sense_step(&state->sense, codes, state->on_q16);
    period->current_sum_pu = sensed.sum_pu;
    const sincos_t angle = angle_sincos(period->rotor.theta_turn);
    const dq_t i = transforms_park(sensed.i, angle);
    period->i_pu = i;
    const dq_t reference = period->i_reference_pu;
    current_controller_step(&state->controller, &state->tuning, reference, i, &period->voltage);

    /* The voltage acts in the next period: on average 1.5 periods after the sample. */
    const sincos_t angle_applied = transforms_advance(angle, state->tuning.advance);
    const ab_t u = transforms_inverse_park(period->voltage.applied, angle_applied);
    const dq_t predicted = current_predictor_step(&state->predictor);
    const ab_t i_applied = transforms_inverse_park(predicted, angle_applied);
    const abc_t trim = modulation_dead_time(state->slope, i_applied);
    modulation_step(&state->modulation, u, trim, state->on_q16);
}

static dq_t inside_circle(const circle_t *circle, int32_t d, int32_t q)
{
    const int32_t limited_d = q_limit(d, circle->radius_q15);
    const dq_t out = {.d = limited_d, .q = q_limit(q, circle_other(circle, limited_d))};
    return out;
}

/* A new setpoint, a new field-weakening current, or a reference that has not settled:
 * period->i_reference_pu becomes their sum, prefiltered and limited to the current circle with
 * priority for d. */
static void apply_setpoint(foc_state_t *state, const foc_setpoint_t *setpoint, foc_period_t *period)
{
    const circle_t *circle = &state->current_circle;
    foc_current_state_t *current = &state->current;
    const int32_t d = setpoint->i_reference_pu.d + field_weakening_current_pu(&state->weakening);
    const int32_t q = setpoint->i_reference_pu.q;
    const int32_t mean_d =
        d + q_limit(setpoint->i_d_sampling_correction_pu, FOC_SAMPLING_CORRECTION_PU);
    const dq_t mean = inside_circle(circle, mean_d, q);
    const dq_t reference = inside_circle(circle, d, q);
    const reference_change_t change = reference_prefilter_take(&state->prefilter, reference);
    current_predictor_change(&current->predictor, &change, mean);
    if (state->prefilter.settled) {
        period->i_reference_pu = reference;
        state->sequence = setpoint->sequence;
    } else {
        const dq_t shaped = reference_prefilter_output(&state->prefilter, &change);
        period->i_reference_pu = inside_circle(circle, shaped.d, shaped.q);
        state->sequence = FOC_NO_SETPOINT;
    }
    current->slope = setpoint->dead_time_slope;
    current->tuning = setpoint->tuning;
    current_predictor_compensate(&current->tuning, current->predictor.weight_q15,
                                 current_predictor_target(&current->predictor, &change));
    state->calibrating = false;
}

/* The next period's field-weakening current. A change of it re-applies the setpoint, also when it
 * has just returned to zero. */
static void weaken_field(foc_state_t *state, const config_t *config, foc_report_t *report)
{
    const voltage_out_t *voltage = &report->current.voltage;
    const int32_t margin_q15 =
        field_weakening_margin_q15(voltage->applied.d, voltage->unsaturated_q);
    if (margin_q15 < 0) {
        current_controller_keep_reserve(&state->current.controller, voltage);
    }
    if (margin_q15 < 0 || state->weakening.current_q28 != 0) {
        field_weakening_step(&state->weakening, margin_q15,
                             config->current_loop.field_weakening_gain_pu_q15,
                             config->current_loop.field_weakening_current_pu_q15);
        state->sequence = FOC_NO_SETPOINT;
        report->i_d_weakening_pu = field_weakening_current_pu(&state->weakening);
    }
}

static void calibrate(foc_state_t *state, const uint16_t codes[SENSE_PHASES], foc_report_t *report)
{
    sense_state_t *sense = &state->current.sense;
    if (!state->calibrating) {
        sense_calibrate_restart(sense);
    }
    sense_calibrate_step(sense, codes);
    for (int x = 0; x < SENSE_PHASES; x++) {
        report->offset_q4[x] = sense->offset_q4[x];
    }
    report->offsets_done = sense->calibrated;
}

/* In an active short circuit the current vector turns with the magnets: forward counts up. A step
 * of two quadrants has no direction and does not count. At the speed base, 1/16 turn per period,
 * each quadrant is seen four times. */
static void count_quadrants(foc_state_t *state, ab_t i, foc_report_t *report)
{
    const uint32_t upper = i.alpha >= 0 ? 0 : 1;
    const uint32_t quadrant = i.beta >= 0 ? upper : 3U - upper;
    const uint32_t step = (quadrant - state->quadrant) & 3U;
    state->quadrant = quadrant;
    if ((step & 1U) != 0) {
        report->quadrant_transitions =
            (uint16_t)(report->quadrant_transitions + (step == 1U ? 1U : UINT16_MAX));
        report->quadrant_step = (uint16_t)report->step_count;
    }
}

static void centre_on_times(foc_current_state_t *state)
{
    for (int x = 0; x < SENSE_PHASES; x++) {
        state->on_q16[x] = state->modulation.centre_q16;
    }
}

/* Bridge off or in active short circuit: the currents are measured; everything else is reset, so
 * that the next start is bump-free. */
static void idle(foc_state_t *state, bool calibrate_offsets, const uint16_t codes[SENSE_PHASES],
                 foc_report_t *report)
{
    foc_period_t *period = &report->current;
    const sense_out_t sensed = sense_step(&state->current.sense, codes, state->current.on_q16);
    const voltage_out_t no_voltage = {.unsaturated_d = 0};
    const dq_t no_current = {.d = 0};
    period->i_reference_pu = no_current;
    period->i_pu = transforms_park(sensed.i, angle_sincos(period->rotor.theta_turn));
    count_quadrants(state, sensed.i, report);
    period->voltage = no_voltage;
    period->current_sum_pu = sensed.sum_pu;
    current_controller_reset(&state->current.controller);
    reference_prefilter_reset(&state->prefilter);
    current_predictor_reset(&state->current.predictor);
    state->weakening.current_q28 = 0;
    report->i_d_weakening_pu = 0;
    centre_on_times(&state->current);
    if (calibrate_offsets) {
        calibrate(state, codes, report);
    }
    state->calibrating = calibrate_offsets;
    state->sequence = FOC_NO_SETPOINT;
}

static void add_sums(foc_sums_t *sums, const foc_period_t *period, int32_t v_dc_pu)
{
    const dq_t i = period->i_pu;
    const dq_t u = period->voltage.applied;
    foc_sums_t sum = *sums;
    sum.i_d_pu += (uint32_t)i.d;
    sum.i_q_pu += (uint32_t)i.q;
    /* |u| <= 1 and |i| <= 1.53: the sum of products is below 2^31. */
    sum.power_pu += (uint32_t)((u.d * i.d + u.q * i.q) >> 15);
    sum.v_dc_pu += (uint32_t)v_dc_pu;
    *sums = sum;
}

void foc_step(foc_state_t *state, const config_t *config, const foc_setpoint_t *setpoint, bool run,
              const foc_input_t *in, foc_report_t *report)
{
    foc_period_t *period = &report->current;
    rotor_step(&state->rotor, config, in, &period->rotor);
    report->v_dc_pu = q_saturate13(in->bus_voltage_code) * 8;
    report->step_count++;
    if (run) {
        if (state->sequence != setpoint->sequence) {
            apply_setpoint(state, setpoint, period);
        }
        foc_current_step(&state->current, in->phase_current_code, period);
        if (report->step_count % FIELD_WEAKENING_PERIODS == 0) {
            weaken_field(state, config, report);
        }
    } else {
        idle(state, setpoint->calibrate_offsets, in->phase_current_code, report);
    }
    add_sums(&report->sums, period, report->v_dc_pu);
}

void foc_init(foc_state_t *state, const config_t *config)
{
    const foc_state_t zero = {0};
    *state = zero;
    state->current.slope = dead_time_slope_nominal(config);
    state->current.modulation = modulation_init(config);
    reference_prefilter_init(&state->prefilter, config);
    current_predictor_init(&state->current.predictor, config);
    state->current_circle = circle_init(config->current_loop.max_current_pu_q15);
    sense_init(&state->current.sense);
    rotor_init(&state->rotor, config);
    state->sequence = FOC_NO_SETPOINT;
    centre_on_times(&state->current);
}

int32_t foc_modulation_limit_q15(const foc_state_t *state)
{
    return state->current.modulation.limit_q15;
}

foc_setpoint_t foc_initial_setpoint(const foc_state_t *state, const config_t *config)
{
    const int32_t highest_pu =
        q_scale(config->battery.max_voltage_mV, 32768, config->drive.voltage_full_scale_mV);
    const foc_setpoint_t setpoint = {
        .i_reference_pu = {.d = 0, .q = 0},
        .tuning = current_tuning(config, foc_modulation_limit_q15(state), highest_pu, 0,
                                 config->motor.reference_temperature_cC),
        .dead_time_slope = dead_time_slope_at(config, highest_pu),
        .calibrate_offsets = false,
    };
    return setpoint;
}

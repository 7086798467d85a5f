/* SPDX-License-Identifier: Apache-2.0 */
#include "foc/foc.h"

#include "core/angle.h"
#include "current_controller.h"
#include "current_predictor.h"
#include "field_weakening.h"
#include "idle.h"
#include "modulation.h"
#include "reference_prefilter.h"
#include "rotor.h"
#include "sense.h"
#include "setpoint.h"
#include "transforms.h"

enum { FIELD_WEAKENING_PERIODS = 4 };

void foc_current_step(foc_current_state_t *restrict state, const uint16_t *restrict codes,
                      foc_period_t *restrict period)
{
    const sense_out_t sensed = sense_step(&state->sense, codes, state->on_q16);
    period->current_sum_pu = sensed.sum_pu;
    const rotation_t angle = angle_rotation(period->rotor.theta_turn);
    const dq16_t i = transforms_park(sensed.i, angle);
    period->i_pu = i;
    current_controller_step(&state->controller, &state->gains, state->reference_pu, i,
                            &period->voltage);

    /* The voltage acts in the next period: on average 1.5 periods after the sample. */
    const rotation_t angle_applied = transforms_advance(angle, state->advance);
    const ab_t u = transforms_inverse_park(period->voltage.applied, angle_applied);
    const dq16_t predicted = current_predictor_step(&state->predictor);
    const ab_t i_applied = transforms_inverse_park(predicted, angle_applied);
    const abc_t trim = modulation_dead_time(state->slope, i_applied);
    modulation_step(&state->modulation, u, trim, state->on_q16);
}

/* The next period's field-weakening current. A change of it re-applies the setpoint, also when it
 * has just returned to zero. */
static void weaken_field(foc_state_t *state, const config_t *config, foc_report_t *report)
{
    const voltage_out_t *voltage = &report->current.voltage;
    const int32_t margin_q15 =
        field_weakening_margin_q15(q_pair_x(voltage->applied.v), voltage->unsaturated_q);
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

/* A new setpoint that meets a hall edge waits one period, so that the two longest computations
 * never meet. */
static bool setpoint_is_due(foc_state_t *state, const foc_period_t *period)
{
    const bool edge = state->rotor.sensor == CONFIG_ROTOR_HALL && period->rotor.age_periods == 0;
    state->postponed = edge && !state->postponed;
    return !state->postponed;
}

/* |u| <= 1 and |i| <= 1.42: the sum of products is below 2^31. */
static void add_sums(foc_sums_t *sums, const foc_period_t *period, int32_t v_dc_pu)
{
    const q_pair_t i = period->i_pu.v;
    sums->i_d_pu += (uint32_t)q_pair_x(i);
    sums->i_q_pu += (uint32_t)q_pair_y(i);
    sums->power_pu += (uint32_t)(q_pair_dot(period->voltage.applied.v, i) >> 15);
    sums->v_dc_pu += (uint32_t)v_dc_pu;
}

/* What both kinds of period begin and end with. */
static void begin_period(foc_state_t *state, const config_t *config, const foc_input_t *in,
                         foc_report_t *report)
{
    rotor_step(&state->rotor, config, in, &report->current.rotor);
    report->step_count++;
}

static void end_period(const foc_input_t *in, foc_report_t *report)
{
    const int32_t v_dc_pu = q_saturate13(in->bus_voltage_code) * 8;
    report->v_dc_pu = v_dc_pu;
    add_sums(&report->sums, &report->current, v_dc_pu);
}

void foc_step(foc_state_t *state, const foc_setpoint_t *setpoint, const foc_input_t *in,
              foc_report_t *report, const config_t *config)
{
    begin_period(state, config, in, report);
    if (state->sequence != setpoint->sequence && setpoint_is_due(state, &report->current)) {
        setpoint_apply(state, setpoint, &report->current);
    }
    foc_current_step(&state->current, in->phase_current_code, &report->current);
    if (report->step_count % FIELD_WEAKENING_PERIODS == 0) {
        weaken_field(state, config, report);
    }
    end_period(in, report);
}

void foc_idle_step(foc_state_t *state, const foc_setpoint_t *setpoint, const foc_input_t *in,
                   foc_report_t *report, const config_t *config)
{
    begin_period(state, config, in, report);
    idle_step(state, setpoint->calibrate_offsets, in->phase_current_code, report);
    end_period(in, report);
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
    idle_centre_on_times(&state->current);
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

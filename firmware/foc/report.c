/* SPDX-License-Identifier: Apache-2.0 */
#include "core/angle.h"
#include "current_controller.h"
#include "emf_observer.h"
#include "field_weakening.h"
#include "foc/foc.h"
#include "modulation_index.h"
#include "sense.h"
#include "sensor_isolation.h"
#include "transforms.h"

void foc_report_copy(const foc_state_t *state, fast_report_t *report)
{
    const foc_period_t *period = &state->period;
    const emf_observer_t *observer = &state->observer;
    const sense_state_t *sense = &state->current.sense;
    const int32_t speed_q32 = observer->speed_q32;
    report->sample.unsaturated_d_q25 = period->voltage.unsaturated_d_q25;
    report->sample.unsaturated_q_q25 = period->voltage.unsaturated_q_q25;
    report->sample.flux_q14 = observer->x;
    report->sample.theta_turn = period->theta_turn;
    report->sequence = (uint16_t)state->period.step_count;
    report->sums = state->sums;
    report->i_pu = period->i_pu;
    report->u_pu = period->voltage.applied;
    report->current_sum_pu = period->current_sum_pu;
    report->wrong_current_sensor = sensor_isolation_named(&state->current.isolation);
    report->current_undetermined = state->current.isolation.undetermined;
    report->i_d_weakening_pu = field_weakening_current_pu(&state->weakening);
    for (int x = 0; x < SENSE_PHASES; x++) {
        report->offset_q4[x] = sense->offset_q4[x];
    }
    report->offsets_done = sense->calibrated;
    report->speed_q32 = period->rotor.speed_q32;
    report->sensor_valid = period->rotor.valid;
    report->rotor_faults = period->rotor.faults;
    report->observer.speed_q32 = speed_q32;
    report->observer.theta_turn = (uint16_t)((observer->theta_q32 - (uint32_t)speed_q32) >> 16);
    report->observer.sensor_turn = period->rotor.theta_turn;
    report->observer.acquired = emf_observer_acquired(observer);
    report->quadrant_transitions = state->idle.quadrant_transitions;
    report->quadrant_step = state->idle.quadrant_step;
    report->idle_alpha_pu = state->idle.alpha_pu;
    report->idle_beta_pu = state->idle.beta_pu;
}

void foc_view(const foc_state_t *state, fast_view_t *view)
{
    const foc_period_t *period = &state->period;
    const dq_t i = dq_of(period->i_pu);
    const dq_t u = dq_of(period->voltage.applied);
    view->i_d_pu = i.d;
    view->i_q_pu = i.q;
    view->i_d_reference_pu = state->prefilter.reference_pu.d;
    view->i_q_reference_pu = state->prefilter.reference_pu.q;
    view->u_d_pu = u.d;
    view->u_q_pu = u.q;
    view->theta_turn = period->theta_turn;
}

void foc_report_complete(fast_report_t *report)
{
    const fast_sample_t *sample = &report->sample;
    const voltage_out_t voltage = {.unsaturated_d_q25 = sample->unsaturated_d_q25,
                                   .unsaturated_q_q25 = sample->unsaturated_q_q25,
                                   .applied = report->u_pu};
    const ab_t i_ab = transforms_inverse_park(report->i_pu, angle_rotation(sample->theta_turn));
    const dq_t applied = dq_of(voltage.applied);
    const dq_t unsaturated = voltage_unsaturated(&voltage);
    report->voltage_use_q15 = modulation_index_square_q15(unsaturated);
    report->voltage_limited = unsaturated.q != applied.q || unsaturated.d != applied.d;
    report->adc_saturated = sense_adc_saturated(report->offset_q4, transforms_inverse_clarke(i_ab));
    report->observer.flux_q14 =
        transforms_park(sample->flux_q14, angle_rotation(report->observer.theta_turn));
}

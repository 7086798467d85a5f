/* SPDX-License-Identifier: Apache-2.0 */
#include "foc/foc.h"

#include "core/angle.h"
#include "core/sqrt3.h"
#include "current_controller.h"
#include "current_predictor.h"
#include "emf_observer.h"
#include "field_weakening.h"
#include "frozen_currents.h"
#include "idle.h"
#include "modulation.h"
#include "reference_prefilter.h"
#include "rotor.h"
#include "sense.h"
#include "sensor_isolation.h"
#include "setpoint.h"
#include "spare_tasks.h"
#include "transforms.h"

void foc_current_step(foc_state_t *restrict state, const uint16_t *restrict codes)
{
    foc_current_state_t *const current = &state->current;
    foc_period_t *const period = &state->period;
    const sense_out_t sensed = sense_step(&current->sense, codes, current->on_q16);
    period->i_ab_pu = sensed.i;
    if (sensor_isolation_due(&current->isolation, sensed.sum_pu)) {
        sensor_isolation_examine(period, codes, current, sensed.sum_pu);
    }
    period->current_sum_pu = sensed.sum_pu;

    const rotation_t angle = angle_rotation(period->theta_turn);
    const dq16_t i = transforms_park(period->i_ab_pu, angle);
    period->i_pu = i;
    current_controller_step(&current->controller, &current->gains, period->i_reference_pu, i,
                            &period->voltage);

    /* The voltage acts in the next period: on average 1.5 periods after the sample. */
    const rotation_t angle_applied = transforms_advance(angle, current->advance);
    const ab_t u = transforms_inverse_park(period->voltage.applied, angle_applied);
    /* Full voltage is 32 768, which a packed pair would turn round. */
    period->u_ab.v = q_pair(q_saturate16(u.alpha), q_saturate16(u.beta));
    const dq16_t predicted = current_predictor_step(&current->predictor);
    const ab_t i_applied = transforms_inverse_park(predicted, angle_applied);
    const abc_t trim = modulation_dead_time(current->slope, i_applied);
    modulation_step(&current->modulation, u, trim, current->on_q16);
}

/* The next period's field-weakening current. A change of it re-applies the setpoint, also when it
 * has just returned to zero. */
static void weaken_field(foc_state_t *state, const config_t *config)
{
    const voltage_out_t *voltage = &state->period.voltage;
    const int32_t margin_q15 = field_weakening_margin_q15(
        &state->weakening, q_pair_x(voltage->applied.v), voltage_unsaturated(voltage).q);
    if (margin_q15 < 0) {
        current_controller_keep_reserve(&state->current.controller, voltage);
    }
    if (margin_q15 < 0 || state->weakening.current_q28 != 0) {
        field_weakening_step(&state->weakening, margin_q15,
                             config->current_loop.field_weakening_gain_pu_q15,
                             config->current_loop.field_weakening_current_pu_q15);
        state->sequence = FOC_NO_SETPOINT;
    }
}

static bool at_hall_edge(const rotor_state_t *rotor)
{
    return rotor->sensor == CONFIG_ROTOR_HALL && rotor->hall.periods_since_edge == 0;
}

/* A new setpoint that meets a hall edge waits one period, so that the two longest computations
 * never meet. */
static bool setpoint_is_due(foc_state_t *state)
{
    state->postponed = at_hall_edge(&state->rotor) && !state->postponed;
    return !state->postponed;
}

/* Returns true if the readings are frozen. A look comes one period before the other tasks. */
static bool do_spare_task(foc_state_t *state, const config_t *config, const foc_input_t *in)
{
    frozen_currents_t *const frozen = &state->current.frozen;
    const uint32_t step_count = state->spare_step++;
    if (at_hall_edge(&state->rotor)) {
        return false;
    }
    if (frozen_currents_due(&state->period) &&
        step_count - frozen->last_step >= SPARE_TASKS_PERIODS - 1U) {
        return frozen_currents_step(frozen, &state->period, in->phase_current_code);
    }
    state->spare_step = spare_tasks_next(step_count);
    weaken_field(state, config);
    emf_observer_acquire(&state->observer);
    return false;
}

/* |u| <= 1 and |i| <= 1.42: the sum of products is below 2^31. */
static void add_sums(foc_sums_t *sums, const foc_period_t *period)
{
    const q_pair_t i = period->i_pu.v;
    const foc_sums_t before = *sums;
    const foc_sums_t now = {
        .i_d_pu = before.i_d_pu + (uint32_t)q_pair_x(i),
        .i_q_pu = before.i_q_pu + (uint32_t)q_pair_y(i),
        .power_pu = before.power_pu + (uint32_t)(q_pair_dot(period->voltage.applied.v, i) >> 15),
        .v_dc_pu = before.v_dc_pu + (uint32_t)period->v_dc_pu,
    };
    *sums = now;
}

/* What both kinds of period begin and end with. Returns the number of this period. */
Q_TARGET_INLINE uint32_t begin_period(foc_state_t *state, const config_t *config,
                                      const fast_setpoint_t *setpoint, const foc_input_t *in)
{
    rotor_step(&state->rotor, config, in, &state->observer, setpoint->observer.lead_turn,
               &state->period.rotor);
    state->period.theta_turn = state->period.rotor.theta_turn;
    if (setpoint->observer.used) {
        state->period.theta_turn =
            (uint16_t)((state->observer.theta_q32 >> 16) - setpoint->observer.lead_turn);
    }
    return ++state->period.step_count;
}

static void end_period(foc_state_t *state, const foc_input_t *in)
{
    state->period.v_dc_pu = q_saturate13(in->bus_voltage_code) * 8;
    add_sums(&state->sums, &state->period);
}

bool foc_step(foc_state_t *state, const config_t *config, const fast_setpoint_t *setpoint,
              const foc_input_t *in)
{
    const uint32_t step_count = begin_period(state, config, setpoint, in);
    if (state->sequence != setpoint->sequence && setpoint_is_due(state)) {
        setpoint_apply(state, setpoint);
        state->spare_step = spare_tasks_after_setpoint(state->spare_step, step_count);
    }
    foc_current_step(state, in->phase_current_code);
    bool frozen = false;
    if (step_count == state->spare_step) {
        frozen = do_spare_task(state, config, in);
    }
    emf_observer_step(&state->observer, state->u_acting, state->period.i_ab_pu,
                      &setpoint->observer);
    state->u_acting = state->period.u_ab;
    end_period(state, in);
    return frozen;
}

void foc_idle_step(foc_state_t *state, const config_t *config, const fast_setpoint_t *setpoint,
                   const foc_input_t *in)
{
    (void)begin_period(state, config, setpoint, in);
    idle_step(state, setpoint, in->phase_current_code);
    end_period(state, in);
}

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
    report->rotor_valid = period->rotor.valid;
    report->rotor_faults = period->rotor.faults;
    report->observer.speed_q32 = speed_q32;
    report->observer.theta_turn = (uint16_t)((observer->theta_q32 - (uint32_t)speed_q32) >> 16);
    report->observer.sensor_turn = period->rotor.theta_turn;
    report->observer.acquired = observer->periods >= observer->acquisition_periods;
    report->quadrant_transitions = state->quadrant_transitions;
    report->quadrant_step = state->quadrant_step;
    report->idle_alpha_pu = state->idle_alpha_pu;
    report->idle_beta_pu = state->idle_beta_pu;
}

/* Phase currents of the period, recomputed from its dq vector. */
static abc_t phase_currents(const fast_report_t *report)
{
    const ab_t i = transforms_inverse_park(report->i_pu, angle_rotation(report->sample.theta_turn));
    const int32_t beta_part = (i.beta * SQRT3_2_Q15) >> 15;
    const int32_t half_alpha = i.alpha >> 1;
    const abc_t out = {.a = i.alpha, .b = beta_part - half_alpha, .c = -beta_part - half_alpha};
    return out;
}

void foc_report_complete(fast_report_t *report)
{
    const fast_sample_t *sample = &report->sample;
    const voltage_out_t voltage = {.unsaturated_d_q25 = sample->unsaturated_d_q25,
                                   .unsaturated_q_q25 = sample->unsaturated_q_q25,
                                   .applied = report->u_pu};
    const dq_t applied = dq_of(voltage.applied);
    const dq_t unsaturated = voltage_unsaturated(&voltage);
    report->voltage_use_q15 = modulation_index_square_q15(applied.d, unsaturated.q);
    report->voltage_limited = unsaturated.q != applied.q || unsaturated.d != applied.d;
    report->adc_saturated = sense_adc_saturated(report->offset_q4, phase_currents(report));
    report->observer.flux_q14 =
        transforms_park(sample->flux_q14, angle_rotation(report->observer.theta_turn));
}

void foc_init(foc_state_t *state, const config_t *config, int32_t timer_Hz)
{
    const foc_state_t zero = {0};
    *state = zero;
    state->current.modulation = modulation_init(config, timer_Hz);
    reference_prefilter_init(&state->prefilter, config);
    current_predictor_init(&state->current.predictor, config);
    field_weakening_init(&state->weakening, config);
    state->current_circle = circle_init(config->current_loop.max_current_pu_q15);
    sense_init(&state->current.sense, &config->drive);
    sensor_isolation_init(&state->current.isolation, config);
    rotor_init(&state->rotor, config);
    emf_observer_init(&state->observer, config);
    state->sequence = FOC_NO_SETPOINT;
    state->spare_step = spare_tasks_next(0);
    idle_centre_on_times(&state->current);
}

int32_t foc_modulation_limit_q15(const config_t *config, int32_t timer_Hz)
{
    return modulation_init(config, timer_Hz).limit_q15;
}

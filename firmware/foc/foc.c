/* SPDX-License-Identifier: Apache-2.0 */
#include "foc/foc.h"

#include "core/angle.h"
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
    period->u_ab = ab16_saturated(u);
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

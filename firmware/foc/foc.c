/* SPDX-License-Identifier: Apache-2.0 */
#include "foc/foc.h"

#include "core/angle.h"
#include "current_controller.h"
#include "current_predictor.h"
#include "emf_observer.h"
#include "field_weakening.h"
#include "idle_currents.h"
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

/* The rotor by its sensor, and the angle in use: the sensor's or the observer's. */
Q_TARGET_INLINE void estimate_rotor(foc_state_t *state, const config_t *config,
                                    const observer_tuning_t *tuning, const foc_input_t *in)
{
    foc_period_t *const period = &state->period;
    rotor_step(&state->rotor, config, in, &state->observer, tuning, &period->rotor);
    period->theta_turn = period->rotor.theta_turn;
    if (tuning->used) {
        period->theta_turn = emf_observer_rotor_turn(&state->observer, tuning);
    }
}

/* The observer gets the voltage that acts from this sample on: that of the period before. */
Q_TARGET_INLINE void observe_rotor(foc_state_t *state, const observer_tuning_t *tuning)
{
    emf_observer_step(&state->observer, state->u_acting, state->period.i_ab_pu, tuning);
    state->u_acting = state->period.u_ab;
}

static void end_period(foc_state_t *state, const foc_input_t *in)
{
    state->period.v_dc_pu = q_saturate13(in->bus_voltage_code) * 8;
    add_sums(&state->sums, &state->period);
}

bool foc_step(foc_state_t *state, const config_t *config, const fast_setpoint_t *setpoint,
              const foc_input_t *in)
{
    state->period.step_count++;
    estimate_rotor(state, config, &setpoint->observer, in);
    setpoint_step(state, setpoint);
    foc_current_step(state, in->phase_current_code);
    const bool frozen = spare_tasks_step(state, config, in->phase_current_code);
    observe_rotor(state, &setpoint->observer);
    end_period(state, in);
    return frozen;
}

static void measure_idle_current(foc_state_t *state, const uint16_t codes[SENSE_PHASES])
{
    foc_period_t *const period = &state->period;
    const sense_out_t sensed = sense_step(&state->current.sense, codes, state->current.on_q16);
    const ab16_t i = sensor_isolation_idle(&state->current, codes, sensed, period);
    period->i_ab_pu = i;
    period->current_sum_pu = sensed.sum_pu;
    period->i_pu = transforms_park(i, angle_rotation(period->theta_turn));
    idle_currents_step(&state->idle, i, period->step_count);
}

/* What only a switching bridge needs: zero, so that the next start is without a step. It applies
 * its setpoint at once, also at a hall edge. */
static void reset_control(foc_state_t *state)
{
    static const foc_period_t ZERO;
    foc_period_t *const period = &state->period;
    period->i_reference_pu = ZERO.i_reference_pu;
    period->voltage = ZERO.voltage;
    period->u_ab = ZERO.u_ab;
    state->u_acting = ZERO.u_ab;
    emf_observer_reset(&state->observer);
    current_controller_reset(&state->current.controller);
    reference_prefilter_reset(&state->prefilter);
    current_predictor_reset(&state->current.predictor);
    state->weakening.current_q28 = 0;
    modulation_centre(&state->current.modulation, state->current.on_q16);
    state->sequence = FOC_NO_SETPOINT;
    state->postponed = true;
    state->spare_step = spare_tasks_next(period->step_count);
}

/* The calibration begins anew when it is asked for again. */
static void calibrate_offsets(foc_state_t *state, bool wanted, const uint16_t codes[SENSE_PHASES])
{
    if (wanted) {
        if (!state->calibrating) {
            sense_calibrate_restart(&state->current.sense);
        }
        sense_calibrate_step(&state->current.sense, codes);
    }
    state->calibrating = wanted;
}

void foc_idle_step(foc_state_t *state, const config_t *config, const fast_setpoint_t *setpoint,
                   const foc_input_t *in)
{
    state->period.step_count++;
    estimate_rotor(state, config, &setpoint->observer, in);
    measure_idle_current(state, in->phase_current_code);
    reset_control(state);
    if (setpoint->clear_trip) {
        sensor_isolation_acknowledge(&state->current.isolation);
    }
    calibrate_offsets(state, setpoint->calibrate_offsets, in->phase_current_code);
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
    modulation_centre(&state->current.modulation, state->current.on_q16);
}

int32_t foc_modulation_limit_q15(const config_t *config, int32_t timer_Hz)
{
    return modulation_init(config, timer_Hz).limit_q15;
}

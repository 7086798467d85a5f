/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The whole steps of the fast loop: every kernel is called with what its proof assumes, and a state
 * within the ranges of fast_ranges.h stays within them. Each kernel is replaced by its contract:
 * NAME_by_contract() proves what the proof of the kernel assumes, gives any result within the
 * ranges proved there, and names that proof. What is not replaced are the sources that connect
 * them: foc.c, setpoint.c, spare_tasks.c, idle_currents.c.
 */
#include "core/circle.h"
#include "current_predictor.h"
#include "emf_observer.h"
#include "fast_ranges.h"
#include "field_weakening.h"
#include "frozen_currents.h"
#include "hall.h"
#include "idle_currents.h"
#include "modulation.h"
#include "reference_contracts.h"
#include "reference_prefilter.h"
#include "rotor.h"
#include "sensor_isolation.h"
#include "setpoint.h"
#include "spare_tasks.h"
#include "transforms.h"

/* The state before the step, of which the rotor estimate may change only in its own step. */
static rotor_state_t rotor_made;

/* prove_hall_step, prove_absolute_angle, prove_encoder: by induction over their own state, for any
 * reading, observer and lead angle. */
static void rotor_step_by_contract(rotor_state_t *state, const config_t *config,
                                   const foc_input_t *in, const emf_observer_t *observer,
                                   const observer_tuning_t *tuning, rotor_out_t *out)
{
    rotor_state_t any_state;
    rotor_out_t any_out;
    (void)config, (void)in, (void)observer, (void)tuning;
    any_state.sensor = state->sensor;
    rotor_made = any_state;
    *state = any_state;
    *out = any_out;
}
#define rotor_step rotor_step_by_contract

/* Tests at every angle. */
static rotation_t angle_rotation_by_contract(uint16_t theta_turn)
{
    (void)theta_turn;
    return any_rotation();
}
#define angle_rotation angle_rotation_by_contract

/* prove_sense */
static sense_out_t sense_step_by_contract(const sense_state_t *state,
                                          const uint16_t codes[SENSE_PHASES],
                                          const int32_t on_q16[SENSE_PHASES])
{
    const sense_out_t out = {.i = {.v = any_pair()},
                             .sum_pu = any_within(-MOST_READING_SUM_PU, MOST_READING_SUM_PU)};
    (void)on_q16;
    PROVE(sense_holds(state) && codes_hold(codes));
    return out;
}
#define sense_step sense_step_by_contract

/* prove_sense_calibration */
static void sense_calibrate_step_by_contract(sense_state_t *state,
                                             const uint16_t codes[SENSE_PHASES])
{
    sense_state_t any;
    PROVE(sense_holds(state) && codes_hold(codes));
    ASSUME(sense_holds(&any));
    *state = any;
}
#define sense_calibrate_step sense_calibrate_step_by_contract

/* prove_park */
static dq16_t transforms_park_by_contract(ab16_t x, rotation_t angle)
{
    const dq16_t out = {.v = any_pair()};
    PROVE(pair_holds(x.v) && pair_holds(angle.v) && rotation_holds(angle));
    return out;
}
#define transforms_park transforms_park_by_contract

/* prove_advance */
static rotation_t transforms_advance_by_contract(rotation_t angle, rotation_t by)
{
    const rotation_t out = {.v = any_pair()};
    PROVE(pair_holds(angle.v) && rotation_holds(angle));
    PROVE(pair_holds(by.v) && rotation_holds(by));
    ASSUME(turned_rotation_holds(out));
    return out;
}
#define transforms_advance transforms_advance_by_contract

/* prove_predicted_current */
static dq16_t predicted_pu;

static dq16_t current_predictor_step_by_contract(current_predictor_t *state)
{
    const dq16_t out = state->predicted_pu;
    PROVE(predictor_holds(state));
    predicted_pu = out;
    state->predicted_pu.v = any_pair();
    ASSUME(predictor_holds(state));
    return out;
}
#define current_predictor_step current_predictor_step_by_contract

/* prove_inverse_park. That a vector in a circle comes to lie within turned_holds() is derived
 * (SOUNDNESS.md, Lengths of vectors); recorded here is which vectors were turned. */
static struct {
    dq16_t of;
    ab_t to;
} turned[2];

static int turns;

static ab_t transforms_inverse_park_by_contract(dq16_t x, rotation_t angle)
{
    const ab_t out = {.alpha = any_within(-65535, 65535), .beta = any_within(-65535, 65535)};
    PROVE(pair_holds(x.v) && turned_rotation_holds(angle));
    PROVE(turns < 2);
    turned[turns].of = x;
    turned[turns].to = out;
    turns++;
    return out;
}
#define transforms_inverse_park transforms_inverse_park_by_contract

static bool is_turned(dq16_t x, ab_t to)
{
    bool out = false;
    for (int n = 0; n < turns; n++) {
        const dq16_t of = turned[n].of;
        out = out || (q_pair_x(of.v) == q_pair_x(x.v) && q_pair_y(of.v) == q_pair_y(x.v) &&
                      turned[n].to.alpha == to.alpha && turned[n].to.beta == to.beta);
    }
    return out;
}

/* prove_dead_time: the largest slopes; the products of smaller ones are smaller. */
static abc_t modulation_dead_time_by_contract(dead_time_slope_t slope, ab_t i)
{
    const abc_t out = {.a = any_within(-32768, 32767),
                       .b = any_within(-32768, 32767),
                       .c = any_within(-32767, 32768)};
    PROVE(slope_holds(slope));
    PROVE(is_turned(predicted_pu, i));
    return out;
}
#define modulation_dead_time modulation_dead_time_by_contract

/* prove_current_controller */
/* The latest voltage: in the unit circle (tests of circle_other_q15() for every d). */
static dq16_t applied;

static void current_controller_step_by_contract(current_controller_t *state,
                                                const current_gains_t *gains, dq16_t reference,
                                                dq16_t i, voltage_out_t *out)
{
    current_controller_t any_state;
    voltage_out_t any_out;
    PROVE(controller_holds(state) && gains_hold(gains));
    PROVE(pair_holds(reference.v) && pair_holds(i.v));
    ASSUME(controller_holds(&any_state) && voltage_holds(&any_out));
    *state = any_state;
    *out = any_out;
    applied = any_out.applied;
}
#define current_controller_step current_controller_step_by_contract

/* prove_modulation */
static void modulation_step_by_contract(const modulation_t *modulation, ab_t u, abc_t trim_q15,
                                        int32_t on_q16[SENSE_PHASES])
{
    PROVE(modulation_holds(modulation));
    PROVE(is_turned(applied, u));
    PROVE(within(trim_q15.a, -32768, 32767) && within(trim_q15.b, -32768, 32767) &&
          within(trim_q15.c, -32767, 32768));
    for (int x = 0; x < SENSE_PHASES; x++) {
        on_q16[x] = nondet_int32();
    }
}
#define modulation_step modulation_step_by_contract

/* prove_current_gains */
static current_gains_t current_gains_of_by_contract(const current_tuning_t *tuning,
                                                    int32_t weight_q15, dq_t target)
{
    current_gains_t out;
    PROVE(tuning_holds(tuning) && within(weight_q15, 0, MOST_WEIGHT_Q15));
    PROVE(vector_holds(target, MOST_TARGET_PU));
    ASSUME(gains_hold(&out));
    return out;
}
#define current_gains_of current_gains_of_by_contract

/* prove_field_weakening */
static int32_t weakening_margin_by_contract(const field_weakening_t *state, dq_t unsaturated)
{
    (void)unsaturated;
    PROVE(weakening_holds(state));
    return any_within(-65536, 32767);
}
#define field_weakening_margin_q15 weakening_margin_by_contract

static void field_weakening_step_by_contract(field_weakening_t *state, int32_t margin_q15,
                                             int32_t gain_q15, int32_t limit_q15)
{
    PROVE(weakening_holds(state) && within(margin_q15, -65536, 32767));
    PROVE(within(gain_q15, 0, 32767) && within(limit_q15, 0, 32767));
    state->current_q28 = any_within(-32767 * 8192, 0);
}
#define field_weakening_step field_weakening_step_by_contract

/* prove_sensor_isolation */
static void sensor_isolation_examine_by_contract(foc_period_t *period,
                                                 const uint16_t codes[SENSE_PHASES],
                                                 foc_current_state_t *current, int32_t sum_pu)
{
    sensor_isolation_t any_state;
    PROVE(sense_holds(&current->sense) && codes_hold(codes));
    PROVE(isolation_holds(&current->isolation));
    PROVE(within(current->predictor.weight_q15, 0, 32767));
    PROVE(pair_holds(period->i_ab_pu.v));
    PROVE(pair_holds(period->i_pu.v) && pair_holds(period->i_reference_pu.v));
    PROVE(pair_holds(period->voltage.applied.v));
    PROVE(within(period->current_sum_pu, -MOST_READING_SUM_PU, MOST_READING_SUM_PU));
    PROVE(within(sum_pu, -MOST_READING_SUM_PU, MOST_READING_SUM_PU));
    ASSUME(isolation_holds(&any_state));
    current->isolation = any_state;
    period->i_ab_pu.v = any_pair();
}
#define sensor_isolation_examine sensor_isolation_examine_by_contract

ab16_t sensor_isolation_idle(foc_current_state_t *current, const uint16_t codes[SENSE_PHASES],
                             sense_out_t sensed, const foc_period_t *period)
{
    sensor_isolation_t any_state;
    (void)period;
    PROVE(sense_holds(&current->sense) && codes_hold(codes));
    PROVE(isolation_holds(&current->isolation));
    PROVE(pair_holds(sensed.i.v));
    PROVE(within(sensed.sum_pu, -MOST_READING_SUM_PU, MOST_READING_SUM_PU));
    ASSUME(isolation_holds(&any_state));
    current->isolation = any_state;
    const ab16_t out = {.v = any_pair()};
    return out;
}

void sensor_isolation_acknowledge(sensor_isolation_t *state)
{
    sensor_isolation_t any_state;
    PROVE(isolation_holds(state));
    ASSUME(isolation_holds(&any_state));
    *state = any_state;
}

/* prove_frozen_currents. The latest result is recorded; without a look it is false. */
static bool found_frozen;

static bool frozen_currents_step_by_contract(frozen_currents_t *frozen, const foc_period_t *latest,
                                             const uint16_t codes[SENSE_PHASES])
{
    frozen_currents_t any_state;
    PROVE(pair_holds(latest->i_pu.v) && pair_holds(latest->i_reference_pu.v));
    PROVE(codes_hold(codes));
    *frozen = any_state;
    found_frozen = nondet_bool();
    return found_frozen;
}
#define frozen_currents_step frozen_currents_step_by_contract

/* prove_circle_of_any_radius: for every circle that circle_init() makes, here one of them. */
static circle_t circle_made;

static int32_t circle_other_by_contract(const circle_t *circle, int32_t x)
{
    PROVE(circle->radius_q15 == circle_made.radius_q15);
    PROVE(circle->inverse_q14 == circle_made.inverse_q14);
    PROVE(x >= -circle->radius_q15 && x <= circle->radius_q15);
    return any_within(0, circle->radius_q15);
}
#define circle_other circle_other_by_contract

/* prove_emf_observer_flux, prove_emf_observer_tracking */
static void emf_observer_step_by_contract(emf_observer_t *observer, ab16_t u, ab16_t i,
                                          const observer_tuning_t *tuning)
{
    emf_observer_t any_observer;
    PROVE(observer_holds(observer) && observer_tuning_holds(tuning));
    PROVE(pair_holds(u.v) && pair_holds(i.v));
    ASSUME(observer_holds(&any_observer));
    *observer = any_observer;
}
#define emf_observer_step emf_observer_step_by_contract

#include "setpoint.c"

#include "spare_tasks.c"

#include "idle_currents.c"

/* prove_add_sums */
static int32_t power_by_contract(q_pair_t u, q_pair_t i)
{
    PROVE(pair_holds(u) && q_pair_y(u) >= -Q15_ONE && pair_holds(i));
    return nondet_int32();
}
#define q_pair_dot power_by_contract

/* ---- initialisation ---- */

/* prove_modulation_of */
static modulation_t modulation_init_by_contract(const config_t *config, int32_t timer_Hz)
{
    modulation_t out;
    (void)config, (void)timer_Hz;
    ASSUME(modulation_holds(&out));
    return out;
}
#define modulation_init modulation_init_by_contract

/* tests/unit: the coefficients of every bandwidth. */
static void prefilter_init_by_contract(reference_prefilter_t *prefilter, const config_t *config)
{
    reference_prefilter_t any;
    (void)config;
    ASSUME(prefilter_holds(&any));
    *prefilter = any;
}
#define reference_prefilter_init prefilter_init_by_contract

static void predictor_init_by_contract(current_predictor_t *predictor, const config_t *config)
{
    current_predictor_t any;
    (void)config;
    ASSUME(predictor_holds(&any));
    *predictor = any;
}
#define current_predictor_init predictor_init_by_contract

/* prove_circle_of_any_radius: the inverse is that of circle_init(). */
static circle_t circle_init_by_contract(int32_t radius_q15)
{
    circle_made.radius_q15 = q_clamp(radius_q15, 164, Q15_ONE);
    circle_made.inverse_q14 = nondet_int32();
    return circle_made;
}
#define circle_init circle_init_by_contract

/* The last lines of each clamp what they derive from the configuration: read. */
static void isolation_init_by_contract(sensor_isolation_t *isolation, const config_t *config)
{
    sensor_isolation_t any;
    (void)config;
    ASSUME(isolation_holds(&any));
    *isolation = any;
}
#define sensor_isolation_init isolation_init_by_contract

static void observer_init_by_contract(emf_observer_t *observer, const config_t *config)
{
    emf_observer_t any;
    (void)config;
    ASSUME(observer_holds(&any));
    *observer = any;
}
#define emf_observer_init observer_init_by_contract

/* prove_hall_begin, prove_encoder_init */
static void rotor_init_by_contract(rotor_state_t *rotor, const config_t *config)
{
    rotor_state_t any;
    (void)config;
    *rotor = any;
}
#define rotor_init rotor_init_by_contract

#include "foc.c"

static bool state_holds(const foc_state_t *state)
{
    const foc_current_state_t *current = &state->current;
    return period_holds(&state->period) && gains_hold(&current->gains) &&
           pair_holds(current->advance.v) && rotation_holds(current->advance) &&
           slope_holds(current->slope) && controller_holds(&current->controller) &&
           modulation_holds(&current->modulation) && predictor_holds(&current->predictor) &&
           sense_holds(&current->sense) && isolation_holds(&current->isolation) &&
           observer_holds(&state->observer) && pair_holds(state->u_acting.v) &&
           within(circle_made.radius_q15, 164, Q15_ONE) &&
           state->current_circle.radius_q15 == circle_made.radius_q15 &&
           state->current_circle.inverse_q14 == circle_made.inverse_q14 &&
           prefilter_holds(&state->prefilter) && weakening_holds(&state->weakening);
}

static foc_state_t state;

static void any_step(void (*step)(foc_state_t *, const config_t *, const fast_setpoint_t *,
                                  const foc_input_t *))
{
    foc_state_t any_state;
    config_t config;
    fast_setpoint_t setpoint;
    foc_input_t in;
    state = any_state;
    circle_made = state.current_circle;
    config.current_loop.field_weakening_gain_pu_q15 = any_within(0, 32767);
    config.current_loop.field_weakening_current_pu_q15 = any_within(0, 32767);
    ASSUME(state_holds(&state) && setpoint_holds(&setpoint) && codes_hold(in.phase_current_code));
    const uint32_t before = state.period.step_count;
    step(&state, &config, &setpoint, &in);
    PROVE(state_holds(&state) && state.period.step_count == before + 1U);
    /* The rotor estimate is written by its own step only. */
    PROVE(state.rotor.hall.theta_q32 == rotor_made.hall.theta_q32 &&
          state.rotor.hall.periods_since_edge == rotor_made.hall.periods_since_edge &&
          state.rotor.encoder.theta_turn == rotor_made.encoder.theta_turn &&
          state.rotor.absolute.tracker.theta_q32 == rotor_made.absolute.tracker.theta_q32);
    PROOF_END();
}

void prove_whole_init(void)
{
    config_t config;
    config.drive.offset_a_q4 = any_within(0, 65520);
    config.drive.offset_b_q4 = any_within(0, 65520);
    config.drive.offset_c_q4 = any_within(0, 65520);
    config.current_loop.modulation_target_pu_q15 = any_within(16384, 32112);
    config.current_loop.max_current_pu_q15 = any_within(164, 32767);
    foc_init(&state, &config, nondet_int32());
    PROVE(state_holds(&state));
    PROOF_END();
}

static void step_with_bridge(foc_state_t *foc, const config_t *config,
                             const fast_setpoint_t *setpoint, const foc_input_t *in)
{
    found_frozen = false;
    const bool frozen = foc_step(foc, config, setpoint, in);
    PROVE(frozen == found_frozen);
}

void prove_whole_step(void)
{
    any_step(step_with_bridge);
}

void prove_whole_idle_step(void)
{
    any_step(foc_idle_step);
}

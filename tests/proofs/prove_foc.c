/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The modules of the fast loop: no overflow for any input that their headers allow, the output of
 * every limiter within its limits, every pulse within the period. Where a circle bounds a vector,
 * the proof uses some of the circle's tangents, which bound a larger set.
 */
#include "config/config.h"
#include "core/angle.h"
#include "current_controller.h"
#include "current_predictor.h"
#include "fast_ranges.h"
#include "modulation.h"
#include "modulation_index.h"
#include "sense.h"
#include "sensor_isolation.h"
#include "transforms.h"
#include "vectors.h"

/* A square is at most 2^30 (prove_square), the sum of two, shifted right by 15, at most 65 536. */
#define modulation_index_square_q15(unsaturated) ((void)(unsaturated), any_within(0, 65536))
#include "field_weakening.h"
#undef modulation_index_square_q15

/* Any square up to 2^31 (prove_pair_products), the same at every call of a proof. */
static uint32_t error_square;
#define q_pair_square(a) ((void)(a), error_square)
#include "frozen_currents.c"
#undef q_pair_square

static dq_t any_dq(void)
{
    const dq_t out = {.d = any_within(-32768, 32767), .q = any_within(-32768, 32767)};
    return out;
}

void prove_sense(void)
{
    sense_state_t state;
    uint16_t codes[3];
    int32_t on[3];
    for (int x = 0; x < 3; x++) {
        state.offset_q4[x] = any_within(0, SENSE_CODE_MAX * 16);
        codes[x] = nondet_uint16(); /* the header permits 12 bits; 16 are proved */
        on[x] = nondet_int32();
    }
    const sense_out_t out = sense_step(&state, codes, on);
    PROVE(pair_holds(out.i.v));
    PROVE(!codes_hold(codes) || within(out.sum_pu, -MOST_READING_SUM_PU, MOST_READING_SUM_PU));
    const abc_t phases = {.a = any_within(-65536, 65535),
                          .b = any_within(-65536, 65535),
                          .c = any_within(-65536, 65535)};
    (void)sense_adc_saturated(state.offset_q4, phases);
    PROOF_END();
}

void prove_sense_calibration(void)
{
    sense_state_t state;
    const uint16_t codes[3] = {nondet_uint16(), nondet_uint16(), nondet_uint16()};
    ASSUME(sense_holds(&state));
    sense_calibrate_step(&state, codes);
    PROVE(sense_holds(&state));
    sense_calibrate_restart(&state);
    PROVE(sense_holds(&state));
    PROOF_END();
}

/* Any state that the steps before can have left, any readings. */
void prove_sensor_isolation(void)
{
    foc_period_t period;
    foc_current_state_t current;
    uint16_t codes[3];
    sensor_isolation_t *state = &current.isolation;
    ASSUME(sense_holds(&current.sense) && codes_hold(codes) && isolation_holds(state));
    current.predictor.weight_q15 = any_within(0, 32767);
    period.i_ab_pu.v = any_pair();
    period.i_pu.v = any_pair();
    period.i_reference_pu.v = any_pair();
    period.voltage.applied.v = any_pair();
    period.current_sum_pu = any_within(-MOST_READING_SUM_PU, MOST_READING_SUM_PU);
    sensor_isolation_examine(&period, codes, &current,
                             any_within(-MOST_READING_SUM_PU, MOST_READING_SUM_PU));
    PROVE(pair_holds(period.i_ab_pu.v) && isolation_holds(state));
    const sense_out_t sensed = {
        .i = {.v = any_pair()},
        .sum_pu = any_within(-MOST_READING_SUM_PU, MOST_READING_SUM_PU),
    };
    PROVE(pair_holds(sensor_isolation_idle(&current, codes, sensed, &period).v));
    PROVE(isolation_holds(state));
    sensor_isolation_acknowledge(state);
    PROVE(isolation_holds(state));
    PROOF_END();
}

void prove_park(void)
{
    const ab16_t x = {.v = any_pair()};
    PROVE(pair_holds(transforms_park(x, any_rotation()).v));
    PROOF_END();
}

void prove_inverse_park(void)
{
    const dq16_t x = {.v = any_pair()};
    const rotation_t angle = {.v = any_pair()};
    ASSUME(turned_rotation_holds(angle));
    const ab_t out = transforms_inverse_park(x, angle);
    PROVE(within(out.alpha, -65535, 65535) && within(out.beta, -65535, 65535));
    PROOF_END();
}

void prove_advance(void)
{
    PROVE(turned_rotation_holds(transforms_advance(any_rotation(), any_rotation())));
    PROOF_END();
}

/* With any tuning and any target of the delay compensation. */
void prove_current_gains(void)
{
    current_tuning_t tuning;
    const dq_t target = {.d = any_within(-MOST_TARGET_PU, MOST_TARGET_PU),
                         .q = any_within(-MOST_TARGET_PU, MOST_TARGET_PU)};
    ASSUME(tuning_holds(&tuning));
    const current_gains_t gains = current_gains_of(&tuning, any_within(0, MOST_WEIGHT_Q15), target);
    PROVE(gains_hold(&gains));
    PROOF_END();
}

void prove_current_controller(void)
{
    current_gains_t gains;
    current_controller_t state;
    const dq16_t reference = {.v = any_pair()};
    const dq16_t i = {.v = any_pair()};
    ASSUME(gains_hold(&gains) && controller_holds(&state));
    voltage_out_t out;
    current_controller_step(&state, &gains, reference, i, &out);
    const dq_t applied = dq_of(out.applied);
    const dq_t unsaturated = voltage_unsaturated(&out);
    PROVE(voltage_holds(&out) && controller_holds(&state));
    /* The limiter lengthens no component and changes no sign. That circle_other_q15() leaves q what
     * is inside the circle is tested for every d in tests/unit. */
    PROVE(unsaturated.d >= 0 ? applied.d >= 0 && applied.d <= unsaturated.d
                             : applied.d <= 0 && applied.d >= unsaturated.d);
    PROVE(unsaturated.q >= 0 ? applied.q >= 0 && applied.q <= unsaturated.q
                             : applied.q <= 0 && applied.q >= unsaturated.q);
    PROOF_END();
}

void prove_field_weakening(void)
{
    const int32_t most = any_within(0, 32767);
    field_weakening_t state;
    ASSUME(weakening_holds(&state));
    const bool within_limit = state.current_q28 >= -most * 8192;
    const dq_t unsaturated = {.d = nondet_int32(), .q = nondet_int32()};
    const int32_t margin_q15 = field_weakening_margin_q15(&state, unsaturated);
    PROVE(within(margin_q15, -65536, 32767));
    field_weakening_step(&state, margin_q15, any_within(0, 32767), most);
    PROVE(weakening_holds(&state));
    PROVE(field_weakening_current_pu(&state) <= 0);
    PROVE(!within_limit || field_weakening_current_pu(&state) >= -most);
    PROOF_END();
}

void prove_dead_time(void)
{
    /* The steepest slopes of dead_time_slope_at(); the products of smaller ones are smaller. */
    const dead_time_slope_t steepest = {.alpha_q8 = 65000, .beta_q8 = 56292};
    const ab_t i = {.alpha = nondet_int32(), .beta = nondet_int32()};
    ASSUME(turned_holds(i, MOST_TURNED_CURRENT_PU));
    const abc_t shares = modulation_dead_time(steepest, i);
    PROVE(shares.a >= -32768 && shares.a <= 32767);
    PROVE(shares.b >= -32768 && shares.b <= 32767);
    PROVE(shares.c >= -32767 && shares.c <= 32768);
    PROOF_END();
}

/* The prediction stays between its last value and the settled current, whose distance is within 16
 * bits (current_predictor_change()). */
static bool between(int32_t a, int32_t x, int32_t b)
{
    return a <= b ? a <= x && x <= b : b <= x && x <= a;
}

void prove_predicted_current(void)
{
    current_predictor_t state;
    ASSUME(predictor_holds(&state));
    const dq_t settled = dq_of(state.settled_pu);
    const dq_t predicted = dq_of(state.predicted_pu);
    const dq_t out = dq_of(current_predictor_step(&state));
    const dq_t next = dq_of(state.predicted_pu);
    PROVE(out.d == predicted.d && out.q == predicted.q);
    PROVE(between(predicted.d, next.d, settled.d) && between(predicted.q, next.q, settled.q));
    PROVE(predictor_holds(&state));
    PROOF_END();
}

/* No overflow with the largest period, scale and trim that modulation_of() and the validator let
 * through. */
void prove_modulation(void)
{
    const int32_t period = any_within(256, 16384);
    const modulation_t modulation = {
        .centre_q16 = period * (1 << 15) + (1 << 15),
        .trim_doubled_counts = 4096,
        .alpha_counts = any_within(106, 28378),
        .beta_counts = any_within(61, 16384),
        .limit_q15 = 32767,
    };
    const abc_t trim = {.a = any_within(-32768, 32767),
                        .b = any_within(-32768, 32767),
                        .c = any_within(-32767, 32768)};
    int32_t on[3];
    const ab_t u = {.alpha = nondet_int32(), .beta = nondet_int32()};
    ASSUME(turned_holds(u, MOST_TURNED_VOLTAGE));
    modulation_step(&modulation, u, trim, on);
    PROOF_END();
}

/* Any state, any codes, any currents, any number of the period, also after it has wrapped. */
void prove_frozen_currents(void)
{
    frozen_currents_t state = {.begin_step = nondet_uint32(), .last_step = nondet_uint32()};
    foc_period_t period;
    uint16_t codes[SENSE_PHASES];
    for (int x = 0; x < SENSE_PHASES; x++) {
        state.code[x] = nondet_uint16();
        codes[x] = nondet_uint16();
    }
    period.i_pu.v = any_pair();
    period.i_reference_pu.v = any_pair();
    const uint32_t step_count = nondet_uint32();
    period.step_count = step_count;
    const frozen_currents_t before = state;
    const bool a = codes[0] == before.code[0];
    const bool b = codes[1] == before.code[1];
    const bool c = codes[2] == before.code[2];
    const bool stayed = step_count - before.last_step <= 8U && ((a && b) || (b && c) || (a && c));
    const uint32_t periods = step_count - before.begin_step;
    error_square = nondet_uint32();
    ASSUME(error_square <= UINT32_C(1) << 31);
    const bool due = frozen_currents_due(&period);
    const bool result = frozen_currents_step(&state, &period, codes);
    PROVE(due == (error_square >= 2097152U));
    PROVE(result == (stayed && periods >= (error_square >= 4194304U ? 8U : 12U)));
    PROVE(state.begin_step == (stayed ? before.begin_step : step_count));
    PROVE(state.last_step == step_count);
    for (int x = 0; x < SENSE_PHASES; x++) {
        PROVE(state.code[x] == codes[x]);
    }
    PROOF_END();
}

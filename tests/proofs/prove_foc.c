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
#include "field_weakening.h"
#include "modulation.h"
#include "sense.h"
#include "sensor_isolation.h"
#include "transforms.h"
#include "vectors.h"

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
    PROVE(q_pair_x(out.i.v) >= -32768 && q_pair_x(out.i.v) <= 32767);
    PROVE(q_pair_y(out.i.v) >= -32768 && q_pair_y(out.i.v) <= 32767);
    const abc_t phases = {.a = any_within(-65536, 65535),
                          .b = any_within(-65536, 65535),
                          .c = any_within(-65536, 65535)};
    (void)sense_adc_saturated(state.offset_q4, phases);
    PROOF_END();
}

void prove_sense_calibration(void)
{
    sense_state_t state;
    state.samples = (uint16_t)any_within(0, (1 << SENSE_CALIBRATION_LOG2) - 1);
    state.calibrated = false;
    uint16_t codes[3];
    for (int x = 0; x < 3; x++) {
        codes[x] = nondet_uint16();
        state.sum[x] = nondet_uint32();
        /* Largest sum of so many samples. */
        ASSUME(state.sum[x] <= (uint32_t)state.samples * SENSE_CODE_MAX);
        state.offset_q4[x] = any_within(0, SENSE_CODE_MAX * 16);
    }
    sense_calibrate_step(&state, codes);
    for (int x = 0; x < 3; x++) {
        PROVE(state.offset_q4[x] >= 0 && state.offset_q4[x] <= SENSE_CODE_MAX * 16);
        PROVE(state.calibrated || state.sum[x] <= (uint32_t)state.samples * SENSE_CODE_MAX);
    }
    PROOF_END();
}

/* Any state that the steps before can have left, any readings. */
void prove_sensor_isolation(void)
{
    foc_state_t foc;
    uint16_t codes[3];
    for (int x = 0; x < 3; x++) {
        foc.current.sense.offset_q4[x] = any_within(0, SENSE_CODE_MAX * 16);
        codes[x] = (uint16_t)any_within(0, SENSE_CODE_MAX);
    }
    sensor_isolation_t *state = &foc.current.isolation;
    state->implausible_pu = any_within(16, 32767);
    state->removed_share_q15 = any_within(0, 8192);
    state->l_q_over_l_d_q10 = any_within(0, 16384);
    state->l_d_over_l_q_q10 = any_within(0, 16384);
    state->predicted_pu.d = any_within(-65536, 65536);
    state->predicted_pu.q = any_within(-65536, 65536);
    state->change_pu.d = any_within(-(1 << 24), 1 << 24);
    state->change_pu.q = any_within(-(1 << 24), 1 << 24);
    state->begin_sum_pu = any_within(-3 * 65520, 3 * 65520);
    state->last_step = nondet_uint32();
    state->periods = nondet_uint16();
    state->agreeing = nondet_uint16();
    state->unknown = nondet_uint16();
    state->answer = (uint8_t)any_within(0, SENSE_PHASES);
    state->phase = (uint8_t)any_within(0, SENSE_PHASES);
    state->undetermined = any_within(0, 1) != 0;
    for (int x = 0; x < SENSE_PHASES; x++) {
        foc.current.on_q16[x] = nondet_int32();
    }
    foc.step_count = nondet_uint32();
    foc.current.predictor.weight_q15 = any_within(0, 32767);
    foc.period.rotor.speed_q32 = nondet_int32();
    foc.period.i_pu = dq16_of(any_dq());
    foc.period.i_reference_pu = dq16_of(any_dq());
    foc.period.voltage.applied = dq16_of(any_dq());
    foc.period.voltage.unsaturated_d_q25 = nondet_int32();
    foc.period.voltage.unsaturated_q_q25 = nondet_int32();
    foc.period.current_sum_pu = any_within(-3 * 65520, 3 * 65520);
    foc.period.theta_turn = nondet_uint16();
    const ab16_t out = sensor_isolation_examine(&foc, codes);
    PROVE(q_pair_x(out.v) >= -32768 && q_pair_x(out.v) <= 32767);
    PROVE(q_pair_y(out.v) >= -32768 && q_pair_y(out.v) <= 32767);
    PROVE(q_abs(state->predicted_pu.d) <= 65536 && q_abs(state->predicted_pu.q) <= 65536);
    PROVE(q_abs(state->change_pu.d) <= 1 << 24 && q_abs(state->change_pu.q) <= 1 << 24);
    PROVE(state->phase <= SENSE_PHASES && state->answer <= SENSE_PHASES);
    PROOF_END();
}

void prove_park(void)
{
    const ab16_t x = {.v = q_pair(any_within(-32768, 32767), any_within(-32768, 32767))};
    const dq_t out = dq_of(transforms_park(x, any_rotation()));
    PROVE(out.d >= -32768 && out.d <= 32767 && out.q >= -32768 && out.q <= 32767);
    PROOF_END();
}

void prove_inverse_park(void)
{
    const dq16_t x = {.v = q_pair(any_within(-32768, 32767), any_within(-32768, 32767))};
    (void)transforms_inverse_park(x, any_rotation());
    PROOF_END();
}

void prove_advance(void)
{
    const rotation_t out = transforms_advance(any_rotation(), any_rotation());
    PROVE(q_pair_x(out.v) >= -32768 && q_pair_x(out.v) <= 32767);
    PROVE(q_pair_y(out.v) >= -32768 && q_pair_y(out.v) <= 32767);
    PROOF_END();
}

static pi_gains_t any_gains(void)
{
    const pi_gains_t gains = {
        .proportional_q10 = any_within(0, PI_LARGEST_PROPORTIONAL_Q10),
        .integral_q15 = any_within(0, PI_LARGEST_INTEGRAL_Q15),
        .anti_windup_q15 = any_within(0, PI_LARGEST_ANTI_WINDUP_Q15),
    };
    return gains;
}

/* With any tuning and any target of the delay compensation. */
void prove_current_controller(void)
{
    const current_tuning_t tuning = {
        .d = any_gains(),
        .q = any_gains(),
        .w_l_d_q10 = any_within(-16383, 16383),
        .w_l_q_q10 = any_within(-16383, 16383),
        .forward_d_q25 = 0,
        .forward_q_q25 = any_within(-(1 << 28), 1 << 28),
    };
    const current_gains_t gains = current_gains_of(&tuning, any_within(0, 32767), any_dq());
    current_controller_t state = {
        .d = {.integrator_q30 = any_within(-(1 << 30), (1 << 30) - 1)},
        .q = {.integrator_q30 = any_within(-(1 << 30), (1 << 30) - 1)},
    };
    voltage_out_t out;
    current_controller_step(&state, &gains, dq16_of(any_dq()), dq16_of(any_dq()), &out);
    const dq_t applied = dq_of(out.applied);
    const dq_t unsaturated = voltage_unsaturated(&out);
    PROVE(applied.d >= -32768 && applied.d <= 32767);
    PROVE(applied.q >= -32767 && applied.q <= 32767);
    /* The limiter lengthens no component and changes no sign. That circle_other_q15() leaves q what
     * is inside the circle is tested for every d in tests/unit. */
    PROVE(unsaturated.d >= 0 ? applied.d >= 0 && applied.d <= unsaturated.d
                             : applied.d <= 0 && applied.d >= unsaturated.d);
    PROVE(unsaturated.q >= 0 ? applied.q >= 0 && applied.q <= unsaturated.q
                             : applied.q <= 0 && applied.q >= unsaturated.q);
    PROVE(state.d.integrator_q30 >= -(1 << 30) && state.d.integrator_q30 <= (1 << 30) - 1);
    PROVE(state.q.integrator_q30 >= -(1 << 30) && state.q.integrator_q30 <= (1 << 30) - 1);
    PROOF_END();
}

/* unsaturated_d_q25 as far as current_controller_step() makes it, see README.md: below 50 units. */
void prove_d_axis_reserve(void)
{
    current_controller_t state = {
        .d = {.integrator_q30 = any_within(-(1 << 30), (1 << 30) - 1)},
        .q = {.integrator_q30 = 0},
    };
    const int32_t before_q30 = state.d.integrator_q30;
    const voltage_out_t last = {.unsaturated_d_q25 = any_within(-50 * (1 << 25), 50 * (1 << 25))};
    current_controller_keep_reserve(&state, &last);
    PROVE(state.d.integrator_q30 >= -(1 << 30) && state.d.integrator_q30 <= (1 << 30) - 1);
    PROVE(last.unsaturated_d_q25 >= 0 ? state.d.integrator_q30 <= before_q30
                                      : state.d.integrator_q30 >= before_q30);
    PROOF_END();
}

void prove_field_weakening(void)
{
    const int32_t most = any_within(0, 32767);
    field_weakening_t state = {.current_q28 = nondet_int32(),
                               .target_square_q15 = any_within(8192, 31469)};
    ASSUME(state.current_q28 <= 0 && state.current_q28 >= -most * 8192);
    const int32_t margin_q15 =
        field_weakening_margin_q15(&state, any_within(-32768, 32768), nondet_int32());
    field_weakening_step(&state, margin_q15, any_within(0, 32767), most);
    PROVE(field_weakening_current_pu(&state) <= 0);
    PROVE(field_weakening_current_pu(&state) >= -most);
    PROOF_END();
}

/* Two of the three phase voltages of a vector within the unit circle (and 2 LSB for the rotation
 * that made it) are bounded by the circle's tangents across the phases' axes, sqrt 3/2 in Q15; the
 * first is alpha itself. */
static ab_t any_vector_in_circle(void)
{
    const ab_t x = {.alpha = any_within(-32770, 32770), .beta = any_within(-32770, 32770)};
    const int32_t across = (x.beta * TRANSFORMS_SQRT3_2_Q15) >> 15;
    const int32_t along = x.alpha >> 1;
    ASSUME(across - along <= 32771 && across - along >= -32771);
    ASSUME(-across - along <= 32771 && -across - along >= -32771);
    return x;
}

/* The same with the 24 LSB by which the predicted current may leave the circle (tests/unit), and
 * the 200 by which its mean may. */
static ab_t any_predicted_current(void)
{
    const ab_t x = {.alpha = any_within(-32994, 32994), .beta = any_within(-32994, 32994)};
    const int32_t across = (x.beta * TRANSFORMS_SQRT3_2_Q15) >> 15;
    const int32_t along = x.alpha >> 1;
    ASSUME(across - along <= 32995 && across - along >= -32995);
    ASSUME(-across - along <= 32995 && -across - along >= -32995);
    return x;
}

void prove_dead_time(void)
{
    /* The steepest slopes of dead_time_slope_at(); the products of smaller ones are smaller. */
    const dead_time_slope_t steepest = {.alpha_q8 = 65000, .beta_q8 = 56292};
    const abc_t shares = modulation_dead_time(steepest, any_predicted_current());
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
    const dq_t settled = any_dq();
    const dq_t predicted = any_dq();
    ASSUME(settled.d - predicted.d >= -32768 && settled.d - predicted.d <= 32767);
    ASSUME(settled.q - predicted.q >= -32768 && settled.q - predicted.q <= 32767);
    current_predictor_t state = {
        .lag_q16 = any_within(4096, 25788),
        .settled_pu = dq16_of(settled),
        .predicted_pu = dq16_of(predicted),
    };
    const dq_t out = dq_of(current_predictor_step(&state));
    const dq_t next = dq_of(state.predicted_pu);
    PROVE(out.d == predicted.d && out.q == predicted.q);
    PROVE(between(predicted.d, next.d, settled.d) && between(predicted.q, next.q, settled.q));
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
    modulation_step(&modulation, any_vector_in_circle(), trim, on);
    PROOF_END();
}

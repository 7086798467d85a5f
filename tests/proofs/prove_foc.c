/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The boxes of the fast loop: nothing overflows for any input their headers allow, every limiter
 * stays inside its limits, every pulse inside the period. Where a vector is bounded by a circle,
 * the proof uses the tangents of the circle that matter: they bound a larger set.
 */
#include "config/config.h"
#include "core/angle.h"
#include "current_controller.h"
#include "current_predictor.h"
#include "field_weakening.h"
#include "modulation.h"
#include "sense.h"
#include "transforms.h"
#include "vectors.h"

void prove_sense(void)
{
    sense_state_t state;
    uint16_t codes[3];
    int32_t on[3];
    for (int x = 0; x < 3; x++) {
        state.offset_q4[x] = any_within(0, SENSE_CODE_MAX * 16);
        codes[x] = nondet_uint16(); /* the header asks for 12 bits; even 16 do no harm */
        on[x] = nondet_int32();
    }
    const sense_out_t out = sense_step(&state, codes, on);
    PROMISE(out.i.alpha >= -32768 && out.i.alpha <= 32767);
    PROMISE(out.i.beta >= -37838 && out.i.beta <= 37838); /* 65 536 / sqrt 3 */
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
        /* What so many samples can have made. */
        ASSUME(state.sum[x] <= (uint32_t)state.samples * SENSE_CODE_MAX);
        state.offset_q4[x] = any_within(0, SENSE_CODE_MAX * 16);
    }
    sense_calibrate_step(&state, codes);
    for (int x = 0; x < 3; x++) {
        PROMISE(state.offset_q4[x] >= 0 && state.offset_q4[x] <= SENSE_CODE_MAX * 16);
        PROMISE(state.calibrated || state.sum[x] <= (uint32_t)state.samples * SENSE_CODE_MAX);
    }
    PROOF_END();
}

/* What sense_step() gives, see prove_sense(). */
static ab_t any_measured(void)
{
    const ab_t i = {.alpha = any_within(-32768, 32767), .beta = any_within(-37838, 37838)};
    return i;
}

void prove_park(void)
{
    const ab_t x = {.alpha = any_within(-32768, 32767), .beta = any_within(-37838, 37838)};
    (void)transforms_park(
        x, any_angle()); /* the length of the result is tested at every angle in tests/unit */
    PROOF_END();
}

void prove_inverse_park(void)
{
    const dq_t x = {.d = any_within(-32768, 32768), .q = any_within(-32768, 32768)};
    (void)transforms_inverse_park(x, any_angle());
    PROOF_END();
}

void prove_advance(void)
{
    (void)transforms_advance(any_angle(), any_angle());
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

/* What current_predictor_compensate() takes from the sampled current it gives to the target, see
 * prove_delay_compensation(). */
void prove_current_controller(void)
{
    const int32_t share_d_q10 = any_within(-16384, 16384);
    const int32_t share_q_q10 = any_within(-16384, 16384);
    const current_tuning_t tuning = {
        .d = any_gains(),
        .q = any_gains(),
        .w_l_d_q10 = any_within(-16383, 16383),
        .w_l_q_q10 = any_within(-16383, 16383),
        .forward_d_q25 = -(share_q_q10 * any_within(-32768, 32768)),
        .forward_q_q25 = any_within(-(1 << 28), 1 << 28) + share_d_q10 * any_within(-32768, 32768),
    };
    ASSUME(q_abs(tuning.w_l_d_q10) + q_abs(share_d_q10) <= 16384);
    ASSUME(q_abs(tuning.w_l_q_q10) + q_abs(share_q_q10) <= 16384);
    current_controller_t state = {
        .d = {.integrator_q30 = any_within(-(1 << 30), (1 << 30) - 1)},
        .q = {.integrator_q30 = any_within(-(1 << 30), (1 << 30) - 1)},
    };
    const dq_t reference = {.d = any_within(-32768, 32767), .q = any_within(-32768, 32767)};
    const dq_t i = {.d = any_within(-50200, 50200), .q = any_within(-50200, 50200)};
    voltage_out_t out;
    current_controller_step(&state, &tuning, reference, i, &out);
    PROMISE(out.applied.d >= -32768 && out.applied.d <= 32767);
    PROMISE(out.applied.q >= -32767 && out.applied.q <= 32767);
    /* The limiter: never longer and never of the other sign. That circle_other_q15() leaves q what
     * is inside the circle is tested for every d in tests/unit. */
    PROMISE(out.unsaturated_d >= 0 ? out.applied.d >= 0 && out.applied.d <= out.unsaturated_d
                                   : out.applied.d <= 0 && out.applied.d >= out.unsaturated_d);
    PROMISE(out.unsaturated_q >= 0 ? out.applied.q >= 0 && out.applied.q <= out.unsaturated_q
                                   : out.applied.q <= 0 && out.applied.q >= out.unsaturated_q);
    PROMISE(state.d.integrator_q30 >= -(1 << 30) && state.d.integrator_q30 <= (1 << 30) - 1);
    PROMISE(state.q.integrator_q30 >= -(1 << 30) && state.q.integrator_q30 <= (1 << 30) - 1);
    PROOF_END();
}

/* One axis; a target at the end of the current is where the product is largest. */
void prove_delay_compensation(void)
{
    current_tuning_t tuning = {
        .w_l_d_q10 = 0, .w_l_q_q10 = any_within(-16383, 16383), .forward_d_q25 = 0};
    const int32_t before_q10 = tuning.w_l_q_q10;
    const dq_t target = {.d = 0, .q = nondet_bool() ? 32768 : -32768};
    current_predictor_compensate(&tuning, any_within(0, 32767), target);
    const int32_t share_q10 = before_q10 - tuning.w_l_q_q10;
    PROMISE(q_abs(tuning.w_l_q_q10) + q_abs(share_q10) <= 16384);
    PROMISE(tuning.forward_d_q25 >= -16384 * 32768 && tuning.forward_d_q25 <= 16384 * 32768);
    PROOF_END();
}

/* unsaturated_d as far as current_controller_step() makes it, see README.md: below 50 units. */
void prove_d_axis_reserve(void)
{
    current_controller_t state = {
        .d = {.integrator_q30 = any_within(-(1 << 30), (1 << 30) - 1)},
        .q = {.integrator_q30 = 0},
    };
    const int32_t before_q30 = state.d.integrator_q30;
    const voltage_out_t last = {.unsaturated_d = any_within(-50 * 32768, 50 * 32768),
                                .unsaturated_q = 0,
                                .applied = {.d = 0, .q = 0}};
    current_controller_keep_reserve(&state, &last);
    PROMISE(state.d.integrator_q30 >= -(1 << 30) && state.d.integrator_q30 <= (1 << 30) - 1);
    PROMISE(last.unsaturated_d >= 0 ? state.d.integrator_q30 <= before_q30
                                    : state.d.integrator_q30 >= before_q30);
    PROOF_END();
}

void prove_field_weakening(void)
{
    const int32_t most = any_within(0, 32767);
    field_weakening_t state = {.current_q28 = nondet_int32()};
    ASSUME(state.current_q28 <= 0 && state.current_q28 >= -most * 8192);
    const int32_t margin_q15 =
        field_weakening_margin_q15(any_within(-32768, 32768), nondet_int32());
    field_weakening_step(&state, margin_q15, any_within(0, 32767), most);
    PROMISE(field_weakening_current_pu(&state) <= 0);
    PROMISE(field_weakening_current_pu(&state) >= -most);
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
    /* The steepest slopes dead_time_slope_at() makes: any flatter ones overflow less. */
    const dead_time_slope_t steepest = {.alpha_q8 = 65000, .beta_q8 = 56292};
    const abc_t shares = modulation_dead_time(steepest, any_predicted_current());
    PROMISE(shares.a >= -32768 && shares.a <= 32767);
    PROMISE(shares.b >= -32768 && shares.b <= 32767);
    PROMISE(shares.c >= -32767 && shares.c <= 32768);
    PROOF_END();
}

static bool shrinks(int32_t before, int32_t after)
{
    return before >= 0 ? after >= 0 && after <= before : after <= 0 && after >= before;
}

void prove_predicted_current(void)
{
    current_predictor_t state = {
        .lag_q15 = any_within(2048, 32767),
        .settled_pu = {.d = any_within(-32768, 32768), .q = any_within(-32768, 32768)},
        .remaining_pu = {.d = any_within(-65536, 65536), .q = any_within(-65536, 65536)},
    };
    const dq_t remaining = state.remaining_pu;
    const dq_t predicted = current_predictor_step(&state);
    PROMISE(predicted.d + remaining.d == state.settled_pu.d &&
            predicted.q + remaining.q == state.settled_pu.q);
    PROMISE(shrinks(remaining.d, state.remaining_pu.d) &&
            shrinks(remaining.q, state.remaining_pu.q));
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

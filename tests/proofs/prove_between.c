/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Messages between the loops: the sums of the fast loop and the mean values that the slow loop
 * computes from them. Vectors within a circle are assumed within its octagon, the larger set.
 */
#include "core/angle.h"
#include "sampling_correction.h"
#include "vectors.h"

#include "field_weakening.h"

/* The report uses one sine and cosine and one square of the modulation index. The proof replaces
 * them by any values possible, so that the checker need neither read the table nor multiply: a
 * square is at most 2^30 (prove_square), the sum of two, shifted right by 15, at most 65 536. */
#define angle_rotation(theta_turn) ((void)(theta_turn), any_rotation())
#define modulation_index_square_q15(unsaturated) ((void)(unsaturated), any_within(0, 65536))
#include "foc.c"
#include "report.c"
#undef modulation_index_square_q15
#undef angle_rotation
#include "operating_point.c"

enum { LONGEST_CURRENT_PU = 32767, LONGEST_VOLTAGE = 32767 };

/* The sums wrap by design and are unsigned; the addends must not overflow. */
void prove_add_sums(void)
{
    /* A sampled current of any components, a voltage of any but one. */
    const dq_t i = {.d = any_within(-32768, 32767), .q = any_within(-32768, 32767)};
    const dq_t u = {.d = any_within(-32768, 32767), .q = any_within(-32767, 32767)};
    const foc_period_t period = {
        .i_pu = dq16_of(i), .voltage = {.applied = dq16_of(u)}, .v_dc_pu = any_within(0, 65528)};
    const foc_sums_t before = {.i_d_pu = nondet_uint32(),
                               .i_q_pu = nondet_uint32(),
                               .power_pu = nondet_uint32(),
                               .v_dc_pu = nondet_uint32()};
    foc_sums_t sums = before;
    add_sums(&sums, &period);
    PROVE(sums.i_d_pu - before.i_d_pu == (uint32_t)i.d);
    PROVE(sums.v_dc_pu - before.v_dc_pu == (uint32_t)period.v_dc_pu);
    PROOF_END();
}

void prove_square(void)
{
    const int32_t x = any_within(-32768, 32768);
    PROVE(x * x >= 0 && x * x <= INT32_C(1) << 30);
    PROOF_END();
}

void prove_report(void)
{
    static foc_state_t state;
    const foc_period_t period = {
        .rotor = {.theta_turn = nondet_uint16()},
        .theta_turn = nondet_uint16(),
        .i_pu = dq16_of(any_vector(LONGEST_CURRENT_PU)),
        .voltage = {.unsaturated_d_q25 = nondet_int32(),
                    .unsaturated_q_q25 = nondet_int32(),
                    .applied = dq16_of(any_vector(LONGEST_VOLTAGE))},
    };
    state.period = period;
    for (int x = 0; x < SENSE_PHASES; x++) {
        state.current.sense.offset_q4[x] = any_within(0, SENSE_CODE_MAX * 16);
    }
    state.weakening.current_q28 = any_within(-32767 * 8192, 0);
    fast_report_t report;
    foc_report_copy(&state, &report);
    foc_report_complete(&report);
    PROVE(report.voltage_use_q15 >= 0 && report.voltage_use_q15 <= 65536);
    PROVE(report.i_d_weakening_pu <= 0 && report.i_d_weakening_pu >= -32767);
    PROOF_END();
}

void prove_mean_values(void)
{
    const fast_report_t report = {
        .sequence = nondet_uint16(),
        .sums = {.i_d_pu = nondet_uint32(),
                 .i_q_pu = nondet_uint32(),
                 .power_pu = nondet_uint32(),
                 .v_dc_pu = nondet_uint32()},
    };
    operating_point_state_t state = {
        .sums = {.i_d_pu = nondet_uint32(),
                 .i_q_pu = nondet_uint32(),
                 .power_pu = nondet_uint32(),
                 .v_dc_pu = nondet_uint32()},
        .sequence = nondet_uint16(),
        .v_dc_pu = nondet_int32(),
    };
    const operating_point_state_t before = state;
    average(&state, &report);
    PROVE(state.sequence == report.sequence);
    PROVE(report.sequence != before.sequence || state.v_dc_pu == before.v_dc_pu);
    PROOF_END();
}

/* After one fast step the mean is the value added, also where the sum has wrapped; after more steps
 * it is the difference of the sums divided by their number. */
void prove_difference_of_wrapping_sums(void)
{
    const int32_t added = nondet_int32();
    const uint32_t before = nondet_uint32();
    PROVE(mean(before + (uint32_t)added, before, 1) == added);
    PROOF_END();
}

static config_t config;

static void any_motor(void)
{
    config.motor.reference_temperature_cC = any_within(-5000, 15000);
    config.motor.flux_coefficient_ppm_K = any_within(-10000, 0);
    config.current_loop.flux_pu_q16 = any_within(1, 1048576);
    config.current_loop.inductance_d_pu_q16 = any_within(1, 1048576);
}

void prove_sampling_correction_at(void)
{
    any_motor();
    const sampling_correction_t at = sampling_correction_at(
        &config, sampling_correction_magnets_pu(&config), nondet_int32(), nondet_int32());
    PROVE(at.gain_q24 >= 0 && at.gain_q24 <= 1 << 20);
    PROVE(at.inverse_q24 >= 0 && at.inverse_q24 <= at.gain_q24);
    PROVE(at.magnets_pu >= 0 && at.magnets_pu <= 16 * 32768);
    PROOF_END();
}

void prove_sampling_correction(void)
{
    const int32_t gain_q24 = any_within(0, 1 << 20);
    const sampling_correction_t at = {.gain_q24 = gain_q24,
                                      .inverse_q24 = any_within(0, gain_q24),
                                      .magnets_pu = any_within(0, 16 * 32768)};
    const dq_t x = {.d = any_within(-131072, 131072), .q = any_within(-131072, 131072)};
    const dq_t mean = sampling_correction_to_mean(&at, x);
    const dq_t sampled = sampling_correction_to_sampled(&at, x);
    PROVE(x.q >= 0 ? mean.q >= 0 && mean.q <= x.q : mean.q <= 0 && mean.q >= x.q);
    PROVE(x.q >= 0 ? sampled.q >= x.q : sampled.q <= x.q);
    PROVE(mean.d >= -163841 && mean.d <= 163841 && sampled.d >= -163841 && sampled.d <= 172033);
    const int32_t change = any_within(-32767, 0);
    const int32_t mean_change = sampling_correction_mean_change(&at, change);
    PROVE(mean_change <= 0 && mean_change >= change);
    const int32_t offset = sampling_correction_d_pu(&at);
    PROVE(offset <= 0 && offset >= -32767);
    const int32_t commanded = any_within(0, INT32_MAX);
    const int32_t voltage = sampling_correction_mean_voltage(&at, commanded);
    PROVE(voltage >= 0 && voltage <= commanded);
    PROOF_END();
}

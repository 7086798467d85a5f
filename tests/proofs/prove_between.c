/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Between the reaches: what the fast one adds up and what the slow one makes of it. Vectors within
 * a circle are taken as within its octagon, the larger set.
 */
#include "core/angle.h"
#include "foc/foc.h"
#include "foc/sampled_current.h"
#include "foc/summary.h"
#include "vectors.h"

/* The summary asks for one sine and cosine; it gets those of any angle, without the checker having
 * to read their table. */
#define angle_sincos(theta_turn) ((void)(theta_turn), any_angle())
#include "summary.c"
#undef angle_sincos

enum {
    LONGEST_CURRENT_PU = 50200,
    LONGEST_VOLTAGE = 32769 /* 1 LSB beyond the circle, as circle_other_q15() may be */
};

/* The sums wrap by intention, so they are unsigned; what is added must not. */
void prove_add_up(void)
{
    const foc_period_t period = {.i_pu = any_vector(LONGEST_CURRENT_PU),
                                 .voltage = {.realised = any_vector(LONGEST_VOLTAGE)}};
    const foc_sums_t before = {.i_d_pu = nondet_uint32(),
                               .i_q_pu = nondet_uint32(),
                               .power_pu = nondet_uint32(),
                               .v_dc_pu = nondet_uint32()};
    foc_sums_t sums = before;
    const int32_t v_dc_pu = any_within(0, 32760);
    foc_add_up(&sums, &period, v_dc_pu);
    PROMISE(sums.i_d_pu - before.i_d_pu == (uint32_t)period.i_pu.d);
    PROMISE(sums.v_dc_pu - before.v_dc_pu == (uint32_t)v_dc_pu);
    PROOF_END();
}

void prove_summary(void)
{
    foc_report_t report = {
        .current = {.rotor = {.theta_turn = nondet_uint16()},
                    .i_pu = any_vector(LONGEST_CURRENT_PU),
                    .voltage = {.wanted_d = nondet_int32(),
                                .wanted_q = nondet_int32(),
                                .realised = {.d = any_within(-32768, 32767),
                                             .q = any_within(-32767, 32767)}}},
        .sums = {.i_d_pu = nondet_uint32(),
                 .i_q_pu = nondet_uint32(),
                 .power_pu = nondet_uint32(),
                 .v_dc_pu = nondet_uint32()},
    };
    for (int x = 0; x < SENSE_PHASES; x++) {
        report.offset_q4[x] = any_within(0, SENSE_CODE_MAX * 16);
    }
    foc_summary_state_t state = {
        .sums = {.i_d_pu = nondet_uint32(),
                 .i_q_pu = nondet_uint32(),
                 .power_pu = nondet_uint32(),
                 .v_dc_pu = nondet_uint32()},
        .fast_step_count = nondet_uint16(),
    };
    state.latest.v_dc_pu = nondet_int32();
    const uint16_t before = state.fast_step_count;
    const uint16_t now = nondet_uint16();
    const foc_summary_t out = foc_summary_step(&state, &report, now);
    PROMISE(state.fast_step_count == now);
    PROMISE(now != before || out.v_dc_pu == state.latest.v_dc_pu);
    PROOF_END();
}

/* One step: the mean is what was added, whichever way the sum has wrapped. With more it is that
 * divided. */
void prove_difference_of_wrapping_sums(void)
{
    const int32_t added = nondet_int32();
    const uint32_t before = nondet_uint32();
    PROMISE(mean(before + (uint32_t)added, before, 1) == added);
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

void prove_sampled_current_at(void)
{
    any_motor();
    const sampled_current_t at = sampled_current_at(&config, nondet_int32(), nondet_int32());
    PROMISE(at.gain_q24 >= 0 && at.gain_q24 <= 1 << 20);
    PROMISE(at.inverse_q24 >= 0 && at.inverse_q24 <= at.gain_q24);
    PROMISE(at.magnets_pu >= 0 && at.magnets_pu <= 16 * 32768);
    PROOF_END();
}

void prove_sampled_current(void)
{
    const int32_t gain_q24 = any_within(0, 1 << 20);
    const sampled_current_t at = {.gain_q24 = gain_q24,
                                  .inverse_q24 = any_within(0, gain_q24),
                                  .magnets_pu = any_within(0, 16 * 32768)};
    const dq_t x = {.d = any_within(-131072, 131072), .q = any_within(-131072, 131072)};
    const dq_t mean = sampled_current_to_mean(&at, x);
    const dq_t sampled = sampled_current_of_mean(&at, x);
    PROMISE(x.q >= 0 ? mean.q >= 0 && mean.q <= x.q : mean.q <= 0 && mean.q >= x.q);
    PROMISE(x.q >= 0 ? sampled.q >= x.q : sampled.q <= x.q);
    PROMISE(mean.d >= -163841 && mean.d <= 163841 && sampled.d >= -163841 && sampled.d <= 172033);
    const int32_t offset = sampled_current_offset_pu(&at);
    PROMISE(offset <= 0 && offset >= -32767);
    const int32_t told = any_within(0, INT32_MAX);
    const int32_t voltage = sampled_current_voltage_mean(&at, told);
    PROMISE(voltage >= 0 && voltage <= told);
    PROOF_END();
}

/* SPDX-License-Identifier: Apache-2.0 */
/*
 * fast_ranges.h: the ranges of what the kernels of the fast loop hand to each other. The proof of a
 * kernel assumes those of its inputs and proves those of its results; prove_composition.c proves
 * with the same conditions that foc_step() gives every kernel what its proof assumes.
 */
#ifndef FAST_RANGES_H
#define FAST_RANGES_H

#include "core/angle.h"
#include "core/sqrt3.h"
#include "current_controller.h"
#include "foc/foc.h"
#include "proof.h"
#include "reference_prefilter.h"
#include "sense.h"
#include "sensor_isolation.h"
#include "transforms.h"
#include "vectors.h"

enum {
    MOST_READING_SUM_PU = 3 * SENSE_CODE_MAX * 16,
    MOST_UNSATURATED_Q25 = 58 * (1 << 25), /* feed-forward and decoupling apart from each other */
    /* Prefilter and predictor: the largest coefficients of any bandwidth (tests/unit). */
    MOST_ONE_MINUS_B0_Q15 = 16384,
    MOST_MINUS_B2_Q15 = 9400,
    MOST_SHARE_Q15 = 4096,
    MOST_WEIGHT_Q15 = 17040,
    LEAST_TARGET_FIRST_Q15 = 25000,
    MOST_TARGET_FIRST_Q15 = 27525,
    LEAST_TARGET_SECOND_Q15 = 0,
    MOST_TARGET_SECOND_Q15 = 11141,
    LEAST_LAG_Q16 = 4096,
    MOST_LAG_Q16 = 25788,
    /* EMF observer: L_q I_base over 2 psi + 5/4 L_q I_base; poles of the tracking loop at most 5/16
     * of 1/T. */
    MOST_INDUCTANCE_Q15 = 26215,
    MOST_STEP_Q15 = 8191,
    MOST_LEAK_Q16 = 8192,
    MOST_PROPORTIONAL = 18625,
    MOST_INTEGRAL = 2910
};

static inline bool within(int32_t x, int32_t lowest, int32_t highest)
{
    return x >= lowest && x <= highest;
}

/* As packed on the Cortex-M4. */
static inline bool pair_holds(q_pair_t a)
{
    return within(q_pair_x(a), Q15_MIN, Q15_ONE) && within(q_pair_y(a), Q15_MIN, Q15_ONE);
}

static inline bool vector_holds(dq_t a, int32_t most)
{
    return within(a.d, -most, most) && within(a.q, -most, most);
}

/* What transforms_inverse_park() needs: the magnitudes of a product of two rotations add up to less
 * than 2, so that no product with a vector overflows. */
static inline bool turned_rotation_holds(rotation_t angle)
{
    return pair_holds(angle.v) && q_abs(q_pair_x(angle.v)) + q_abs(q_pair_y(angle.v)) < 65536;
}

/* 14 bits and sign, as current_gains_of() makes them of a tuning. */
static inline bool gains_hold(const current_gains_t *gains)
{
    return within(q_pair_x(gains->d_gain_q10), 0, PI_LARGEST_PROPORTIONAL_Q10) &&
           within(q_pair_y(gains->d_gain_q10), -16383, 16383) &&
           within(q_pair_x(gains->q_gain_q10), -16383, 16383) &&
           within(q_pair_y(gains->q_gain_q10), 0, PI_LARGEST_PROPORTIONAL_Q10) &&
           within(q_pair_x(gains->integral_q15), 0, PI_LARGEST_INTEGRAL_Q15) &&
           within(q_pair_y(gains->integral_q15), 0, PI_LARGEST_INTEGRAL_Q15) &&
           within(q_pair_x(gains->anti_windup_q15), 0, PI_LARGEST_ANTI_WINDUP_Q15) &&
           within(q_pair_y(gains->anti_windup_q15), 0, PI_LARGEST_ANTI_WINDUP_Q15) &&
           within(gains->forward_d_q25, -3 * (1 << 28), 3 * (1 << 28)) &&
           within(gains->forward_q_q25, -3 * (1 << 28), 3 * (1 << 28));
}

static inline bool pi_gains_hold(const pi_gains_t *gains)
{
    return within(gains->proportional_q10, 0, PI_LARGEST_PROPORTIONAL_Q10) &&
           within(gains->integral_q15, 0, PI_LARGEST_INTEGRAL_Q15) &&
           within(gains->anti_windup_q15, 0, PI_LARGEST_ANTI_WINDUP_Q15);
}

static inline bool tuning_holds(const current_tuning_t *tuning)
{
    return pi_gains_hold(&tuning->d) && pi_gains_hold(&tuning->q) &&
           within(tuning->w_l_d_q10, -16383, 16383) && within(tuning->w_l_q_q10, -16383, 16383) &&
           within(tuning->forward_d_q25, -(1 << 28), 1 << 28) &&
           within(tuning->forward_q_q25, -(1 << 28), 1 << 28);
}

/* A vector in the stator frame within a circle (SOUNDNESS.md, Lengths of vectors): alpha and two
 * of the circle's tangents, across the axes of the other phases, bound a larger set. */
static inline bool turned_holds(ab_t x, int32_t radius)
{
    if (!within(x.alpha, -radius, radius) || !within(x.beta, -radius, radius)) {
        return false;
    }
    const int32_t across = (x.beta * SQRT3_2_Q15) >> 15;
    const int32_t along = x.alpha >> 1;
    return within(across - along, -radius - 1, radius + 1) &&
           within(-across - along, -radius - 1, radius + 1);
}

enum {
    MOST_TURNED_VOLTAGE = 32775,   /* the unit circle, turned */
    MOST_TURNED_CURRENT_PU = 33000 /* besides 24 LSB by rounding, 200 by which a mean leaves it */
};

static inline bool slope_holds(dead_time_slope_t slope)
{
    return within(slope.alpha_q8, 0, 65000) && within(slope.beta_q8, 0, 56292);
}

static inline bool both_within(q_pair_t a, int32_t lowest, int32_t highest)
{
    return q_pair_x(a) == q_pair_y(a) && within(q_pair_x(a), lowest, highest);
}

static inline bool observer_tuning_holds(const observer_tuning_t *tuning)
{
    return both_within(tuning->volt, 0, MOST_STEP_Q15) &&
           both_within(tuning->minus_resistance, -MOST_STEP_Q15, 0) &&
           both_within(tuning->minus_leak, -MOST_LEAK_Q16, 0) &&
           both_within(tuning->minus_inductance, -MOST_INDUCTANCE_Q15, 0);
}

static inline bool bits31(int32_t x)
{
    return within(x, -(1 << 30), (1 << 30) - 1);
}

static inline bool controller_holds(const current_controller_t *state)
{
    return bits31(state->d.integrator_q30) && bits31(state->q.integrator_q30);
}

static inline bool voltage_holds(const voltage_out_t *voltage)
{
    return pair_holds(voltage->applied.v) && q_pair_y(voltage->applied.v) >= -Q15_ONE &&
           within(voltage->unsaturated_d_q25, -MOST_UNSATURATED_Q25, MOST_UNSATURATED_Q25);
}

static inline bool sense_holds(const sense_state_t *state)
{
    bool good = state->samples < 1U << SENSE_CALIBRATION_LOG2 || state->calibrated;
    for (int x = 0; x < SENSE_PHASES; x++) {
        good = good && within(state->offset_q4[x], 0, SENSE_CODE_MAX * 16) &&
               (state->calibrated || state->sum[x] <= (uint32_t)state->samples * SENSE_CODE_MAX);
    }
    return good;
}

static inline bool codes_hold(const uint16_t codes[SENSE_PHASES])
{
    return codes[0] <= SENSE_CODE_MAX && codes[1] <= SENSE_CODE_MAX && codes[2] <= SENSE_CODE_MAX;
}

static inline bool agreement_holds(const agreement_t *agreement, int32_t enough_periods)
{
    return within(agreement->periods, 0, enough_periods) &&
           within(agreement->turned, -65536, 65536);
}

/* agrees_periods: 20 ms at 4 .. 100 kHz. */
static inline bool isolation_holds(const sensor_isolation_t *state)
{
    const bool every = state->suspect_pu == SENSOR_ISOLATION_EVERY_SUM_PU;
    return (every || within(state->suspect_pu, 0, 8191)) &&
           state->suspect_range_pu == (every ? 0U : (uint32_t)(2 * state->suspect_pu)) &&
           within(state->implausible_pu, 16, 32767) && within(state->removed_share_q15, 0, 8192) &&
           within(state->l_q_over_l_d_q10, 0, 16384) && within(state->l_d_over_l_q_q10, 0, 16384) &&
           vector_holds(state->predicted_pu, 65536) && vector_holds(state->change_pu, 1 << 24) &&
           within(state->begin_sum_pu, -MOST_READING_SUM_PU, MOST_READING_SUM_PU) &&
           state->answer <= SENSE_PHASES && state->phase <= SENSE_PHASES &&
           within(state->agrees_periods, 80, 2000) &&
           within(state->proof_periods, state->agrees_periods,
                  SENSOR_ISOLATION_QUIET_MS / SENSOR_ISOLATION_AGREES_MS * state->agrees_periods) &&
           agreement_holds(&state->returned, state->agrees_periods) &&
           agreement_holds(&state->proved, state->proof_periods);
}

/* Current references before the one in use lie in the circle; with the changes that count as zero
 * they seem to lie 127 outside. */
enum { MOST_PAST_PU = 32768 + REFERENCE_PREFILTER_THRESHOLD_PU - 1, MOST_TARGET_PU = 33100 };

static inline bool prefilter_holds(const reference_prefilter_t *prefilter)
{
    return within(prefilter->one_minus_b0_q15, 0, MOST_ONE_MINUS_B0_Q15) &&
           within(prefilter->minus_b2_q15, 0, MOST_MINUS_B2_Q15) &&
           vector_holds(prefilter->reference_pu, 32768) &&
           vector_holds(prefilter->change_pu, 65536) &&
           within(prefilter->reference_pu.d - prefilter->change_pu.d, -MOST_PAST_PU,
                  MOST_PAST_PU) &&
           within(prefilter->reference_pu.q - prefilter->change_pu.q, -MOST_PAST_PU, MOST_PAST_PU);
}

/* One component of a reference_change_t. */
static inline bool part_holds(int32_t reference, int32_t total, int32_t now, int32_t before)
{
    return within(reference, -32768, 32768) && within(total, -65536, 65536) &&
           within(before, -65536, 65536) && within(reference - total, -32768, 32768) &&
           within(reference - total - before, -MOST_PAST_PU, MOST_PAST_PU) &&
           now == reference_prefilter_threshold(total);
}

static inline bool change_holds(const reference_change_t *change)
{
    return part_holds(change->reference.d, change->total.d, change->now.d, change->before.d) &&
           part_holds(change->reference.q, change->total.q, change->now.q, change->before.q);
}

/* The distance to the settled current is within 16 bits as well (current_predictor_change()). */
static inline bool predictor_holds(const current_predictor_t *state)
{
    const dq_t settled = dq_of(state->settled_pu);
    const dq_t predicted = dq_of(state->predicted_pu);
    return within(state->lag_q16, LEAST_LAG_Q16, MOST_LAG_Q16) &&
           within(state->first_q15, 0, MOST_SHARE_Q15) &&
           within(state->second_q15, 0, MOST_SHARE_Q15) &&
           within(state->weight_q15, 0, MOST_WEIGHT_Q15) &&
           within(state->target_first_q15, LEAST_TARGET_FIRST_Q15, MOST_TARGET_FIRST_Q15) &&
           within(state->target_second_q15, LEAST_TARGET_SECOND_Q15, MOST_TARGET_SECOND_Q15) &&
           pair_holds(state->settled_pu.v) && pair_holds(state->predicted_pu.v) &&
           within(settled.d - predicted.d, Q15_MIN, Q15_ONE) &&
           within(settled.q - predicted.q, Q15_MIN, Q15_ONE);
}

static inline bool weakening_holds(const field_weakening_t *state)
{
    return within(state->current_q28, -32767 * 8192, 0) &&
           within(state->target_square_q15, 8192, 31469);
}

static inline bool modulation_holds(const modulation_t *modulation)
{
    return within(modulation->centre_q16, 256 * (1 << 15), 16384 * (1 << 15) + (1 << 15)) &&
           within(modulation->trim_doubled_counts, 0, 4096) &&
           within(modulation->alpha_counts, 106, 28378) &&
           within(modulation->beta_counts, 61, 16384);
}

static inline bool observer_gains_hold(observer_gains_t gains)
{
    return within(gains.proportional, 0, MOST_PROPORTIONAL) &&
           within(gains.integral, 0, MOST_INTEGRAL);
}

static inline bool observer_holds(const emf_observer_t *observer)
{
    return bits31(observer->alpha_q30) && bits31(observer->beta_q30) &&
           bits31(observer->speed_q32) && bits31(observer->start_speed_q32) &&
           observer_gains_hold(observer->gains) && observer_gains_hold(observer->acquisition) &&
           observer_gains_hold(observer->tracking) && q_abs(q_pair_x(observer->x.v)) <= 32768 &&
           q_abs(q_pair_y(observer->x.v)) <= 32768;
}

static inline bool period_holds(const foc_period_t *period)
{
    return pair_holds(period->i_ab_pu.v) && pair_holds(period->i_reference_pu.v) &&
           pair_holds(period->i_pu.v) && voltage_holds(&period->voltage) &&
           pair_holds(period->u_ab.v) &&
           within(period->current_sum_pu, -MOST_READING_SUM_PU, MOST_READING_SUM_PU) &&
           within(period->v_dc_pu, 0, 65528);
}

/* What current_tuning(), dead_time_slope_at() and observer_tuning() make (prove_init.c). */
static inline bool setpoint_holds(const fast_setpoint_t *setpoint)
{
    return within(setpoint->i_reference_pu.d, Q15_MIN, Q15_ONE) &&
           within(setpoint->i_reference_pu.q, Q15_MIN, Q15_ONE) &&
           tuning_holds(&setpoint->tuning) && pair_holds(setpoint->tuning.advance.v) &&
           rotation_holds(setpoint->tuning.advance) && slope_holds(setpoint->dead_time_slope) &&
           observer_tuning_holds(&setpoint->observer);
}

#endif

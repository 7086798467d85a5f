/* SPDX-License-Identifier: Apache-2.0 */
/* Current controller: feed-forward, priority of d, anti-windup, d-axis voltage reserve. */
#include "current_controller.h"

#include <math.h>
#include <stdlib.h>

#include "tuning.h"
#include "unity.h"
#include "winding.h"

extern const config_t CONFIG_LU2013;

static config_t config;
static current_controller_t state;

void setUp(void)
{
    config = CONFIG_LU2013;
    current_controller_reset(&state);
}

void tearDown(void) {}

static current_tuning_t tuned_at(int32_t speed_q32)
{
    const winding_t winding = winding_constants(&config);
    return current_tuning(&config, &winding, 27493, 28102, speed_q32,
                          config.motor.reference_temperature_cC);
}

static current_tuning_t plain_tuning(void)
{
    return tuned_at(0);
}

/* The voltages of a period, without delay compensation. */
typedef struct {
    dq_t unsaturated, applied;
} voltages_t;

static voltage_out_t period;

static voltages_t step(const current_tuning_t *tuning, int32_t d, int32_t q, int32_t i_d,
                       int32_t i_q)
{
    const dq_t no_target = {.d = 0, .q = 0};
    const dq_t reference = {.d = d, .q = q};
    const dq_t i = {.d = i_d, .q = i_q};
    const current_gains_t gains = current_gains_of(tuning, 0, no_target);
    current_controller_step(&state, &gains, dq16_of(reference), dq16_of(i), &period);
    const voltages_t out = {.unsaturated = voltage_unsaturated(&period),
                            .applied = dq_of(period.applied)};
    return out;
}

void test_voltage_is_zero_at_zero_error_and_speed(void)
{
    const current_tuning_t tuning = plain_tuning();
    for (int n = 0; n < 100; n++) {
        const voltages_t out = step(&tuning, 700, -900, 700, -900);
        TEST_ASSERT_EQUAL_INT32(0, out.applied.d);
        TEST_ASSERT_EQUAL_INT32(0, out.applied.q);
    }
}

void test_voltage_at_zero_current_is_the_back_emf(void)
{
    const current_tuning_t tuning = tuned_at(20000000);
    const voltages_t out = step(&tuning, 0, 0, 0, 0);
    TEST_ASSERT_EQUAL_INT32(0, out.applied.d);
    TEST_ASSERT_INT32_WITHIN(1, tuning.forward_q_q25 >> 10, out.applied.q);
}

void test_cross_coupling_has_the_sign_of_the_motor_equations(void)
{
    /* u_d holds -w L_q i_q, u_q holds +w L_d i_d. */
    const current_tuning_t still = plain_tuning();
    current_tuning_t tuning = still;
    tuning.w_l_q_q10 = 512; /* 0.5 */
    tuning.w_l_d_q10 = 256; /* 0.25 */
    const voltages_t out = step(&tuning, 6000, 8000, 6000, 8000);
    TEST_ASSERT_INT32_WITHIN(1, -4000, out.applied.d);
    TEST_ASSERT_INT32_WITHIN(1, 1500, out.applied.q);
}

void test_d_axis_has_priority_and_q_has_the_remaining_voltage(void)
{
    current_tuning_t tuning = plain_tuning();
    tuning.d.proportional_q10 = 1024;
    tuning.q.proportional_q10 = 1024;
    for (int32_t d = 0; d <= 32110; d += 111) {
        current_controller_reset(&state);
        const voltages_t out = step(&tuning, d, -32768, 0, 0);
        TEST_ASSERT_INT32_WITHIN(1, d, out.applied.d);
        TEST_ASSERT_TRUE(out.applied.q <= 0);
        TEST_ASSERT_TRUE(hypot(out.applied.d, out.applied.q) <= 32769.0);
        /* The interpolated root falls short by 0.8 % at most where the circle is not steep. */
        if (d < 31700) {
            TEST_ASSERT_TRUE(out.applied.q <=
                             -0.992 * sqrt(32768.0 * 32768.0 - (double)d * d) + 2.0);
        }
    }
}

void test_the_unsaturated_voltage_is_reported(void)
{
    current_tuning_t tuning = plain_tuning();
    tuning.d.proportional_q10 = 2048;
    tuning.q.proportional_q10 = 4096;
    const voltages_t out = step(&tuning, -20000, -20000, 0, 0);
    TEST_ASSERT_EQUAL_INT32(-40000, out.unsaturated.d);
    TEST_ASSERT_EQUAL_INT32(-80000, out.unsaturated.q);
    TEST_ASSERT_EQUAL_INT32(-32256, out.applied.d); /* 63/64 of the circle */
}

void test_each_integrator_is_updated_with_the_applied_voltage(void)
{
    /* In one step an integrator advances by k_i e + k_i/k_p (u - k_p e) where k_p e is too much by
     * about a half, by k_i e where not. u is 1, of a weakening d 63/64. */
    current_tuning_t tuning = plain_tuning();
    tuning.d.proportional_q10 = 3 * 1024;
    tuning.d.integral_q15 = 300;
    tuning.d.anti_windup_q15 = 100;
    tuning.q.proportional_q10 = 2 * 1024;
    tuning.q.integral_q15 = 400;
    tuning.q.anti_windup_q15 = 200;
    step(&tuning, -16384, 0, 0, 0);
    TEST_ASSERT_DOUBLE_WITHIN(0.1, 300.0 * -0.5 + 100.0 * (1.5 - 63.0 / 64.0),
                              state.d.integrator_q30 / 32768.0);
    current_controller_reset(&state);
    step(&tuning, 0, -24576, 0, 0);
    TEST_ASSERT_DOUBLE_WITHIN(0.1, 400.0 * -0.75 + 200.0 * (1.5 - 1.0),
                              state.q.integrator_q30 / 32768.0);
    current_controller_reset(&state);
    step(&tuning, 100, 100, 0, 0);
    TEST_ASSERT_EQUAL_INT32(300 * 100, state.d.integrator_q30);
    TEST_ASSERT_EQUAL_INT32(400 * 100, state.q.integrator_q30);
}

static current_tuning_t tuning_with_gains(double proportional, double integral)
{
    current_tuning_t tuning = plain_tuning();
    tuning.d.proportional_q10 = (int32_t)lround(proportional * 1024.0);
    tuning.d.integral_q15 = (int32_t)lround(integral * 32768.0);
    tuning.d.anti_windup_q15 = (int32_t)lround(integral / proportional * 32768.0);
    tuning.q = tuning.d;
    return tuning;
}

/* With u at the limit, u_applied = k_p e_r + I defines the conditioned error e_r that gives the
 * applied voltage. The integrator follows I' = I + k_i e_r = I + k_i (u_applied - I) / k_p: it
 * tends to u_applied with the time constant k_p / k_i, for any error and any duration of the
 * limit, in the last case with four times the circle wanted. */
void test_an_integrator_settles_at_what_the_circle_leaves(void)
{
    static const struct {
        double proportional;
        int32_t error, applied_d;
    } CASES[] = {{2.0, 16000, -31727}, {2.0, -16000, -31727}, {4.0, 32767, -14283}};
    const double integral = 1600.0 / 32768.0; /* of which a half and a quarter are exact as well */
    for (int c = 0; c < 3; c++) {
        current_tuning_t tuning = tuning_with_gains(CASES[c].proportional, integral);
        tuning.forward_d_q25 = CASES[c].applied_d * 1024;
        const double limit = copysign(circle_other_q15(CASES[c].applied_d), CASES[c].error);
        double expected = 0.0;
        current_controller_reset(&state);
        for (int n = 0; n < 500; n++) {
            step(&tuning, 0, CASES[c].error, 0, 0);
            expected += integral * (limit - expected) / CASES[c].proportional;
            TEST_ASSERT_DOUBLE_WITHIN(1.0, expected, state.q.integrator_q30 / 32768.0);
        }
        TEST_ASSERT_EQUAL_INT32(0, state.d.integrator_q30);
    }
}

/* The integrator is at the limit. An error of -0.05 with k_p = 2 takes 0.1 of it in the next step.
 */
void test_a_voltage_leaves_its_limit_in_the_first_step_after_the_error_changes_sign(void)
{
    current_tuning_t tuning = tuning_with_gains(2.0, 0.05);
    tuning.forward_d_q25 = -28377 * 1024; /* leaves one half */
    for (int n = 0; n < 10000; n++) {
        step(&tuning, 0, 20000, 0, 0);
    }
    TEST_ASSERT_INT32_WITHIN(70, 16384 - 3277, step(&tuning, 0, -1638, 0, 0).applied.q);
}

void test_the_integrators_saturate_at_full_scale_and_do_not_wrap(void)
{
    const int32_t full_q30 = (1 << 30) - 1;
    current_tuning_t tuning = plain_tuning();
    tuning.d.proportional_q10 = 1;
    tuning.d.integral_q15 = PI_LARGEST_INTEGRAL_Q15;
    tuning.d.anti_windup_q15 = PI_LARGEST_ANTI_WINDUP_Q15;
    tuning.q = tuning.d;
    for (int32_t sign = -1; sign <= 1; sign += 2) {
        current_controller_reset(&state);
        for (int n = 0; n < 10; n++) {
            step(&tuning, sign * 32767, 0, 0, 0);
        }
        TEST_ASSERT_INT32_WITHIN(1, sign * full_q30, state.d.integrator_q30);
        current_controller_reset(&state);
        for (int n = 0; n < 10; n++) {
            step(&tuning, 0, sign * 32767, 0, 0);
        }
        TEST_ASSERT_INT32_WITHIN(1, sign * full_q30, state.q.integrator_q30);
    }
}

void test_an_error_of_one_lsb_is_never_lost(void)
{
    current_tuning_t tuning = plain_tuning();
    tuning.d.integral_q15 = 1;
    tuning.q.integral_q15 = 1;
    for (int n = 0; n < 1000; n++) {
        step(&tuning, -1, 1, 0, 0);
    }
    TEST_ASSERT_EQUAL_INT32(-1000, state.d.integrator_q30);
    TEST_ASSERT_EQUAL_INT32(1000, state.q.integrator_q30);
}

void test_a_reset_clears_the_integrators(void)
{
    const current_tuning_t tuning = plain_tuning();
    for (int n = 0; n < 50; n++) {
        step(&tuning, 3000, 3000, 0, 0);
    }
    TEST_ASSERT_NOT_EQUAL(0, state.q.integrator_q30);
    current_controller_reset(&state);
    TEST_ASSERT_EQUAL_INT32(0, state.d.integrator_q30);
    TEST_ASSERT_EQUAL_INT32(0, state.q.integrator_q30);
}

void test_currents_at_the_ends_of_their_formats_do_not_overflow(void)
{
    /* Components of sampled currents and references up to 1.0, cross coupling 16. */
    static const int32_t ENDS[] = {-32768, -20000, 0, 20000, 32767};
    current_tuning_t tuning = plain_tuning();
    tuning.d.proportional_q10 = PI_LARGEST_PROPORTIONAL_Q10;
    tuning.q.proportional_q10 = PI_LARGEST_PROPORTIONAL_Q10;
    for (int sign = -1; sign <= 1; sign += 2) {
        tuning.w_l_d_q10 = sign * 16383;
        tuning.w_l_q_q10 = sign * 16383;
        tuning.forward_q_q25 = sign * (1 << 28);
        for (int d = 0; d < 5; d++) {
            for (int q = 0; q < 5; q++) {
                for (int r = -1; r <= 1; r += 2) {
                    const voltages_t out = step(&tuning, r * 32767, -r * 32767, ENDS[d], ENDS[q]);
                    TEST_ASSERT_TRUE(hypot(out.applied.d, out.applied.q) <= 32769.0);
                }
            }
        }
    }
}

/* Less than half of the circle leaves q enough whatever it wants. */
void test_braking_d_voltage_leaves_q_what_holds_its_current(void)
{
    const current_tuning_t tuning = tuning_with_gains(1.0, 0.0);
    for (int32_t steady = -32000; steady <= 32000; steady += 500) {
        for (int32_t error = -20000; error <= 20000; error += 4000) {
            current_controller_reset(&state);
            current_tuning_t at = tuning;
            at.forward_d_q25 = 2 << 25; /* twice the circle */
            at.forward_q_q25 = steady * 1024;
            const voltages_t out = step(&at, 0, error, 0, 0);
            const double wanted = fabs((double)steady + error);
            const double reserve = fmin(fmax(fmin(wanted, abs(steady) + 3277.0), 5898.0), 28377.0);
            const double left = sqrt(fmax(32768.0 * 32768.0 - reserve * reserve, 0.0));
            TEST_ASSERT_TRUE(out.applied.d <= left + 1.0);
            TEST_ASSERT_TRUE(out.applied.d >= 0.99 * left - 2.0);
            /* What is left beside an axis is up to 0.8 % short. */
            TEST_ASSERT_TRUE(fabs((double)out.applied.q) >= 0.99 * fmin(wanted, reserve) - 2.0);
            TEST_ASSERT_TRUE(hypot(out.applied.d, out.applied.q) <= 32769.0);
            at.forward_d_q25 =
                -(2 << 25); /* the field is weakened by it: sqrt(1 - (63/64)^2) for q */
            const voltages_t weakened = step(&at, 0, error, 0, 0);
            TEST_ASSERT_EQUAL_INT32(-32256, weakened.applied.d);
            TEST_ASSERT_TRUE(fabs((double)weakened.applied.q) >= 0.99 * fmin(wanted, 5770.0) - 2.0);
            at.forward_d_q25 = 16384 * 1024;
            TEST_ASSERT_EQUAL_INT32(16384, step(&at, 0, error, 0, 0).applied.d);
        }
    }
}

/* ---- in whole numbers ---- */

/* Half of the target and half of the sampled current: of w L_d = 1/2 and w L_q = 1 a half each. */
void test_delay_compensation_divides_the_decoupling_between_sample_and_target(void)
{
    current_tuning_t tuning = plain_tuning();
    tuning.w_l_d_q10 = 512;
    tuning.w_l_q_q10 = 1024;
    tuning.forward_d_q25 = 100000;
    tuning.forward_q_q25 = 200000;
    const dq_t target = {.d = 3000, .q = -5000};
    const current_gains_t gains = current_gains_of(&tuning, 16384, target);
    TEST_ASSERT_EQUAL_INT32(tuning.d.proportional_q10, q_pair_x(gains.d_gain_q10));
    TEST_ASSERT_EQUAL_INT32(-512, q_pair_y(gains.d_gain_q10));
    TEST_ASSERT_EQUAL_INT32(256, q_pair_x(gains.q_gain_q10));
    TEST_ASSERT_EQUAL_INT32(tuning.q.proportional_q10, q_pair_y(gains.q_gain_q10));
    TEST_ASSERT_EQUAL_INT32(100000 + 512 * 5000, gains.forward_d_q25);
    TEST_ASSERT_EQUAL_INT32(200000 + 256 * 3000, gains.forward_q_q25);
}

/* 2^20 of 2^30 are 32 of 2^15, in either axis. */
void test_an_integrator_is_a_voltage(void)
{
    state.d.integrator_q30 = 1 << 20;
    state.q.integrator_q30 = 3 << 20;
    const current_tuning_t tuning = plain_tuning();
    const voltages_t out = step(&tuning, 0, 0, 0, 0);
    TEST_ASSERT_EQUAL_INT32(32, out.applied.d);
    TEST_ASSERT_EQUAL_INT32(96, out.applied.q);
}

/* 32 of 2^30 are one of 2^25. */
void test_gain_feed_forward_and_integrator_add_up_with_all_their_bits(void)
{
    current_tuning_t tuning = tuning_with_gains(1.0, 0.0);
    tuning.forward_d_q25 = -1234567;
    tuning.forward_q_q25 = 7654321;
    state.d.integrator_q30 = 32;
    state.q.integrator_q30 = -64;
    step(&tuning, 7, -9, 0, 0);
    TEST_ASSERT_EQUAL_INT32(7 * 1024 - 1234567 + 1, period.unsaturated_d_q25);
    TEST_ASSERT_EQUAL_INT32(-9 * 1024 + 7654321 - 2, period.unsaturated_q_q25);
}

/* 36 times the circle, nearly the end of the format: what d leaves of the circle, odd and even. */
void test_a_voltage_far_beyond_the_circle_is_applied_as_what_d_leaves(void)
{
    for (int32_t sign = -1; sign <= 1; sign += 2) {
        for (int32_t d = 0; d < 20000; d += 777) {
            current_tuning_t tuning = plain_tuning();
            tuning.forward_d_q25 = -d * 1024;
            tuning.forward_q_q25 = sign * 1200000000;
            current_controller_reset(&state);
            const voltages_t out = step(&tuning, 0, 0, 0, 0);
            TEST_ASSERT_EQUAL_INT32(-d, out.applied.d);
            TEST_ASSERT_EQUAL_INT32(sign * circle_other_q15(d), out.applied.q);
        }
    }
}

/* SPDX-License-Identifier: Apache-2.0 */
/* The PI controller: formats of the gains, and the integrator's update with the applied output. */
#include <math.h>
#include <stdlib.h>

#include "core/pi.h"
#include "unity.h"

void setUp(void) {}

void tearDown(void) {}

static pi_gains_t gains_of(double proportional, double integral)
{
    const pi_gains_t gains = {
        .proportional_q10 = (int32_t)lround(proportional * 1024.0),
        .integral_q15 = (int32_t)lround(integral * 32768.0),
        .anti_windup_q15 = (int32_t)lround(integral / proportional * 32768.0),
    };
    return gains;
}

/* The largest value short of 1.0 in Q30. */
enum { INTEGRATOR_FULL_Q30 = (1 << 30) - 1 };

static double integrator_of(const pi_state_t *state)
{
    return (double)state->integrator_q30 / 1073741824.0;
}

/* Without feed-forward, in Q15. */
static int32_t output(const pi_state_t *state, const pi_gains_t *gains, int32_t error)
{
    return pi_output_q25(state, gains, error, 0) >> 10;
}

void test_feed_forward_is_added_with_all_its_bits(void)
{
    const pi_gains_t gains = gains_of(1.0, 0.125);
    const pi_state_t state = {.integrator_q30 = 32}; /* one unit of Q25 */
    TEST_ASSERT_EQUAL_INT32(7 * 1024 - 1234567 + 1, pi_output_q25(&state, &gains, 7, -1234567));
}

void test_output_is_gain_times_error_plus_the_integral(void)
{
    const pi_gains_t gains = gains_of(2.5, 0.25);
    const pi_state_t state = {.integrator_q30 = 1 << 28}; /* 0.25 */
    for (int32_t error = INT16_MIN; error <= INT16_MAX; error++) {
        const double exact = 2.5 * error + 0.25 * 32768.0;
        const double got = output(&state, &gains, error);
        TEST_ASSERT_TRUE(got <= exact && got > exact - 1.0); /* rounded down, once */
    }
}

void test_the_output_before_the_limit_may_exceed_one_and_does_not_wrap(void)
{
    const pi_gains_t gains = {
        .proportional_q10 = PI_LARGEST_PROPORTIONAL_Q10, .integral_q15 = 1, .anti_windup_q15 = 1};
    const pi_state_t high = {.integrator_q30 = INTEGRATOR_FULL_Q30};
    const pi_state_t low = {.integrator_q30 = -INTEGRATOR_FULL_Q30};
    /* 16 * 1 + 1 = 17 */
    TEST_ASSERT_INT32_WITHIN(64, 17 * 32768, output(&high, &gains, 32767));
    TEST_ASSERT_INT32_WITHIN(64, -17 * 32768, output(&low, &gains, -32768));
}

void test_integrator_sums_the_error_exactly_without_a_limit(void)
{
    const pi_gains_t gains = gains_of(1.0, 0.125);
    pi_state_t state = {0};
    for (int n = 0; n < 100; n++) {
        const int32_t u = output(&state, &gains, 80);
        pi_update(&state, &gains, 80, u, u);
    }
    TEST_ASSERT_EQUAL_INT32(100 * 80 * 4096, state.integrator_q30); /* 0.125 = 4096 / 2^15 */
}

void test_an_error_of_one_lsb_is_never_lost(void)
{
    const pi_gains_t gains = {.proportional_q10 = 1024, .integral_q15 = 1, .anti_windup_q15 = 1};
    pi_state_t state = {0};
    for (int n = 0; n < 1000; n++) {
        const int32_t u = output(&state, &gains, -1);
        pi_update(&state, &gains, -1, u, u);
    }
    TEST_ASSERT_EQUAL_INT32(-1000, state.integrator_q30);
}

/* With the actuator at its limit, u_real = k_p e_r + I defines the conditioned error e_r that gives
 * the applied output. The integrator follows I' = I + k_i e_r = I + k_i (u_real - I) / k_p: it
 * tends to u_real with the time constant k_p / k_i, for any error and any duration of the limit. */
void test_integrator_settles_at_the_limit_of_the_output(void)
{
    const pi_gains_t gains = gains_of(2.0, 0.05);
    pi_state_t state = {0};
    double expected = 0.0;
    for (int n = 0; n < 400; n++) {
        const int32_t u = output(&state, &gains, 16000);
        const int32_t realised = q_clamp(u, -8192, 8192);
        pi_update(&state, &gains, 16000, u, realised);
        expected += 0.05 * (0.25 - expected) / 2.0;
        TEST_ASSERT_DOUBLE_WITHIN(0.002, expected, integrator_of(&state));
    }
    TEST_ASSERT_DOUBLE_WITHIN(0.002, 0.25, integrator_of(&state));
}

void test_integrator_settles_at_the_limit_with_four_times_its_output(void)
{
    /* k_p = 4 and a full-scale error give an output of 3.1 above the limit. The integrator still
     * tends to the limit. */
    const pi_gains_t gains = gains_of(4.0, 0.05);
    pi_state_t state = {0};
    double expected = 0.0;
    for (int n = 0; n < 500; n++) {
        const int32_t u = output(&state, &gains, 32767);
        const int32_t realised = q_clamp(u, -29491, 29491); /* 0.9 */
        pi_update(&state, &gains, 32767, u, realised);
        expected += 0.05 * (0.9 - expected) / 4.0;
        TEST_ASSERT_DOUBLE_WITHIN(0.01, expected, integrator_of(&state));
    }
}

void test_output_leaves_the_limit_in_the_first_step_after_the_error_changes_sign(void)
{
    const pi_gains_t gains = gains_of(2.0, 0.05);
    pi_state_t state = {0};
    for (int n = 0; n < 10000; n++) {
        const int32_t u = output(&state, &gains, 20000);
        pi_update(&state, &gains, 20000, u, q_clamp(u, -16384, 16384));
    }
    /* The integrator is at the limit, 0.5. An error of -0.05 lowers the output by 0.1 in the next
     * step. */
    TEST_ASSERT_INT32_WITHIN(70, 16384 - 3277, output(&state, &gains, -1638));
}

void test_the_integrator_saturates_at_full_scale_and_does_not_wrap(void)
{
    const pi_gains_t gains = {.proportional_q10 = 1,
                              .integral_q15 = PI_LARGEST_INTEGRAL_Q15,
                              .anti_windup_q15 = PI_LARGEST_ANTI_WINDUP_Q15};
    static const int16_t ERRORS[] = {32767, -32768};
    for (int i = 0; i < 2; i++) {
        pi_state_t state = {0};
        for (int n = 0; n < 10; n++) {
            const int32_t u = output(&state, &gains, ERRORS[i]);
            pi_update(&state, &gains, ERRORS[i], u, u);
            TEST_ASSERT_TRUE(abs(state.integrator_q30) <= INTEGRATOR_FULL_Q30 + 1);
        }
        TEST_ASSERT_INT32_WITHIN(1, i == 0 ? INTEGRATOR_FULL_Q30 : -INTEGRATOR_FULL_Q30,
                                 state.integrator_q30);
    }
}

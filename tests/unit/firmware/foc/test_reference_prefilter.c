/* SPDX-License-Identifier: Apache-2.0 */
/* Reference prefilter against the designed response. */
#include "design_response.h"
#include "prefilter_rig.h"

void setUp(void)
{
    rig_up();
}

void tearDown(void) {}

void test_response_to_a_prefiltered_step_is_the_designed_one_at_every_sample(void)
{
    /* i[n+2] = i[n+1] + K (r[n] - i[n]): winding, current controller and delay. */
    for (int k = 0; k < BANDWIDTHS; k++) {
        config.current_loop.bandwidth_Hz = BANDWIDTHS_Hz[k];
        start();
        const double b = half_period(BANDWIDTHS_Hz[k]);
        const double gain = b * b * (1.0 - b * b);
        const dq_t reference = {.d = -9000, .q = 20000};
        double now_d = 0.0, next_d = 0.0, now_q = 0.0, next_q = 0.0;
        for (int n = 0; n < 100; n++) {
            TEST_ASSERT_DOUBLE_WITHIN(3.0, reference.d * designed(b, n), now_d);
            TEST_ASSERT_DOUBLE_WITHIN(3.0, reference.q * designed(b, n), now_q);
            const dq_t given = apply(reference).reference_pu;
            const double after_d = next_d + gain * (given.d - now_d);
            const double after_q = next_q + gain * (given.q - now_q);
            now_d = next_d;
            now_q = next_q;
            next_d = after_d;
            next_q = after_q;
        }
    }
}

void test_without_the_prefilter_the_response_deviates_by_5_percent_at_the_first_sample(void)
{
    const double b = half_period(1000);
    TEST_ASSERT_TRUE(b * b * (1.0 - b * b) - designed(b, 2) > 0.05);
}

void test_response_to_any_references_is_the_superposition_of_step_responses(void)
{
    config.current_loop.bandwidth_Hz = 1000;
    start();
    const double b = half_period(1000);
    const double gain = b * b * (1.0 - b * b);
    random_t random = random_seeded(7);
    double reference[200], now = 0.0, next = 0.0;
    int32_t wanted = 0;
    for (int n = 0; n < 200; n++) {
        wanted =
            random_chance(&random, 0.4) ? (int32_t)random_real(&random, -32000.0, 32000.0) : wanted;
        reference[n] = wanted;
        double exact = 0.0;
        for (int k = 0; k <= n; k++) {
            exact += (reference[k] - (k > 0 ? reference[k - 1] : 0.0)) * designed(b, n - k);
        }
        TEST_ASSERT_DOUBLE_WITHIN(10.0, exact, now);
        const dq_t target = {.d = 0, .q = wanted};
        const double after = next + gain * (apply(target).reference_pu.q - now);
        now = next;
        next = after;
    }
}

void test_output_settles_in_the_third_period_after_a_step(void)
{
    start();
    const dq_t reference = {.d = 100, .q = -7000};
    for (int n = 0; n < 6; n++) {
        const dq_t given = apply(reference).reference_pu;
        TEST_ASSERT_EQUAL_INT(n >= 2, prefilter.settled);
        if (n >= 2) {
            TEST_ASSERT_EQUAL_MEMORY(&reference, &given, sizeof(given));
        } else {
            TEST_ASSERT_TRUE(n == 0 ? given.q > reference.q : given.q < reference.q);
        }
    }
}

static int32_t nearest_q15(double x_q24)
{
    return (int32_t)floor((x_q24 + 256.0) / 512.0);
}

/* b0 = 1/(b^2 (1 + b)) and b2 = 1 - 1/b in whole steps of Q24, rounded down. */
void test_coefficients_are_exact_to_the_last_unit(void)
{
    const double one = 16777216.0;
    for (int32_t bandwidth_Hz = 10; bandwidth_Hz <= 1600; bandwidth_Hz++) {
        config.current_loop.bandwidth_Hz = bandwidth_Hz;
        start();
        const double b = (double)design_half_period_q24(&config);
        const double inverse = floor(floor(b * b / one) * (one + b) / one);
        TEST_ASSERT_EQUAL_INT32(nearest_q15(one - floor(one * one / inverse)),
                                prefilter.one_minus_b0_q15);
        TEST_ASSERT_EQUAL_INT32(nearest_q15(floor(one * one / b) - one), prefilter.minus_b2_q15);
    }
}

void test_changes_below_the_threshold_are_not_shaped(void)
{
    TEST_ASSERT_EQUAL_INT32(128, reference_prefilter_threshold(128));
    TEST_ASSERT_EQUAL_INT32(0, reference_prefilter_threshold(127));
    TEST_ASSERT_EQUAL_INT32(0, reference_prefilter_threshold(0));
    TEST_ASSERT_EQUAL_INT32(0, reference_prefilter_threshold(-127));
    TEST_ASSERT_EQUAL_INT32(-128, reference_prefilter_threshold(-128));
}

void test_reset_forgets_the_reference_and_its_change(void)
{
    start();
    const dq_t reference = {.d = -9000, .q = 20000};
    (void)apply(reference);
    reference_prefilter_reset(&prefilter);
    TEST_ASSERT_EQUAL_INT32(0, prefilter.reference_pu.d);
    TEST_ASSERT_EQUAL_INT32(0, prefilter.reference_pu.q);
    TEST_ASSERT_EQUAL_INT32(0, prefilter.change_pu.d);
    TEST_ASSERT_EQUAL_INT32(0, prefilter.change_pu.q);
}

/* SPDX-License-Identifier: Apache-2.0 */
/* Current predictor against the designed response. */
#include "design_response.h"
#include "prefilter_rig.h"
#include "setpoint.h"

void setUp(void)
{
    rig_up();
}

void tearDown(void) {}

void test_predicted_current_is_that_in_the_middle_of_each_period(void)
{
    for (int k = 1; k < BANDWIDTHS;
         k++) { /* the first is slower than rounding lets it be expected */
        config.current_loop.bandwidth_Hz = BANDWIDTHS_Hz[k];
        start();
        const double b = half_period(BANDWIDTHS_Hz[k]);
        const dq_t before = {.d = -3000, .q = 7000};
        const dq_t after = {.d = 1000, .q = -9000};
        for (int n = 0; n < 400; n++) {
            (void)apply(before);
            (void)current_predictor_step(&predictor);
        }
        for (int n = 0; n < 100; n++) {
            if (!prefilter.settled || n == 0) {
                (void)apply(after);
            }
            const dq_t expected = dq_of(current_predictor_step(&predictor));
            const double come = 0.5 * (designed(b, n + 1) + designed(b, n + 2));
            /* Remainder by rounding: below 1/lag, 16 LSB, of each change. */
            TEST_ASSERT_DOUBLE_WITHIN(32.0, before.d + come * (after.d - before.d), expected.d);
            TEST_ASSERT_DOUBLE_WITHIN(32.0, before.q + come * (after.q - before.q), expected.q);
        }
    }
}

void test_delay_compensation_gives_the_current_in_the_middle_of_the_period_of_the_voltage(void)
{
    for (int k = 0; k < BANDWIDTHS; k++) {
        config.current_loop.bandwidth_Hz = BANDWIDTHS_Hz[k];
        start();
        const double b = half_period(BANDWIDTHS_Hz[k]);
        const double weight = predictor.weight_q15 / 32768.0;
        const dq_t reference = {.d = -9000, .q = 20000};
        for (int n = 0; n < 30; n++) {
            const dq_t target = apply(reference).target_pu;
            const double then = 0.5 * (designed(b, n + 1) + designed(b, n + 2));
            TEST_ASSERT_DOUBLE_WITHIN(3.0, reference.d * then,
                                      weight * target.d +
                                          (1.0 - weight) * reference.d * designed(b, n));
            TEST_ASSERT_DOUBLE_WITHIN(3.0, reference.q * then,
                                      weight * target.q +
                                          (1.0 - weight) * reference.q * designed(b, n));
        }
    }
}

void test_the_predicted_mean_may_differ_from_the_reference(void)
{
    start();
    const dq_t reference = {.d = 0, .q = 3000};
    const dq_t expected = {.d = -25, .q = 3000};
    for (int n = 0; n < 200; n++) {
        const shaped_t given = shape(&prefilter, &predictor, reference, expected);
        const dq_t now = dq_of(current_predictor_step(&predictor));
        TEST_ASSERT_EQUAL_INT32(-25, now.d); /* it is there from the start */
        TEST_ASSERT_EQUAL_INT32(0, given.reference_pu.d);
    }
    TEST_ASSERT_INT_WITHIN(4, 3000, dq_of(current_predictor_step(&predictor)).q);
}

void test_lag_is_at_least_a_sixteenth_and_the_bandwidth_is_clamped(void)
{
    config.current_loop.bandwidth_Hz = 10;
    start();
    TEST_ASSERT_EQUAL_INT32(65536 / 16, predictor.lag_q16);
    config.current_loop.bandwidth_Hz = 1592;
    start();
    const reference_prefilter_t fastest = prefilter;
    const int32_t fastest_lag_q16 = predictor.lag_q16;
    TEST_ASSERT_DOUBLE_WITHIN(2.0, 65536.0 * (1.0 - exp(-0.5)), fastest_lag_q16);
    config.current_loop.bandwidth_Hz = 10000;
    config.drive.pwm_frequency_Hz = 4000;
    start();
    TEST_ASSERT_EQUAL_INT32(fastest_lag_q16, predictor.lag_q16);
    TEST_ASSERT_EQUAL_INT32(fastest.one_minus_b0_q15, prefilter.one_minus_b0_q15);
    TEST_ASSERT_EQUAL_INT32(fastest.minus_b2_q15, prefilter.minus_b2_q15);
}

void test_coefficients_are_in_the_range_that_the_proofs_assume(void)
{
    static const int32_t FREQUENCIES_Hz[] = {4000, 20000, 100000};
    for (int k = 0; k < 3; k++) {
        config.drive.pwm_frequency_Hz = FREQUENCIES_Hz[k];
        for (int32_t bandwidth_Hz = 10; bandwidth_Hz <= 10000; bandwidth_Hz++) {
            config.current_loop.bandwidth_Hz = bandwidth_Hz;
            start();
            TEST_ASSERT_TRUE(prefilter.one_minus_b0_q15 >= 0 &&
                             prefilter.one_minus_b0_q15 <= 16384);
            TEST_ASSERT_TRUE(prefilter.minus_b2_q15 >= 0 && prefilter.minus_b2_q15 <= 9400);
            TEST_ASSERT_TRUE(predictor.first_q15 >= 0 && predictor.first_q15 <= 4096);
            TEST_ASSERT_TRUE(predictor.second_q15 >= 0 && predictor.second_q15 <= 4096);
            TEST_ASSERT_TRUE(predictor.weight_q15 >= 0 && predictor.weight_q15 <= 17040);
            TEST_ASSERT_TRUE(predictor.target_first_q15 >= 25000 &&
                             predictor.target_first_q15 <= 27525);
            TEST_ASSERT_TRUE(predictor.target_second_q15 >= 0 &&
                             predictor.target_second_q15 <= 11141);
            TEST_ASSERT_TRUE(predictor.lag_q16 >= 4096 && predictor.lag_q16 <= 25788);
        }
    }
}

void test_predicted_current_is_zero_after_a_reset(void)
{
    start();
    reference_prefilter_t fresh = prefilter;
    current_predictor_t fresh_predictor = predictor;
    const dq_t reference = {.d = -3000, .q = 7000};
    (void)apply(reference);
    (void)current_predictor_step(&predictor);
    reference_prefilter_reset(&prefilter);
    current_predictor_reset(&predictor);
    for (int n = 0; n < 3; n++) {
        const dq_t expected = dq_of(current_predictor_step(&predictor));
        TEST_ASSERT_EQUAL_INT32(0, expected.d);
        TEST_ASSERT_EQUAL_INT32(0, expected.q);
    }
    const dq_t again = apply(reference).reference_pu;
    const dq_t first = shape(&fresh, &fresh_predictor, reference, reference).reference_pu;
    TEST_ASSERT_EQUAL_MEMORY(&first, &again, sizeof(again));
    TEST_ASSERT_EQUAL_INT32(dq_of(current_predictor_step(&fresh_predictor)).q,
                            dq_of(current_predictor_step(&predictor)).q);
}

void test_the_predicted_current_stays_in_the_unit_circle_for_references_inside_it(void)
{
    for (int k = 0; k < BANDWIDTHS; k++) {
        config.current_loop.bandwidth_Hz = BANDWIDTHS_Hz[k];
        start();
        random_t random = random_seeded(2013);
        dq_t reference = {.d = 0, .q = 0};
        for (int n = 0; n < 20000; n++) {
            if (random_chance(&random, 0.75)) { /* opposite ends of the circle, or anywhere on it */
                const double angle = n % 3 == 0 ? n * PI : random_real(&random, 0.0, 6.3);
                reference.d = (int32_t)(32767.0 * cos(angle));
                reference.q = (int32_t)(32767.0 * sin(angle));
            }
            (void)apply(reference);
            const dq_t expected = dq_of(current_predictor_step(&predictor));
            TEST_ASSERT_TRUE(hypot(expected.d, expected.q) <= 32768.0 + 24.0);
        }
    }
}

/* At the end of the d axis a changed sampling correction would move it further than a packed pair
 * can hold: on the Cortex-M4 its sign would turn round. */
void test_the_predicted_current_stays_within_16_bits_when_the_correction_changes(void)
{
    config.current_loop.bandwidth_Hz = BANDWIDTHS_Hz[BANDWIDTHS - 1];
    start();
    random_t random = random_seeded(1992);
    dq_t reference = {.d = 0, .q = 0};
    dq_t mean = reference;
    int32_t lowest = 0;
    for (int n = 0; n < 200000; n++) {
        if (random_chance(&random, 0.4)) {
            const double correction = random_real(&random, 0.0, SETPOINT_SAMPLING_CORRECTION_PU);
            reference.d = random_chance(&random, 0.7) ? -32735 : (int32_t)(-correction * 163.0);
            mean.d = q_saturate16(reference.d - (int32_t)correction);
        }
        (void)shape(&prefilter, &predictor, reference, mean);
        const dq_t expected = dq_of(current_predictor_step(&predictor));
        TEST_ASSERT_TRUE(expected.d >= INT16_MIN && expected.d <= INT16_MAX);
        lowest = expected.d < lowest ? expected.d : lowest;
    }
    TEST_ASSERT_TRUE(lowest < -32700); /* the end was reached */
}

static int32_t nearest_q15(double x_q24)
{
    return (int32_t)floor((x_q24 + 256.0) / 512.0);
}

/* DERIVATIONS.md, Current predictor: a = b^2, m = 1 - a (1 + a)/2, the shares of the first two
 * periods; in whole steps of Q24, rounded down. */
void test_shares_are_exact_to_the_last_unit(void)
{
    const double one = 16777216.0;
    for (int32_t bandwidth_Hz = 10; bandwidth_Hz <= 1600; bandwidth_Hz++) {
        config.current_loop.bandwidth_Hz = bandwidth_Hz;
        start();
        const double b = (double)design_half_period_q24(&config);
        const double a = floor(b * b / one);
        const double second = one - floor(b * (one + a) / (2.0 * one));
        const double weight = one - floor(a * (one + a) / (2.0 * one));
        TEST_ASSERT_EQUAL_INT32(2 * (int32_t)fmax(nearest_q15(one - a), 2048.0), predictor.lag_q16);
        TEST_ASSERT_EQUAL_INT32(nearest_q15(floor((one - b) / 2.0)), predictor.first_q15);
        TEST_ASSERT_EQUAL_INT32(nearest_q15(floor((b - a) / 2.0)), predictor.second_q15);
        TEST_ASSERT_EQUAL_INT32(nearest_q15(weight), predictor.weight_q15);
        TEST_ASSERT_EQUAL_INT32(nearest_q15(one - floor((one - b) * (one / 2.0) / weight)),
                                predictor.target_first_q15);
        TEST_ASSERT_EQUAL_INT32(nearest_q15(one - floor(second * one / weight)),
                                predictor.target_second_q15);
    }
}

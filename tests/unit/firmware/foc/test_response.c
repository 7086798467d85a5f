/* SPDX-License-Identifier: Apache-2.0 */
/* The shape of the reference and the current that is expected, against the design they are made
 * from. */
#include "foc/response.h"

#include <math.h>

#include "random_values.h"
#include "unity.h"

extern const config_t CONFIG_LU2013;
static config_t config;
static response_t response;
static response_expected_t expecting;

static const double PI = 3.14159265358979323846;
static const int32_t BANDWIDTHS_Hz[] = {60, 250, 500, 1000, 1590}; /* at 20 kHz */

enum { BANDWIDTHS = sizeof(BANDWIDTHS_Hz) / sizeof(BANDWIDTHS_Hz[0]), FREQUENCY_Hz = 20000 };

void setUp(void)
{
    config = CONFIG_LU2013;
    config.drive.pwm_frequency_Hz = FREQUENCY_Hz;
}

void tearDown(void) {}

static void start(void)
{
    response_init(&response, &expecting, &config);
}

/* exp(-w T/2) */
static double half_period(int32_t bandwidth_Hz)
{
    return exp(-PI * bandwidth_Hz / FREQUENCY_Hz);
}

/* Share of a change that has come n samples after the one that met it first, n not necessarily
 * whole. */
static double designed(double b, double n)
{
    return n > 1.5 ? 1.0 - pow(b, 2.0 * (n - 1.5)) : 0.0;
}

void test_the_designed_loop_answers_a_shaped_change_as_designed_at_every_sample(void)
{
    /* i[n+2] = i[n+1] + K (r[n] - i[n]): what gains and delay make of winding and regulator. */
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
            const dq_t given =
                response_follow(&response, reference, &expecting, reference).reference_pu;
            const double after_d = next_d + gain * (given.d - now_d);
            const double after_q = next_q + gain * (given.q - now_q);
            now_d = next_d;
            now_q = next_q;
            next_d = after_d;
            next_q = after_q;
        }
    }
}

void test_without_its_shape_the_loop_is_a_twentieth_ahead_at_the_first_sample(void)
{
    const double b = half_period(1000);
    TEST_ASSERT_TRUE(b * b * (1.0 - b * b) - designed(b, 2) > 0.05);
}

void test_every_sequence_of_references_is_answered_as_the_sum_of_its_changes(void)
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
        const double after =
            next +
            gain * (response_follow(&response, target, &expecting, target).reference_pu.q - now);
        now = next;
        next = after;
    }
}

void test_it_settles_in_the_third_period_after_a_change_and_not_before(void)
{
    start();
    const dq_t reference = {.d = 100, .q = -7000};
    for (int n = 0; n < 6; n++) {
        const dq_t given =
            response_follow(&response, reference, &expecting, reference).reference_pu;
        TEST_ASSERT_EQUAL_INT(n >= 2, response.settled);
        if (n >= 2) {
            TEST_ASSERT_EQUAL_MEMORY(&reference, &given, sizeof(given));
        } else {
            TEST_ASSERT_TRUE(n == 0 ? given.q > reference.q : given.q < reference.q);
        }
    }
}

void test_the_current_is_expected_in_the_middle_of_each_period_between_the_designed_samples(void)
{
    for (int k = 1; k < BANDWIDTHS;
         k++) { /* the first is slower than rounding lets it be expected */
        config.current_loop.bandwidth_Hz = BANDWIDTHS_Hz[k];
        start();
        const double b = half_period(BANDWIDTHS_Hz[k]);
        const dq_t before = {.d = -3000, .q = 7000};
        const dq_t after = {.d = 1000, .q = -9000};
        for (int n = 0; n < 400; n++) {
            (void)response_follow(&response, before, &expecting, before);
            (void)response_expect(&expecting);
        }
        for (int n = 0; n < 100; n++) {
            if (!response.settled || n == 0) {
                (void)response_follow(&response, after, &expecting, after);
            }
            const dq_t expected = response_expect(&expecting);
            const double come = 0.5 * (designed(b, n + 1) + designed(b, n + 2));
            /* What rounding leaves undone: below 1/lag, 16 LSB, of each change. */
            TEST_ASSERT_DOUBLE_WITHIN(32.0, before.d + come * (after.d - before.d), expected.d);
            TEST_ASSERT_DOUBLE_WITHIN(32.0, before.q + come * (after.q - before.q), expected.q);
        }
    }
}

void test_a_sampled_current_is_brought_forward_to_the_middle_of_the_period_its_voltage_acts_in(void)
{
    for (int k = 0; k < BANDWIDTHS; k++) {
        config.current_loop.bandwidth_Hz = BANDWIDTHS_Hz[k];
        start();
        const double b = half_period(BANDWIDTHS_Hz[k]);
        const double nearer = response.nearer_q15 / 32768.0;
        const dq_t reference = {.d = -9000, .q = 20000};
        for (int n = 0; n < 30; n++) {
            const dq_t aim = response_follow(&response, reference, &expecting, reference).aim_pu;
            const double then = 0.5 * (designed(b, n + 1) + designed(b, n + 2));
            TEST_ASSERT_DOUBLE_WITHIN(3.0, reference.d * then,
                                      nearer * aim.d +
                                          (1.0 - nearer) * reference.d * designed(b, n));
            TEST_ASSERT_DOUBLE_WITHIN(3.0, reference.q * then,
                                      nearer * aim.q +
                                          (1.0 - nearer) * reference.q * designed(b, n));
        }
    }
}

void test_another_current_may_be_expected_than_the_reference(void)
{
    start();
    const dq_t reference = {.d = 0, .q = 3000};
    const dq_t expected = {.d = -25, .q = 3000};
    for (int n = 0; n < 200; n++) {
        const response_given_t given = response_follow(&response, reference, &expecting, expected);
        const dq_t now = response_expect(&expecting);
        TEST_ASSERT_EQUAL_INT32(-25, now.d); /* it is there from the start */
        TEST_ASSERT_EQUAL_INT32(0, given.reference_pu.d);
    }
    TEST_ASSERT_INT_WITHIN(4, 3000, response_expect(&expecting).q);
}

void test_a_slow_loop_is_expected_to_lag_by_a_sixteenth_and_too_fast_a_one_counts_as_the_fastest(
    void)
{
    config.current_loop.bandwidth_Hz = 10;
    start();
    TEST_ASSERT_EQUAL_INT32(32768 / 16, expecting.lag_q15);
    config.current_loop.bandwidth_Hz = 1592;
    start();
    const response_t fastest = response;
    const int32_t fastest_lag_q15 = expecting.lag_q15;
    TEST_ASSERT_DOUBLE_WITHIN(1.0, 32768.0 * (1.0 - exp(-0.5)), fastest_lag_q15);
    config.current_loop.bandwidth_Hz = 10000;
    config.drive.pwm_frequency_Hz = 4000;
    start();
    TEST_ASSERT_EQUAL_INT32(fastest_lag_q15, expecting.lag_q15);
    TEST_ASSERT_EQUAL_INT32(fastest.held_q15, response.held_q15);
    TEST_ASSERT_EQUAL_INT32(fastest.exceeded_q15, response.exceeded_q15);
}

void test_every_share_is_in_the_range_that_the_proofs_assume(void)
{
    static const int32_t FREQUENCIES_Hz[] = {4000, 20000, 100000};
    for (int k = 0; k < 3; k++) {
        config.drive.pwm_frequency_Hz = FREQUENCIES_Hz[k];
        for (int32_t bandwidth_Hz = 10; bandwidth_Hz <= 10000; bandwidth_Hz++) {
            config.current_loop.bandwidth_Hz = bandwidth_Hz;
            start();
            TEST_ASSERT_TRUE(response.held_q15 >= 0 && response.held_q15 <= 16384);
            TEST_ASSERT_TRUE(response.exceeded_q15 >= 0 && response.exceeded_q15 <= 9400);
            TEST_ASSERT_TRUE(response.begun_q15 >= 0 && response.begun_q15 <= 4096);
            TEST_ASSERT_TRUE(response.begun_next_q15 >= 0 && response.begun_next_q15 <= 4096);
            TEST_ASSERT_TRUE(response.nearer_q15 >= 0 && response.nearer_q15 <= 17040);
            TEST_ASSERT_TRUE(response.short_q15 >= 0 && response.short_q15 <= 27525);
            TEST_ASSERT_TRUE(response.short_next_q15 >= 0 && response.short_next_q15 <= 11141);
            TEST_ASSERT_TRUE(expecting.lag_q15 >= 2048 && expecting.lag_q15 <= 32767);
        }
    }
}

void test_after_a_rest_nothing_is_expected_and_nothing_is_remembered(void)
{
    start();
    response_t fresh = response;
    response_expected_t fresh_expecting = expecting;
    const dq_t reference = {.d = -3000, .q = 7000};
    (void)response_follow(&response, reference, &expecting, reference);
    (void)response_expect(&expecting);
    response_rest(&response, &expecting);
    for (int n = 0; n < 3; n++) {
        const dq_t expected = response_expect(&expecting);
        TEST_ASSERT_EQUAL_INT32(0, expected.d);
        TEST_ASSERT_EQUAL_INT32(0, expected.q);
    }
    const dq_t again = response_follow(&response, reference, &expecting, reference).reference_pu;
    const dq_t first = response_follow(&fresh, reference, &fresh_expecting, reference).reference_pu;
    TEST_ASSERT_EQUAL_MEMORY(&first, &again, sizeof(again));
    TEST_ASSERT_EQUAL_INT32(response_expect(&fresh_expecting).q, response_expect(&expecting).q);
}

void test_the_expected_current_stays_in_the_unit_circle_whatever_the_references_inside_it_do(void)
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
            (void)response_follow(&response, reference, &expecting, reference);
            const dq_t expected = response_expect(&expecting);
            TEST_ASSERT_TRUE(hypot(expected.d, expected.q) <= 32768.0 + 24.0);
        }
    }
}

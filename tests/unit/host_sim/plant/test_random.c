/* SPDX-License-Identifier: Apache-2.0 */
/* Repeatable noise: moments of the distributions, independence of streams, equality for equal
 * seeds. */
#include "plant/random.h"

#include <math.h>

#include "unity.h"

enum { SAMPLES = 200000 };

void setUp(void) {}

void tearDown(void) {}

void test_uniform_numbers_fill_their_interval_evenly(void)
{
    random_t random = random_init(42, 0);
    int tenth[10] = {0};
    for (int k = 0; k < SAMPLES; k++) {
        const double x = random_uniform(&random);
        TEST_ASSERT_TRUE(x >= 0.0 && x < 1.0);
        tenth[(int)(x * 10.0)]++;
    }
    for (int k = 0; k < 10; k++) {
        TEST_ASSERT_INT_WITHIN(700, SAMPLES / 10,
                               tenth[k]); /* five standard deviations of the count */
    }
}

void test_gaussian_numbers_have_the_moments_of_the_normal_distribution(void)
{
    random_t random = random_init(7, 3);
    double sum = 0.0;
    double square = 0.0;
    double fourth = 0.0;
    for (int k = 0; k < SAMPLES; k++) {
        const double x = random_gaussian(&random);
        sum += x;
        square += x * x;
        fourth += x * x * x * x;
    }
    TEST_ASSERT_DOUBLE_WITHIN(5.0 / sqrt(SAMPLES), 0.0, sum / SAMPLES);
    TEST_ASSERT_DOUBLE_WITHIN(5.0 * sqrt(2.0 / SAMPLES), 1.0, square / SAMPLES);
    TEST_ASSERT_DOUBLE_WITHIN(5.0 * sqrt(96.0 / SAMPLES), 3.0, fourth / SAMPLES);
}

void test_streams_of_one_seed_are_uncorrelated(void)
{
    random_t a = random_init(1, 0);
    random_t b = random_init(1, 1);
    double product = 0.0;
    for (int k = 0; k < SAMPLES; k++) {
        product += random_gaussian(&a) * random_gaussian(&b);
    }
    TEST_ASSERT_DOUBLE_WITHIN(5.0 / sqrt(SAMPLES), 0.0, product / SAMPLES);
}

void test_the_same_seed_and_stream_give_the_same_numbers(void)
{
    random_t a = random_init(99, 2);
    random_t b = random_init(99, 2);
    random_t other = random_init(100, 2);
    int different = 0;
    for (int k = 0; k < 100; k++) {
        const double x = random_gaussian(&a);
        TEST_ASSERT_EQUAL_DOUBLE(x, random_gaussian(&b));
        different += x != random_gaussian(&other) ? 1 : 0;
    }
    TEST_ASSERT_EQUAL_INT(100, different);
}

/* SPDX-License-Identifier: Apache-2.0 */
/* The limits of the numbers of the voltage ellipse: on both sides of each, to the unit. */
#include "feasible_ellipse.h"
#include "unity.h"

#define MOST INT64_C(0x20000000) /* 2^29: its square and twice that stay below 2^62 */

void setUp(void) {}

void tearDown(void) {}

static int32_t limited(int64_t x)
{
    return (int32_t)(x < -MOST ? -MOST : x > MOST ? MOST : x);
}

void test_a_coefficient_is_its_number_up_to_the_limit_and_the_limit_beyond(void)
{
    static const int64_t NUMBERS[] = {0,        1,    MOST - 1,     MOST,           MOST + 1,
                                      2 * MOST, 1000, 4 * MOST + 7, MOST * MOST + 5};
    for (unsigned k = 0; k < sizeof NUMBERS / sizeof NUMBERS[0]; k++) {
        TEST_ASSERT_EQUAL_INT32(limited(NUMBERS[k]), coefficient(NUMBERS[k]));
        TEST_ASSERT_EQUAL_INT32(limited(-NUMBERS[k]), coefficient(-NUMBERS[k]));
    }
}

void test_a_sum_of_coefficients_is_one(void)
{
    for (int32_t rest = -2; rest <= 2; rest++) {
        const int64_t sum = 2 * (MOST / 2) + rest;
        TEST_ASSERT_EQUAL_INT32(limited(sum), coefficient_sum(MOST / 2, (int32_t)MOST / 2 + rest));
        TEST_ASSERT_EQUAL_INT32(limited(-sum),
                                coefficient_sum(-MOST / 2, -(int32_t)MOST / 2 - rest));
    }
    TEST_ASSERT_EQUAL_INT32(MOST, coefficient_sum(INT32_MAX, INT32_MAX));
    TEST_ASSERT_EQUAL_INT32(-MOST, coefficient_sum(INT32_MIN, INT32_MIN));
}

/* A sum of products has 24 fraction bits more, which are rounded down. */
void test_a_coefficient_of_products_is_that_of_their_whole_part(void)
{
    for (int64_t upper = MOST / 256 - 3; upper < MOST / 256 + 3; upper++) {
        for (int64_t lower = 0; lower < 512; lower++) {
            const int64_t x = (upper * 256 + lower - 256) * (INT64_C(1) << 24) + lower;
            TEST_ASSERT_EQUAL_INT32(limited(upper * 256 + lower - 256), coefficient_of_products(x));
            /* rounded down */
            const int64_t whole = -(upper * 256 + lower - 256) - (lower > 0 ? 1 : 0);
            TEST_ASSERT_EQUAL_INT32(limited(whole), coefficient_of_products(-x));
        }
    }
    TEST_ASSERT_EQUAL_INT32(MOST, coefficient_of_products(INT64_MAX));
    TEST_ASSERT_EQUAL_INT32(-MOST, coefficient_of_products(INT64_MIN));
}

/* Factors of 24 fraction bits: the product has them, rounded down, and saturates as 32 bits. */
void test_a_product_of_wide_factors_saturates(void)
{
    TEST_ASSERT_EQUAL_INT32(6 << 24, multiply64_b(2 << 24, 3 << 24));
    TEST_ASSERT_EQUAL_INT32(-1, multiply64_b(-1, 1));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, multiply64_b(INT64_C(1) << 31, 1 << 24));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, multiply64_b(INT64_C(1) << 40, 1 << 20));
    TEST_ASSERT_EQUAL_INT32(INT32_MIN, multiply64_b(-(INT64_C(1) << 40), 1 << 20));
}

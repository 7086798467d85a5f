/* SPDX-License-Identifier: Apache-2.0 */
#include "core/scaled.h"

#include <math.h>

#include "random_values.h"
#include "unity.h"

enum { ROUNDS = 200000 };

void setUp(void) {}

void tearDown(void) {}

static int64_t any_size(random_t *random, int bits)
{
    return (int64_t)(random_u64(random) >> (64 - random_between(random, 1, bits)));
}

void test_root_is_within_the_documented_error(void)
{
    random_t random = random_seeded(1);
    for (int n = 0; n < ROUNDS; n++) {
        const int64_t x = any_size(&random, 62);
        const double root = sqrt((double)x);
        TEST_ASSERT_DOUBLE_WITHIN(1.01 + root / 16384.0, root, scaled_root(x));
    }
    TEST_ASSERT_EQUAL_INT32(0, scaled_root(0));
    TEST_ASSERT_EQUAL_INT32(0, scaled_root(-5));
    TEST_ASSERT_INT32_WITHIN(1, 1, scaled_root(1));
}

void test_leading_zeros_are_those_of_every_power_of_two_and_of_what_lies_below_it(void)
{
    for (uint32_t digit = 0; digit < 32; digit++) {
        TEST_ASSERT_EQUAL_UINT32(31U - digit, scaled_leading_zeros(UINT32_C(1) << digit));
        TEST_ASSERT_EQUAL_UINT32(31U - digit,
                                 scaled_leading_zeros((UINT32_C(2) << digit) - UINT32_C(1)));
    }
}

void test_ratio_is_within_the_documented_error_or_saturates(void)
{
    random_t random = random_seeded(2);
    for (int n = 0; n < ROUNDS; n++) {
        const int32_t d =
            (int32_t)any_size(&random, 31) + 1 > 0 ? (int32_t)any_size(&random, 30) + 1 : 1;
        const int32_t sign = random_chance(&random, 0.5) ? 1 : -1;
        const int32_t x = sign * (int32_t)any_size(&random, 31);
        const double ratio = (double)x * SCALED_ONE / d;
        const int32_t found = scaled_ratio(x, d);
        if (fabs(ratio) < 1 << 29) {
            TEST_ASSERT_DOUBLE_WITHIN(0.5 + fabs(ratio) / (1 << 27), ratio, found);
        } else {
            TEST_ASSERT_TRUE(found * sign >= 1 << 29 && found * sign <= 1 << 30);
        }
    }
}

void test_ratio_of_the_ends_of_the_range(void)
{
    TEST_ASSERT_EQUAL_INT32(0, scaled_ratio(0, 1));
    TEST_ASSERT_EQUAL_INT32(SCALED_ONE, scaled_ratio(1, 1));
    TEST_ASSERT_EQUAL_INT32(-SCALED_ONE, scaled_ratio(-INT32_MAX, INT32_MAX));
    TEST_ASSERT_EQUAL_INT32(-SCALED_ONE / 2, scaled_ratio(-(1 << 29), 1 << 30));
    TEST_ASSERT_EQUAL_INT32(-(1 << 30), scaled_ratio(INT32_MIN, 1));
    TEST_ASSERT_EQUAL_INT32(0, scaled_ratio(1, INT32_MAX));
}

void test_products_and_shifts_round_down_and_saturate(void)
{
    TEST_ASSERT_EQUAL_INT32(3, scaled_multiply(3, SCALED_ONE));
    TEST_ASSERT_EQUAL_INT32(-2, scaled_multiply(-3, SCALED_ONE / 2));
    TEST_ASSERT_EQUAL_INT32(12, scaled_shift(3, 2));
    TEST_ASSERT_EQUAL_INT32(-2, scaled_shift(-7, -2));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, scaled_shift(1 << 20, 15));
    TEST_ASSERT_EQUAL_INT32(INT32_MIN, scaled_shift(-(1 << 20) - 1, 11));
    TEST_ASSERT_EQUAL_INT32(INT32_MIN, scaled_shift(-(1 << 20), 11));
    TEST_ASSERT_EQUAL_INT32(-1, scaled_shift(INT32_MIN, -62));
}

/* Two products of halves make a whole; a sum is rounded down once. */
void test_a_sum_of_two_products_is_rounded_once(void)
{
    TEST_ASSERT_EQUAL_INT32(4, scaled_dot(3, SCALED_ONE / 2, 5, SCALED_ONE / 2));
    TEST_ASSERT_EQUAL_INT32(-1, scaled_dot(3, SCALED_ONE / 2, -4, SCALED_ONE / 2));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX,
                            scaled_dot(INT32_MAX, SCALED_ONE * 2, INT32_MIN + 1, SCALED_ONE));
}

void test_a_constant_is_the_nearest_number_in_its_scale(void)
{
    random_t random = random_seeded(3);
    for (int n = 0; n < ROUNDS; n++) {
        const int64_t value = any_size(&random, 50);
        const int64_t divisor = any_size(&random, 58) + 1;
        const int32_t shift = random_between(&random, -60, 70);
        const double exact = ldexp((double)value / (double)divisor, shift);
        const int32_t found = scaled_constant(value, divisor, shift);
        if (exact < (1 << 30) - 1.0) {
            TEST_ASSERT_DOUBLE_WITHIN(1.0 + 1e-9 * exact, exact, found);
        } else {
            TEST_ASSERT_TRUE(found >= (1 << 30) - 1);
        }
    }
    TEST_ASSERT_EQUAL_INT32(0, scaled_constant(0, 1, 30));
}

/* SPDX-License-Identifier: Apache-2.0 */
/* 1/n by table: every n. */
#include <math.h>

#include "core/reciprocal.h"
#include "unity.h"

void setUp(void) {}

void tearDown(void) {}

/* Over a step h = 1/64 the chord of 1/x lies at most h^2/8 * 2/x^3 above it, 6.1e-5 of 1/x at x
 * = 1. The table entries and the interpolation are each rounded to 2^-15, half of which is 1.5e-5;
 * the first entry is exact. */
static const double LARGEST_ERROR = 8e-5;

static double value_of(reciprocal_t r)
{
    return ldexp((double)r.mantissa, (int)r.shift - 30);
}

void test_the_relative_error_is_below_the_documented_one_for_every_n(void)
{
    for (uint32_t n = 1; n <= 65535U; n++) {
        const double error = value_of(reciprocal_of((uint16_t)n)) * n - 1.0;
        TEST_ASSERT_TRUE_MESSAGE(fabs(error) < LARGEST_ERROR, "relative error");
    }
}

void test_the_mantissa_is_normalised_for_every_n(void)
{
    for (uint32_t n = 1; n <= 65535U; n++) {
        const reciprocal_t r = reciprocal_of((uint16_t)n);
        TEST_ASSERT_TRUE(r.mantissa >= 16384U && r.mantissa <= 32768U);
        TEST_ASSERT_TRUE(r.shift <= 15U);
    }
}

void test_powers_of_two_are_exact(void)
{
    for (unsigned bit = 0; bit < 16; bit++) {
        const reciprocal_t r = reciprocal_of((uint16_t)(1U << bit));
        TEST_ASSERT_TRUE(value_of(r) * (double)(1U << bit) ==
                         1.0); /* both sides are exact in binary */
    }
}

/* Table points, n = 2^15 + 512 k, are where the interpolation weighs only one entry: the entry
 * itself must be the nearest. */
void test_the_table_holds_the_correctly_rounded_reciprocal(void)
{
    for (uint32_t k = 0; k < 64U; k++) {
        const uint32_t n = 32768U + 512U * k;
        TEST_ASSERT_EQUAL_UINT16(lround(1073741824.0 / n), reciprocal_of((uint16_t)n).mantissa);
    }
}

void test_a_larger_n_never_has_a_larger_reciprocal(void)
{
    for (uint32_t n = 1; n < 65535U; n++) {
        TEST_ASSERT_TRUE(value_of(reciprocal_of((uint16_t)(n + 1U))) <=
                         value_of(reciprocal_of((uint16_t)n)));
    }
}

void test_zero_counts_as_one(void)
{
    TEST_ASSERT_TRUE(value_of(reciprocal_of(0)) == 1.0);
    TEST_ASSERT_EQUAL_UINT32(4711U, reciprocal_scale(4711U, 0));
}

void test_scaling_agrees_with_division_for_every_n(void)
{
    static const uint32_t NUMERATORS[] = {0U,       1U,          65535U,     65536U,
                                          1000003U, 0x80000000U, 0xFFFFFFFFU};
    for (unsigned i = 0; i < sizeof(NUMERATORS) / sizeof(NUMERATORS[0]); i++) {
        for (uint32_t n = 1; n <= 65535U; n++) {
            const double exact = (double)NUMERATORS[i] / n;
            TEST_ASSERT_DOUBLE_WITHIN(exact * LARGEST_ERROR + 1.0, exact,
                                      reciprocal_scale(NUMERATORS[i], (uint16_t)n));
        }
    }
}

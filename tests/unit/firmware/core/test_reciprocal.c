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

/* The reciprocal itself, exactly: it has at most 31 fraction bits. */
static double reciprocal_of(uint32_t n)
{
    return ldexp(reciprocal_scale(0x80000000U, (uint16_t)n), -31);
}

void test_the_relative_error_is_below_the_documented_one_for_every_n(void)
{
    for (uint32_t n = 1; n <= 65535U; n++) {
        const double error = reciprocal_of(n) * n - 1.0;
        TEST_ASSERT_TRUE_MESSAGE(fabs(error) < LARGEST_ERROR, "relative error");
    }
}

void test_powers_of_two_are_exact(void)
{
    for (unsigned bit = 0; bit < 16; bit++) {
        TEST_ASSERT_TRUE(reciprocal_of(1U << bit) == ldexp(1.0, -(int)bit));
    }
}

/* Table points, n = 2^15 + 512 k, are where the interpolation weighs only one entry: the entry
 * itself must be the nearest. */
void test_the_table_holds_the_correctly_rounded_reciprocal(void)
{
    for (uint32_t k = 0; k < 64U; k++) {
        const uint32_t n = 32768U + 512U * k;
        TEST_ASSERT_TRUE(reciprocal_of(n) == ldexp(round(1073741824.0 / n), -30));
    }
}

void test_a_larger_n_never_has_a_larger_reciprocal(void)
{
    for (uint32_t n = 1; n < 65535U; n++) {
        TEST_ASSERT_TRUE(reciprocal_of(n + 1U) <= reciprocal_of(n));
    }
}

void test_zero_counts_as_one(void)
{
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

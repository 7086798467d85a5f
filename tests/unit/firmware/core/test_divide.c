/* SPDX-License-Identifier: Apache-2.0 */
/* Quotients by constants equal the C operator's, at multiples of the divisor, at the ends of the
 * range and at random. */
#include "core/divide.h"
#include "unity.h"

void setUp(void) {}

void tearDown(void) {}

typedef int64_t (*division_t)(int64_t);

static const struct {
    division_t division;
    int64_t n;
} CASES[] = {
    {divide_by_thousand, 1000}, {divide_by_million, 1000000}, {divide_by_billion, 1000000000}};

enum { CASE_COUNT = sizeof(CASES) / sizeof(CASES[0]) };

static void assert_is_quotient(unsigned k, int64_t x)
{
    TEST_ASSERT_EQUAL_INT64(x / CASES[k].n, CASES[k].division(x));
}

/* x / n changes at the multiples of n, where an error of the reciprocal shows first. The error
 * grows with x. */
static void assert_around(unsigned k, int64_t multiple)
{
    for (int64_t beside = -2; beside <= 2; beside++) {
        assert_is_quotient(k, multiple + beside);
        assert_is_quotient(k, -(multiple + beside));
    }
}

void test_the_quotient_changes_exactly_at_multiples_of_the_divisor(void)
{
    for (unsigned k = 0; k < CASE_COUNT; k++) {
        const int64_t most = INT64_MAX / CASES[k].n - 1;
        for (int64_t i = 0; i < 4000; i++) {
            assert_around(k, i * CASES[k].n);
            assert_around(k, (most - i) * CASES[k].n);
            assert_around(k, most / 4000 * i * CASES[k].n);
        }
    }
}

void test_quotients_at_powers_of_two_and_their_neighbours(void)
{
    for (unsigned k = 0; k < CASE_COUNT; k++) {
        for (unsigned bit = 2; bit < 63; bit++) {
            assert_around(k, INT64_C(1) << bit);
        }
    }
}

void test_quotients_at_the_ends_of_the_range(void)
{
    for (unsigned k = 0; k < CASE_COUNT; k++) {
        for (int64_t i = 0; i < 3000; i++) {
            assert_is_quotient(k, INT64_MAX - i);
            assert_is_quotient(k, INT64_MIN + i);
            assert_is_quotient(k, i - 1500);
        }
    }
}

void test_quotients_of_random_numbers_of_every_length(void)
{
    uint64_t random = 1;
    for (unsigned i = 0; i < 60000; i++) {
        random = random * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
        const int64_t x = (int64_t)(random >> (1U + (i & 63U) % 63U));
        for (unsigned k = 0; k < CASE_COUNT; k++) {
            assert_is_quotient(k, x);
            assert_is_quotient(k, -x);
        }
    }
}

/* SPDX-License-Identifier: Apache-2.0 */
#include "divide64.h"

#include "unity.h"

enum { ROUNDS = 2000000 };

void setUp(void) {}

void tearDown(void) {}

static void compare(uint64_t n, uint64_t d)
{
    uint64_t rest = 0;
    TEST_ASSERT_EQUAL_HEX64(n / d, divide64(n, d, &rest));
    TEST_ASSERT_EQUAL_HEX64(n % d, rest);
}

/* Around each power of two, and around each multiple of the divisor by one: the host's division is
 * another program. */
void test_quotient_and_rest_beside_every_pair_of_powers_of_two(void)
{
    for (unsigned i = 0; i < 64; i++) {
        for (unsigned k = 0; k < 64; k++) {
            for (uint64_t beside = 0; beside < 3; beside++) {
                const uint64_t d = (UINT64_C(1) << k) - 1U + beside;
                if (d != 0) {
                    compare((UINT64_C(1) << i) - 1U, d);
                    compare(UINT64_C(1) << i, d);
                    compare((UINT64_C(1) << i) + 1U, d);
                    compare(UINT64_MAX << i, d);
                    compare(UINT64_MAX / d * d, d);
                    compare(UINT64_MAX / d * d - 1U, d);
                }
            }
        }
    }
}

/* Of every length, by splitmix64 (Steele, Lea and Flood 2014). */
void test_quotient_and_rest_of_random_numbers_of_every_length(void)
{
    uint64_t state = 1, drawn[2];
    for (int round = 0; round < ROUNDS; round++) {
        for (int k = 0; k < 2; k++) {
            state += UINT64_C(0x9E3779B97F4A7C15);
            uint64_t z = state;
            z = (z ^ (z >> 30)) * UINT64_C(0xBF58476D1CE4E5B9);
            z = (z ^ (z >> 27)) * UINT64_C(0x94D049BB133111EB);
            z ^= z >> 31;
            drawn[k] = z >> (z & 63U);
        }
        compare(drawn[0], drawn[1] | 1U);
    }
}

void test_quotient_of_one_and_quotient_below_one(void)
{
    compare(0, 1);
    compare(UINT64_MAX, UINT64_MAX);
    compare(UINT64_MAX - 1U, UINT64_MAX);
    compare(UINT64_C(0x8000000000000001), UINT64_C(0x8000000000000000));
    compare(UINT64_C(0x10000), UINT64_C(0xFFFF));
}

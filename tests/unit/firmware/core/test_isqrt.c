/* SPDX-License-Identifier: Apache-2.0 */
/* Integer square root: the defining inequality around every square and at the ends. */
#include "core/isqrt.h"
#include "unity.h"

void setUp(void) {}

void tearDown(void) {}

/* r = floor(sqrt x) is the one integer with r^2 <= x < (r + 1)^2. */
static void assert_is_root(uint64_t x)
{
    const uint64_t r = isqrt64(x);
    TEST_ASSERT_TRUE(r * r <= x);
    TEST_ASSERT_TRUE(r == UINT32_MAX || (r + 1U) * (r + 1U) > x);
}

void test_every_argument_up_to_twenty_bits_is_exact(void)
{
    for (uint64_t x = 0; x < (UINT64_C(1) << 20); x++) {
        assert_is_root(x);
    }
}

void test_the_neighbours_of_large_squares_are_exact(void)
{
    for (uint64_t r = 1000000007; r < UINT64_C(4294967296); r += 77777777) {
        assert_is_root(r * r - 1U);
        assert_is_root(r * r);
        assert_is_root(r * r + 1U);
    }
}

void test_the_largest_argument_has_the_largest_root(void)
{
    TEST_ASSERT_EQUAL_UINT32(UINT32_MAX, isqrt64(UINT64_MAX));
    TEST_ASSERT_EQUAL_UINT32(UINT32_MAX, isqrt64(UINT64_C(0xFFFFFFFE00000001))); /* (2^32 - 1)^2 */
    TEST_ASSERT_EQUAL_UINT32(UINT32_MAX - 1U, isqrt64(UINT64_C(0xFFFFFFFE00000000)));
    TEST_ASSERT_EQUAL_UINT32(0x80000000U, isqrt64(UINT64_C(1) << 62));
}

/* SPDX-License-Identifier: Apache-2.0 */
#include "modulation_index.h"

#include "unity.h"

void setUp(void) {}

void tearDown(void) {}

static int32_t square_q15(int32_t d, int32_t q)
{
    const dq_t unsaturated = {.d = d, .q = q};
    return modulation_index_square_q15(unsaturated);
}

void test_the_square_is_that_of_the_vector_limited_to_the_circle(void)
{
    for (int32_t d = -32768; d <= 32767; d += 331) {
        for (int32_t q = -32768; q <= 32767; q += 337) {
            const double exact = ((double)d * d + (double)q * q) / 32768.0;
            TEST_ASSERT_DOUBLE_WITHIN(0.5, exact - 0.5, square_q15(d, q));
        }
    }
}

void test_a_component_beyond_the_circle_counts_as_one(void)
{
    TEST_ASSERT_EQUAL_INT32(square_q15(0, 32767), square_q15(0, 1000000));
    TEST_ASSERT_EQUAL_INT32(square_q15(32767, 5), square_q15(1000000, 5));
    TEST_ASSERT_EQUAL_INT32(65536, square_q15(INT32_MIN, INT32_MIN));
}

/* SPDX-License-Identifier: Apache-2.0 */
#include "modulation_index.h"

#include "unity.h"

void setUp(void) {}

void tearDown(void) {}

void test_the_square_is_that_of_the_vector_limited_to_the_circle(void)
{
    for (int32_t d = -32768; d <= 32767; d += 331) {
        for (int32_t q = -32768; q <= 32767; q += 337) {
            const double exact = ((double)d * d + (double)q * q) / 32768.0;
            TEST_ASSERT_DOUBLE_WITHIN(0.5, exact - 0.5, modulation_index_square_q15(d, q));
        }
    }
}

void test_a_q_voltage_beyond_the_circle_counts_as_one(void)
{
    TEST_ASSERT_EQUAL_INT32(modulation_index_square_q15(0, 32767),
                            modulation_index_square_q15(0, 1000000));
    TEST_ASSERT_EQUAL_INT32(65536, modulation_index_square_q15(-32768, INT32_MIN));
}

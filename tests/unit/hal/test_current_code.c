/* SPDX-License-Identifier: Apache-2.0 */
#include "current_code.h"
#include "unity.h"

enum { ZERO = 2048, LARGEST = 4095 };

void setUp(void) {}

void tearDown(void) {}

/* About the middle: a code and the one of the other sign have the same distance from it. */
void test_an_inverting_amplifier_shows_the_same_current_with_the_other_sign(void)
{
    for (uint32_t raw = 0; raw <= LARGEST; raw++) {
        const int32_t rising = (int32_t)current_code(raw, false) - ZERO;
        const int32_t falling = (int32_t)current_code(raw, true) - ZERO;
        TEST_ASSERT_EQUAL_INT32((int32_t)raw - ZERO, rising);
        TEST_ASSERT_EQUAL_INT32(-1, rising + falling);
    }
}

void test_a_zero_beside_the_middle_becomes_the_middle(void)
{
    for (uint32_t zero = 1800; zero <= 2600; zero += 25) {
        for (uint32_t raw = 1; raw < LARGEST; raw++) {
            const int32_t beside = (int32_t)raw - (int32_t)zero;
            const int32_t rising = (int32_t)current_code_about(raw, zero, false) - ZERO;
            const int32_t falling = (int32_t)current_code_about(raw, zero, true) - ZERO;
            TEST_ASSERT_EQUAL_INT32(beside < -ZERO   ? -ZERO
                                    : beside >= ZERO ? ZERO - 1
                                                     : beside,
                                    rising);
            TEST_ASSERT_EQUAL_INT32(beside <= -ZERO ? ZERO - 1
                                    : beside > ZERO ? -ZERO
                                                    : -beside,
                                    falling);
        }
    }
}

/* Whatever lies between the zero and that end: else a clipped current would look like a small one.
 */
void test_an_end_of_the_converters_range_is_an_end_of_the_codes(void)
{
    for (uint32_t zero = 1800; zero <= 2600; zero += 25) {
        TEST_ASSERT_EQUAL_UINT16(0, current_code_about(0, zero, false));
        TEST_ASSERT_EQUAL_UINT16(LARGEST, current_code_about(LARGEST, zero, false));
        TEST_ASSERT_EQUAL_UINT16(LARGEST, current_code_about(0, zero, true));
        TEST_ASSERT_EQUAL_UINT16(0, current_code_about(LARGEST, zero, true));
    }
}

void test_three_currents_have_no_sum_as_long_as_all_can_be_shown(void)
{
    for (uint32_t a = 0; a <= LARGEST; a += 15) {
        for (uint32_t b = 0; b <= LARGEST; b += 15) {
            const int32_t sum = (int32_t)a + (int32_t)b - 2 * ZERO;
            const int32_t third = (int32_t)current_code_third(a, b) - ZERO;
            if (sum > ZERO) {
                TEST_ASSERT_EQUAL_INT32(-ZERO, third);
            } else if (sum < ZERO - LARGEST) {
                TEST_ASSERT_EQUAL_INT32(LARGEST - ZERO, third);
            } else {
                TEST_ASSERT_EQUAL_INT32(0, third + sum);
            }
        }
    }
}

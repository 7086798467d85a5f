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

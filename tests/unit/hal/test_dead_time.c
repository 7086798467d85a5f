/* SPDX-License-Identifier: Apache-2.0 */
#include "dead_time.h"
#include "unity.h"

enum { CLOCK_Hz = 168000000 };

void setUp(void) {}

void tearDown(void) {}

void test_code_equals_the_reference_manual_at_the_ends_of_its_four_ranges(void)
{
    TEST_ASSERT_EQUAL_UINT32(0, dead_time_clocks(0x00));
    TEST_ASSERT_EQUAL_UINT32(127, dead_time_clocks(0x7F));
    TEST_ASSERT_EQUAL_UINT32(64 * 2, dead_time_clocks(0x80));
    TEST_ASSERT_EQUAL_UINT32(127 * 2, dead_time_clocks(0xBF));
    TEST_ASSERT_EQUAL_UINT32(32 * 8, dead_time_clocks(0xC0));
    TEST_ASSERT_EQUAL_UINT32(63 * 8, dead_time_clocks(0xDF));
    TEST_ASSERT_EQUAL_UINT32(32 * 16, dead_time_clocks(0xE0));
    TEST_ASSERT_EQUAL_UINT32(63 * 16, dead_time_clocks(0xFF));
}

/* By brute force over all 256 codes: nothing shorter would do. */
void test_dead_time_is_the_shortest_one_not_below_the_setting(void)
{
    for (uint32_t ns = 0; ns <= 6000; ns++) {
        const uint64_t asked_ps = (uint64_t)ns * 1000;
        uint8_t code = 0;
        TEST_ASSERT_TRUE(dead_time_encode(ns, CLOCK_Hz, &code));
        const uint64_t made = dead_time_clocks(code);
        TEST_ASSERT_TRUE(made * 1000000000000U >= asked_ps * CLOCK_Hz);
        for (uint32_t other = 0; other < 256; other++) {
            const uint64_t clocks = dead_time_clocks((uint8_t)other);
            if (clocks < made) {
                TEST_ASSERT_TRUE(clocks * 1000000000000U < asked_ps * CLOCK_Hz);
            }
        }
    }
}

void test_dead_time_beyond_the_generator_is_refused_and_the_code_unchanged(void)
{
    uint8_t code = 0x5A;
    TEST_ASSERT_TRUE(
        dead_time_encode(6000, CLOCK_Hz, &code)); /* 1008 clocks: the longest there is */
    TEST_ASSERT_EQUAL_UINT32(DEAD_TIME_MAX_CLOCKS, dead_time_clocks(code));
    code = 0x5A;
    TEST_ASSERT_FALSE(dead_time_encode(6001, CLOCK_Hz, &code));
    TEST_ASSERT_FALSE(dead_time_encode(4000000000U, CLOCK_Hz, &code));
    TEST_ASSERT_EQUAL_HEX8(0x5A, code);
}

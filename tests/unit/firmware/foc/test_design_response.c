/* SPDX-License-Identifier: Apache-2.0 */
#include "design_response.h"

#include <math.h>

#include "unity.h"

extern const config_t CONFIG_LU2013;

void setUp(void) {}

void tearDown(void) {}

void test_the_pole_over_half_a_period_is_exact_to_half_a_unit_of_q15(void)
{
    config_t config = CONFIG_LU2013;
    config.drive.pwm_frequency_Hz = 20000;
    for (int32_t bandwidth_Hz = 1; bandwidth_Hz <= 1591; bandwidth_Hz++) {
        config.current_loop.bandwidth_Hz = bandwidth_Hz;
        const double exact = exp(-3.14159265358979323846 * bandwidth_Hz / 20000.0);
        TEST_ASSERT_DOUBLE_WITHIN(0.5 / 32768.0, exact,
                                  (double)design_half_period_q24(&config) / 16777216.0);
    }
}

void test_a_bandwidth_beyond_the_range_counts_as_its_end(void)
{
    config_t config = CONFIG_LU2013;
    config.drive.pwm_frequency_Hz = 4000;
    config.current_loop.bandwidth_Hz = 10000;
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, exp(-0.25),
                              (double)design_half_period_q24(&config) / 16777216.0);
}

/* The second Pade approximation of exp(-y), y at most a quarter, in whole steps of Q24 rounded
 * down; pi is the nearest. */
static double in_whole_steps_q24(double bandwidth_Hz, double frequency_Hz)
{
    const double one = 16777216.0;
    const double pi = round(3.14159265358979323846 * one);
    const double y = fmin(floor(bandwidth_Hz * pi / frequency_Hz), one / 4.0);
    const double even = one + floor(floor(y * y / one) / 12.0);
    const double half = floor(y / 2.0);
    return floor((even - half) * one / (even + half));
}

void test_the_pole_is_exact_to_the_last_unit_of_its_approximation(void)
{
    config_t config = CONFIG_LU2013;
    static const int32_t FREQUENCIES_Hz[] = {4260, 17001, 20000}; /* 339 at 4 260 Hz: 1/4 - 2^-24 */
    for (int f = 0; f < 3; f++) {
        config.drive.pwm_frequency_Hz = FREQUENCIES_Hz[f];
        for (int32_t bandwidth_Hz = 10; bandwidth_Hz <= 1600; bandwidth_Hz++) {
            config.current_loop.bandwidth_Hz = bandwidth_Hz;
            TEST_ASSERT_EQUAL_INT32((int32_t)in_whole_steps_q24(bandwidth_Hz, FREQUENCIES_Hz[f]),
                                    (int32_t)design_half_period_q24(&config));
        }
    }
}

void test_q15_is_the_nearest(void)
{
    TEST_ASSERT_EQUAL_INT32(0, design_q15(255));
    TEST_ASSERT_EQUAL_INT32(1, design_q15(256));
    TEST_ASSERT_EQUAL_INT32(-1, design_q15(-512));
    TEST_ASSERT_EQUAL_INT32(32768, design_q15(DESIGN_ONE_Q24));
}

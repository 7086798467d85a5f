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

void test_q15_is_the_nearest(void)
{
    TEST_ASSERT_EQUAL_INT32(0, design_q15(255));
    TEST_ASSERT_EQUAL_INT32(1, design_q15(256));
    TEST_ASSERT_EQUAL_INT32(-1, design_q15(-512));
    TEST_ASSERT_EQUAL_INT32(32768, design_q15(DESIGN_ONE_Q24));
}

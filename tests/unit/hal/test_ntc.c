/* SPDX-License-Identifier: Apache-2.0 */
#include <math.h>

#include "ntc.h"
#include "unity.h"

enum { BROKEN_cC = 29999 };

void setUp(void) {}

void tearDown(void) {}

/* The formula of ntc.h, in double: R/R_25 = exp(B (1/T - 1/T_25)), divider with R_25. */
static double code_at(double celsius)
{
    const double ratio = exp(3380.0 * (1.0 / (celsius + 273.15) - 1.0 / 298.15));
    return 4096.0 * ratio / (ratio + 1.0);
}

static double celsius_at(double code)
{
    return 1.0 / (1.0 / 298.15 + log(code / (4096.0 - code)) / 3380.0) - 273.15;
}

void test_half_the_supply_voltage_is_25_degrees(void)
{
    TEST_ASSERT_INT32_WITHIN(5, 2500, ntc_temperature_cC(2048, BROKEN_cC));
}

void test_every_code_gives_the_formulas_temperature_within_the_stated_error(void)
{
    for (int32_t code = (int32_t)code_at(149.5); code <= (int32_t)code_at(-39.5); code++) {
        const double truth = celsius_at(code);
        const double error = 0.01 * ntc_temperature_cC(code, BROKEN_cC) - truth;
        TEST_ASSERT_DOUBLE_WITHIN(truth <= 130.0 ? 0.7 : 1.5, 0.0, error);
    }
}

/* The thermistor's curve hangs through between the table's points: what is read is never too cold.
 */
void test_a_temperature_above_the_winding_limit_is_no_sensor_fault(void)
{
    for (int32_t code = 64; code <= (int32_t)code_at(150.0); code++) {
        const double error = 0.01 * ntc_temperature_cC(code, BROKEN_cC) - celsius_at(code);
        TEST_ASSERT_TRUE(error > -0.1 && error < 4.6);
    }
}

void test_temperature_falls_monotonically_with_the_code(void)
{
    int32_t before = ntc_temperature_cC(64, BROKEN_cC);
    for (int32_t code = 65; code <= 3929; code++) {
        const int32_t now = ntc_temperature_cC(code, BROKEN_cC);
        TEST_ASSERT_TRUE(now <= before);
        before = now;
    }
}

void test_open_or_shorted_sensor_is_reported_as_broken(void)
{
    TEST_ASSERT_EQUAL_INT32(BROKEN_cC, ntc_temperature_cC(0, BROKEN_cC));
    TEST_ASSERT_EQUAL_INT32(BROKEN_cC, ntc_temperature_cC((int32_t)code_at(197.5), BROKEN_cC));
    TEST_ASSERT_EQUAL_INT32(BROKEN_cC, ntc_temperature_cC((int32_t)code_at(-45.0), BROKEN_cC));
    TEST_ASSERT_EQUAL_INT32(BROKEN_cC, ntc_temperature_cC(4096, BROKEN_cC));
}

/* A thermistor R on the supply with G to ground shows 4096 G / (R + G); the table wants what 10
 * kOhm to the supply would show for the same R, to within the rounding of both codes. */
void test_a_divider_with_another_resistor_gives_the_same_temperature(void)
{
    for (double celsius = -30.0; celsius <= 140.0; celsius += 1.0) {
        const double thermistor_Ohm =
            10000.0 * exp(3380.0 * (1.0 / (celsius + 273.15) - 1.0 / 298.15));
        const double shown = 4096.0 * 4700.0 / (thermistor_Ohm + 4700.0);
        const int32_t code = ntc_code_of_divider((int32_t)lround(shown), 4700);
        const double slope = fabs(celsius_at(code + 1) - celsius_at(code - 1)) / 2.0;
        TEST_ASSERT_DOUBLE_WITHIN((celsius <= 130.0 ? 0.7 : 1.5) + 2.0 * slope, celsius,
                                  0.01 * ntc_temperature_cC(code, BROKEN_cC));
    }
}

void test_a_divider_with_another_resistor_that_is_open_or_shorted_is_broken(void)
{
    TEST_ASSERT_EQUAL_INT32(BROKEN_cC, ntc_temperature_cC(ntc_code_of_divider(0, 4700), BROKEN_cC));
    TEST_ASSERT_EQUAL_INT32(BROKEN_cC,
                            ntc_temperature_cC(ntc_code_of_divider(4095, 4700), BROKEN_cC));
}

/* SPDX-License-Identifier: Apache-2.0 */
/* Thermistor with lag, offset, gain error and line faults. */
#include "plant/temperature_sensor.h"

#include <math.h>

#include "unity.h"

static winding_sensor_params_t params;

void setUp(void)
{
    const winding_sensor_params_t ideal = {.lag_s = 0.0};
    params = ideal;
}

void tearDown(void) {}

void test_reading_is_exact_without_faults(void)
{
    temperature_sensor_t sensor = temperature_sensor_at(25.0);
    TEST_ASSERT_EQUAL_DOUBLE(83.123456789,
                             temperature_sensor_step(&params, &sensor, 83.123456789, false, 1e-3));
}

void test_step_response_is_exponential_for_any_step_length(void)
{
    params.lag_s = 2.0;
    const double steps_s[] = {1e-3, 0.1};
    for (int n = 0; n < 2; n++) {
        temperature_sensor_t sensor = temperature_sensor_at(20.0);
        const int count = (int)lround(3.0 / steps_s[n]);
        double seen_c = 0.0;
        for (int k = 0; k < count; k++) {
            seen_c = temperature_sensor_step(&params, &sensor, 120.0, false, steps_s[n]);
        }
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, 120.0 - 100.0 * exp(-1.5), seen_c);
    }
}

void test_offset_and_gain_act_on_the_reported_temperature(void)
{
    params.offset_k = -3.0;
    params.gain_error = 0.1;
    temperature_sensor_t sensor = temperature_sensor_at(25.0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 107.0,
                              temperature_sensor_step(&params, &sensor, 100.0, false, 1e-3));
}

void test_open_or_shorted_line_reads_above_every_limit_until_repaired(void)
{
    temperature_sensor_t sensor = temperature_sensor_at(25.0);
    params.open = 1.0;
    TEST_ASSERT_EQUAL_DOUBLE(299.99, temperature_sensor_step(&params, &sensor, 60.0, false, 1e-3));
    params.open = 0.0;
    params.shorted = 1.0;
    TEST_ASSERT_EQUAL_DOUBLE(299.99, temperature_sensor_step(&params, &sensor, 60.0, false, 1e-3));
    params.shorted = 0.0;
    TEST_ASSERT_EQUAL_DOUBLE(299.99, temperature_sensor_step(&params, &sensor, 60.0, true, 1e-3));
    TEST_ASSERT_EQUAL_DOUBLE(60.0, temperature_sensor_step(&params, &sensor, 60.0, false, 1e-3));
}

void test_a_stuck_sensor_goes_on_with_its_last_reading_also_without_its_line(void)
{
    temperature_sensor_t sensor = temperature_sensor_at(25.0);
    temperature_sensor_step(&params, &sensor, 60.0, false, 1e-3);
    params.stuck = 1.0;
    TEST_ASSERT_EQUAL_DOUBLE(60.0, temperature_sensor_step(&params, &sensor, 90.0, false, 1e-3));
    params.stuck = 0.0;
    TEST_ASSERT_EQUAL_DOUBLE(90.0, temperature_sensor_step(&params, &sensor, 90.0, false, 1e-3));
}

/* 10 kOhm, B = 3380 K at 25 degC in a divider with 10 kOhm: half the supply. At 100 degC by hand:
 * R = 10 kOhm exp(3380 (1/373.15 - 1/298.15)) = 1023.9 Ohm, code 4096 R/(R + 10 kOhm) = 380.4. */
void test_a_thermistor_s_code_is_that_of_its_divider(void)
{
    const winding_sensor_params_t own = {
        .kind = 1.0, .ohm_25c = 10e3, .beta_k = 3380.0, .divider_ohm = 10e3};
    temperature_sensor_t sensor = temperature_sensor_at(25.0);
    TEST_ASSERT_EQUAL_INT32(2048, temperature_sensor_code(&own, &sensor, false));
    sensor.sensor_c = 100.0;
    TEST_ASSERT_EQUAL_INT32(380, temperature_sensor_code(&own, &sensor, false));
}

/* PT1000 at 100 degC: 1385.06 Ohm (IEC 60751), code 4096 1385/11385 = 498.3; to the supply 4096
 * less that. */
void test_a_sensor_that_rises_with_temperature_is_read_from_either_side_of_its_divider(void)
{
    winding_sensor_params_t own = {.kind = 2.0,
                                   .ohm_25c = 1097.35,
                                   .linear_per_k = 3.5353e-3,
                                   .square_per_k2 = -5.263e-7,
                                   .divider_ohm = 10e3};
    temperature_sensor_t sensor = temperature_sensor_at(100.0);
    TEST_ASSERT_EQUAL_INT32(498, temperature_sensor_code(&own, &sensor, false));
    own.to_supply = 1.0;
    TEST_ASSERT_EQUAL_INT32(3597, temperature_sensor_code(&own, &sensor, false));
}

void test_open_and_shorted_lines_are_the_ends_of_the_converter(void)
{
    winding_sensor_params_t own = {
        .kind = 1.0, .ohm_25c = 10e3, .beta_k = 3380.0, .divider_ohm = 10e3, .open = 1.0};
    const temperature_sensor_t sensor = temperature_sensor_at(25.0);
    TEST_ASSERT_EQUAL_INT32(4095, temperature_sensor_code(&own, &sensor, false));
    own.to_supply = 1.0;
    TEST_ASSERT_EQUAL_INT32(0, temperature_sensor_code(&own, &sensor, false));
    own.open = 0.0;
    own.shorted = 1.0;
    TEST_ASSERT_EQUAL_INT32(4095, temperature_sensor_code(&own, &sensor, false));
    own.to_supply = 0.0;
    TEST_ASSERT_EQUAL_INT32(0, temperature_sensor_code(&own, &sensor, false));
    TEST_ASSERT_EQUAL_INT32(4095, temperature_sensor_code(&own, &sensor, true));
}

/* SPDX-License-Identifier: Apache-2.0 */
/* Raw and engineering values say the same; a converter code is the one the simulated converter
 * would give. */
#include "exchange/variables.h"

#include <math.h>
#include <string.h>

#include "plant/sensors.h"
#include "unity.h"
#include "vehicle_fixture.h"

static config_t config;

void setUp(void)
{
    config = fixture_config(CONFIG_STRATEGY_SERIES_OPTIMAL);
}

void tearDown(void) {}

static variable_info_t variable(exchange_port_t port, const char *name)
{
    for (int k = 0; k < variables_count(port); k++) {
        const variable_info_t info = variables_info(port, k);
        if (strcmp(info.name, name) == 0) {
            return info;
        }
    }
    TEST_FAIL_MESSAGE(name);
    return variables_info(port, 0);
}

static int32_t raw_of(exchange_port_t port, const char *name, double value)
{
    const variable_info_t info = variable(port, name);
    return variables_to_raw(&info, variables_affine(info.scale, &config), value);
}

void test_names_and_raw_names_are_unique_in_their_port_and_have_descriptions(void)
{
    for (int p = 0; p < EXCHANGE_PORTS; p++) {
        const exchange_port_t port = (exchange_port_t)p;
        for (int k = 0; k < variables_count(port); k++) {
            const variable_info_t one = variables_info(port, k);
            TEST_ASSERT_TRUE_MESSAGE(strlen(one.text) > 3, one.name);
            TEST_ASSERT_TRUE_MESSAGE(one.lowest_raw < one.highest_raw, one.name);
            TEST_ASSERT_EQUAL_INT_MESSAGE(one.type == EXCHANGE_REAL, one.unit[0] != '\0', one.name);
            for (int n = 0; n < k; n++) {
                const variable_info_t other = variables_info(port, n);
                TEST_ASSERT_TRUE_MESSAGE(strcmp(one.name, other.name) != 0, one.name);
                TEST_ASSERT_TRUE_MESSAGE(strcmp(one.raw_name, other.raw_name) != 0, one.raw_name);
            }
        }
    }
}

void test_adc_codes_are_those_of_an_ideal_converter_of_the_same_full_scale(void)
{
    const sensors_params_t params = {
        .current_full_scale_a = 1e-3 * config.drive.current_full_scale_mA,
        .voltage_full_scale_v = 1e-3 * config.drive.voltage_full_scale_mV,
        .adc_bits = 12.0,
    };
    const sensors_t sensors = sensors_init(&params);
    const sensors_fault_t healthy = {.offset_a = 0.0};
    random_t random = random_init(1, 0);
    for (int k = -300; k <= 300; k++) {
        const plant_abc_t i = {.a = 0.7131 * k, .b = -0.31 * k, .c = 0.017 * k};
        const double volts = 0.11 * (k + 300);
        const double turn = (k + 300) / 601.0;
        const sensors_sample_t seen = sensors_sample(&sensors, &healthy, &random, i, volts, turn);
        TEST_ASSERT_EQUAL_INT(seen.phase_current_code[0],
                              raw_of(EXCHANGE_PORT_FAST_INPUT, "phase_a_a", i.a));
        TEST_ASSERT_EQUAL_INT(seen.phase_current_code[1],
                              raw_of(EXCHANGE_PORT_FAST_INPUT, "phase_b_a", i.b));
        TEST_ASSERT_EQUAL_INT(seen.phase_current_code[2],
                              raw_of(EXCHANGE_PORT_FAST_INPUT, "phase_c_a", i.c));
        TEST_ASSERT_EQUAL_INT(seen.bus_voltage_code,
                              raw_of(EXCHANGE_PORT_FAST_INPUT, "bus_voltage_v", volts));
        TEST_ASSERT_EQUAL_INT(seen.rotor_angle_turn,
                              raw_of(EXCHANGE_PORT_FAST_INPUT, "rotor_angle_turn", turn));
    }
}

void test_an_angle_of_several_turns_wraps(void)
{
    for (int turns = -3; turns <= 3; turns++) {
        TEST_ASSERT_EQUAL_INT(16384,
                              raw_of(EXCHANGE_PORT_FAST_INPUT, "rotor_angle_turn", turns + 0.25));
    }
    TEST_ASSERT_EQUAL_INT(0, raw_of(EXCHANGE_PORT_FAST_INPUT, "rotor_angle_turn", -1e-9));
}

void test_scale_factors_are_those_of_the_unit_suffixes(void)
{
    TEST_ASSERT_EQUAL_INT(-12346, raw_of(EXCHANGE_PORT_SLOW_INPUT, "drive_torque_nm", -12.3456));
    TEST_ASSERT_EQUAL_INT(2500, raw_of(EXCHANGE_PORT_SLOW_INPUT, "winding_temperature_c", 25.0));
    TEST_ASSERT_EQUAL_INT(100, raw_of(EXCHANGE_PORT_SLOW_INPUT, "demand_age_s", 0.1));
    TEST_ASSERT_EQUAL_INT(1, raw_of(EXCHANGE_PORT_SLOW_INPUT, "enable", 1.0));
}

void test_values_beyond_the_raw_range_saturate(void)
{
    TEST_ASSERT_EQUAL_INT(INT32_MAX, raw_of(EXCHANGE_PORT_SLOW_INPUT, "drive_torque_nm", 1e300));
    TEST_ASSERT_EQUAL_INT(INT32_MIN, raw_of(EXCHANGE_PORT_SLOW_INPUT, "drive_torque_nm", -1e300));
    TEST_ASSERT_EQUAL_INT(0, raw_of(EXCHANGE_PORT_SLOW_INPUT, "brake_torque_nm", -1.0));
    TEST_ASSERT_EQUAL_INT(4095, raw_of(EXCHANGE_PORT_FAST_INPUT, "bus_voltage_v", 1e6));
    TEST_ASSERT_EQUAL_INT(1, raw_of(EXCHANGE_PORT_SLOW_INPUT, "enable", 7.0));
}

void test_raw_to_engineering_and_back_is_the_identity(void)
{
    for (int p = 0; p < EXCHANGE_PORTS; p++) {
        for (int k = 0; k < variables_count((exchange_port_t)p); k++) {
            const variable_info_t info = variables_info((exchange_port_t)p, k);
            const variables_affine_t affine = variables_affine(info.scale, &config);
            const int64_t step = ((int64_t)info.highest_raw - info.lowest_raw) / 997 + 1;
            for (int64_t raw = info.lowest_raw; raw <= info.highest_raw; raw += step) {
                const double value = variables_from_raw(affine, (int32_t)raw);
                TEST_ASSERT_EQUAL_INT32_MESSAGE((int32_t)raw,
                                                variables_to_raw(&info, affine, value), info.name);
            }
        }
    }
}

/* SPDX-License-Identifier: Apache-2.0 */
/* Names, ranges and places of all parameters. */
#include "bench/parameters.h"

#include <math.h>
#include <string.h>

#include "unity.h"

static bench_params_t params;

void setUp(void)
{
    memset(&params, 0, sizeof(params));
}

void tearDown(void) {}

void test_names_are_unique_and_found(void)
{
    for (int k = 0; k < parameters_count(); k++) {
        TEST_ASSERT_EQUAL_INT_MESSAGE(k, parameters_find(parameters_info(k).name),
                                      parameters_info(k).name);
    }
    TEST_ASSERT_EQUAL_INT(-1, parameters_find("motor.no_such_thing"));
    TEST_ASSERT_EQUAL_INT(-1, parameters_find(""));
}

void test_no_two_parameters_share_a_member(void)
{
    for (int k = 0; k < parameters_count(); k++) {
        const parameter_info_t info = parameters_info(k);
        TEST_ASSERT_TRUE_MESSAGE(
            parameters_set(&params, k, info.lowest + (info.highest - info.lowest) * k / 1000.0),
            info.name);
    }
    for (int k = 0; k < parameters_count(); k++) {
        const parameter_info_t info = parameters_info(k);
        TEST_ASSERT_EQUAL_DOUBLE(info.lowest + (info.highest - info.lowest) * k / 1000.0,
                                 parameters_get(&params, k));
    }
}

void test_both_ends_of_a_range_are_accepted_and_values_beyond_are_refused(void)
{
    for (int k = 0; k < parameters_count(); k++) {
        const parameter_info_t info = parameters_info(k);
        TEST_ASSERT_TRUE(parameters_set(&params, k, info.lowest));
        TEST_ASSERT_TRUE(parameters_set(&params, k, info.highest));
        TEST_ASSERT_FALSE_MESSAGE(parameters_set(&params, k, nextafter(info.lowest, -INFINITY)),
                                  info.name);
        TEST_ASSERT_FALSE_MESSAGE(parameters_set(&params, k, nextafter(info.highest, INFINITY)),
                                  info.name);
        TEST_ASSERT_FALSE_MESSAGE(parameters_set(&params, k, NAN), info.name);
        TEST_ASSERT_EQUAL_DOUBLE(info.highest, parameters_get(&params, k));
    }
}

void test_names_end_in_the_name_of_their_member(void)
{
    TEST_ASSERT_TRUE(parameters_set(&params, parameters_find("motor.pole_pairs"), 23.0));
    TEST_ASSERT_TRUE(parameters_set(&params, parameters_find("road.slope"), 0.05));
    TEST_ASSERT_TRUE(parameters_set(&params, parameters_find("sensors.hall_edge_5_deg"), 299.0));
    TEST_ASSERT_EQUAL_DOUBLE(23.0, params.motor.pole_pairs);
    TEST_ASSERT_EQUAL_DOUBLE(0.05, params.road.slope);
    TEST_ASSERT_EQUAL_DOUBLE(299.0, params.sensors.hall_edge_5_deg);
}

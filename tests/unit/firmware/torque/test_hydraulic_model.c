/* SPDX-License-Identifier: Apache-2.0 */
#include <math.h>

#include "paper_vehicle.h"
#include "random_values.h"
#include "torque/hydraulic_model.h"
#include "unity.h"

static config_t config;
static hydraulic_model_t model;

void setUp(void)
{
    config = paper_vehicle();
    config.brake.hydraulic_dead_time_ms = 40;
    config.brake.hydraulic_time_constant_ms = 60;
    config.brake.hydraulic_rate_mNm_s = 2000000;
    config.brake.max_hydraulic_torque_mNm = 300000;
    hydraulic_model_init(&model);
}

void tearDown(void) {}

static int32_t after(int milliseconds, int32_t command_mNm)
{
    for (int n = 0; n < milliseconds; n++) {
        hydraulic_model_step(&model, &config, command_mNm);
    }
    return hydraulic_model_torque_mNm(&model);
}

void test_torque_is_zero_during_the_dead_time(void)
{
    TEST_ASSERT_EQUAL_INT32(0, after(40, 50000));
    TEST_ASSERT_GREATER_THAN_INT32(0, after(1, 50000));
}

void test_torque_follows_as_a_first_order_lag_after_the_dead_time(void)
{
    for (int n = 1; n <= 600; n++) {
        const int32_t torque_mNm = after(1, 50000);
        const double expected = n <= 40 ? 0.0 : 50000.0 * (1.0 - exp(-(n - 40) / 60.0));
        TEST_ASSERT_DOUBLE_WITHIN(500.0, expected, torque_mNm); /* half a step of 1 ms of 60 ms */
    }
    for (int n = 1; n <= 600; n++) {
        const int32_t torque_mNm = after(1, 0);
        const double expected = n <= 40 ? 50000.0 : 50000.0 * exp(-(n - 40) / 60.0);
        TEST_ASSERT_DOUBLE_WITHIN(500.0, expected, torque_mNm);
    }
}

void test_torque_settles_on_the_command_within_1_mNm(void)
{
    TEST_ASSERT_INT32_WITHIN(1, 123457, after(3000, 123457));
    TEST_ASSERT_INT32_WITHIN(1, 0, after(3000, 0));
}

void test_torque_changes_no_faster_than_the_hydraulic_rate(void)
{
    config.brake.hydraulic_rate_mNm_s = 500000;
    after(40, 200000);
    for (int n = 1; n <= 100; n++) { /* 200 N m over 60 ms would be 3333 N m/s */
        TEST_ASSERT_INT32_WITHIN(2, 500 * n, after(1, 200000));
    }
}

void test_torque_equals_the_command_without_delay(void)
{
    config.brake.hydraulic_dead_time_ms = 0;
    config.brake.hydraulic_time_constant_ms = 0;
    config.brake.hydraulic_rate_mNm_s = 2000000000;
    TEST_ASSERT_EQUAL_INT32(77000, after(1, 77000));
    TEST_ASSERT_EQUAL_INT32(1, after(1, 1));
}

void test_torque_stays_between_zero_and_max_hydraulic_torque(void)
{
    random_t random = random_seeded(1);
    for (int c = 0; c < 50; c++) {
        config.brake.hydraulic_dead_time_ms = random_between(&random, 0, 250);
        config.brake.hydraulic_time_constant_ms = random_between(&random, 0, 2000);
        config.brake.hydraulic_rate_mNm_s = random_between(&random, 100, 2000000000);
        config.brake.max_hydraulic_torque_mNm = random_between(&random, 0, 20000000);
        hydraulic_model_init(&model);
        for (int n = 0; n < 2000; n++) {
            const int32_t torque_mNm = after(1, random_wild(&random));
            TEST_ASSERT_GREATER_OR_EQUAL_INT32(0, torque_mNm);
            TEST_ASSERT_LESS_OR_EQUAL_INT32(config.brake.max_hydraulic_torque_mNm, torque_mNm);
        }
    }
}

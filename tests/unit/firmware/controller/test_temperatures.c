/* SPDX-License-Identifier: Apache-2.0 */
/* Which temperatures the controller uses, with the estimate of the paper's vehicle. */
#include "controller/temperatures.h"
#include "paper_vehicle.h"
#include "unity.h"

static config_t config;
static temperatures_t state;
static wheel_temperatures_t measured;
static measured_t now;

void setUp(void)
{
    config = paper_vehicle();
    temperatures_init(&state, &config);
    const wheel_temperatures_t as_ambient = {.winding_cC = 2500, .switch_cC = 2500};
    measured = as_ambient;
}

void tearDown(void) {}

static void run(int milliseconds, int32_t i_q_mA)
{
    now.i_q_mA = i_q_mA;
    now.speed_mrad_s = 20000;
    for (int n = 0; n < milliseconds; n++) {
        temperatures_step(&state, &config, &measured, &now);
    }
}

void test_good_sensors_are_used(void)
{
    measured.winding_cC = 4321;
    measured.switch_cC = 3210;
    run(100, 40000);
    TEST_ASSERT_EQUAL_INT(4321, now.winding_temperature_cC);
    TEST_ASSERT_EQUAL_INT(3210, now.switch_temperature_cC);
    TEST_ASSERT_FALSE(now.winding_sensor_broken || now.switch_sensor_broken);
}

/* 3/2 0.031 ohm (60 A)^2 = 167 W into 580 J/K for 10 s: 2.9 K, less what flows into the housing. */
void test_each_broken_sensor_is_replaced_by_its_own_estimate(void)
{
    measured.winding_cC = 29999;
    run(10000, 60000);
    TEST_ASSERT_TRUE(now.winding_sensor_broken);
    TEST_ASSERT_FALSE(now.switch_sensor_broken);
    TEST_ASSERT_INT_WITHIN(20, 2500 + 285, now.winding_temperature_cC);
    TEST_ASSERT_EQUAL_INT(2500, now.switch_temperature_cC);
    setUp();
    measured.switch_cC = -20000;
    run(10000, 60000);
    TEST_ASSERT_TRUE(now.switch_sensor_broken);
    TEST_ASSERT_FALSE(now.winding_sensor_broken);
    TEST_ASSERT_TRUE(now.switch_temperature_cC > 2700 && now.switch_temperature_cC < 5000);
    TEST_ASSERT_EQUAL_INT(2500, now.winding_temperature_cC);
}

/* 15 K at 260 W and 580 J/K take half a minute. */
void test_a_winding_sensor_that_never_moves_is_found_while_the_motor_works_hard(void)
{
    run(20000, 75000);
    TEST_ASSERT_FALSE(now.winding_sensor_broken);
    run(30000, 75000);
    TEST_ASSERT_TRUE(now.winding_sensor_broken);
    TEST_ASSERT_TRUE(now.winding_temperature_cC > 4000);
}

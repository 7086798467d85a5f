/* SPDX-License-Identifier: Apache-2.0 */
/* Four straight lines over two travels, and what a fault makes of one of them. */
#include "plant/pedal_sensors.h"

#include "unity.h"

static pedal_sensors_params_t params;

void setUp(void)
{
    const pedal_sensors_params_t healthy = {
        .accelerator_a_released = 0.1,
        .accelerator_a_pressed = 0.9,
        .accelerator_b_released = 0.8,
        .accelerator_b_pressed = 0.2,
        .brake_a_released = 0.2,
        .brake_a_pressed = 0.6,
        .brake_b_released = 0.1,
        .brake_b_pressed = 0.3,
    };
    params = healthy;
}

void tearDown(void) {}

void test_each_channel_is_a_straight_line_over_the_travel_of_its_pedal(void)
{
    const pedal_sensors_t seen = pedal_sensors_read(&params, 0.25, 0.5);
    TEST_ASSERT_EQUAL_DOUBLE(0.3, seen.accelerator_a);
    TEST_ASSERT_EQUAL_DOUBLE(0.65, seen.accelerator_b);
    TEST_ASSERT_EQUAL_DOUBLE(0.4, seen.brake_a);
    TEST_ASSERT_EQUAL_DOUBLE(0.2, seen.brake_b);
}

void test_a_broken_channel_lies_at_ground_or_at_the_supply_and_a_drifted_one_within_them(void)
{
    params.accelerator_b_broken = 1.0;
    params.brake_a_broken = 2.0;
    params.brake_b_offset = 0.05;
    params.accelerator_a_offset = 0.5;
    const pedal_sensors_t seen = pedal_sensors_read(&params, 1.0, 0.5);
    TEST_ASSERT_EQUAL_DOUBLE(1.0, seen.accelerator_a);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, seen.accelerator_b);
    TEST_ASSERT_EQUAL_DOUBLE(1.0, seen.brake_a);
    TEST_ASSERT_EQUAL_DOUBLE(0.25, seen.brake_b);
}

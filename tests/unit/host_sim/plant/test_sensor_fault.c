/* SPDX-License-Identifier: Apache-2.0 */
/* Broken sensors: what each shows, beside what the plant does. */
#include "plant/sensor_fault.h"

#include <math.h>
#include <string.h>

#include "unity.h"

static const double FULL_SCALE_A = 100.0;
static const double PERIOD_S = 50e-6;
static const plant_abc_t CURRENT_A = {.a = 20.0, .b = -5.0, .c = -15.0};

static fault_params_t params;
static sensor_fault_t state;
static random_t noise;

void setUp(void)
{
    memset(&params, 0, sizeof(params));
    memset(&state, 0, sizeof(state));
    noise = random_init(1, 0);
}

void tearDown(void) {}

static sensor_view_t seen_at(double theta_turn)
{
    const sensor_view_t truth = {
        .current_a = CURRENT_A, .bus_voltage_v = 50.0, .theta_turn = theta_turn};
    return sensor_fault_before(&params, &state, &truth, FULL_SCALE_A, PERIOD_S);
}

static sensors_sample_t shown(uint16_t code_a, uint8_t halls)
{
    sensors_sample_t sample = {.phase_current_code = {code_a, 2000U, 2100U},
                               .bus_voltage_code = 3000U,
                               .hall_state = halls};
    sensor_fault_after(&params, &state, &noise, &sample);
    return sample;
}

void test_a_healthy_wheel_has_no_fault_and_any_parameter_but_the_wheels_makes_one(void)
{
    TEST_ASSERT_FALSE(sensor_fault_present(&params));
    params.wheels = 3.0;
    TEST_ASSERT_FALSE(sensor_fault_present(&params));
    params.index_lost = 1.0;
    TEST_ASSERT_TRUE(sensor_fault_present(&params));
}

void test_gain_and_offset_concern_the_chosen_current_sensors_only(void)
{
    params.current_sensors = 5.0; /* a and c */
    params.current_gain_error = -0.5;
    params.current_offset = 0.1; /* 10 A */
    const sensor_view_t view = seen_at(0.0);
    TEST_ASSERT_EQUAL_DOUBLE(20.0, view.current_a.a);
    TEST_ASSERT_EQUAL_DOUBLE(-5.0, view.current_a.b);
    TEST_ASSERT_EQUAL_DOUBLE(2.5, view.current_a.c);
}

void test_a_drift_grows_with_time_and_ends_with_its_cause(void)
{
    params.current_sensors = 2.0;
    params.current_drift_per_s = 0.5; /* 50 A a second */
    for (int k = 0; k < 20000; k++) { /* one second */
        seen_at(0.0);
    }
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 45.0, seen_at(0.0).current_a.b);
    params.current_drift_per_s = 0.0;
    TEST_ASSERT_EQUAL_DOUBLE(-5.0, seen_at(0.0).current_a.b);
}

void test_a_stuck_sensor_shows_its_share_of_the_range_and_a_frozen_one_its_last_code(void)
{
    params.current_sensors = 1.0;
    params.current_stuck = 1.0;
    TEST_ASSERT_EQUAL_UINT16(2048U, shown(1234U, 5U).phase_current_code[0]);
    params.current_shown = 1.0;
    TEST_ASSERT_EQUAL_UINT16(4095U, shown(1234U, 5U).phase_current_code[0]);
    params.current_shown = -0.25;
    const sensors_sample_t stuck = shown(1234U, 5U);
    TEST_ASSERT_EQUAL_UINT16(2048U - 512U, stuck.phase_current_code[0]);
    TEST_ASSERT_EQUAL_UINT16(2000U, stuck.phase_current_code[1]);
    params.current_stuck = 0.0;
    params.current_frozen = 1.0;
    TEST_ASSERT_EQUAL_UINT16(1300U, shown(1300U, 5U).phase_current_code[0]);
    TEST_ASSERT_EQUAL_UINT16(1300U, shown(1400U, 5U).phase_current_code[0]);
    params.current_frozen = 0.0;
    TEST_ASSERT_EQUAL_UINT16(1400U, shown(1400U, 5U).phase_current_code[0]);
}

void test_the_bus_sensor_sticks_freezes_and_has_a_gain(void)
{
    params.bus_gain_error = 0.2;
    TEST_ASSERT_EQUAL_DOUBLE(60.0, seen_at(0.0).bus_voltage_v);
    params.bus_stuck = 1.0;
    params.bus_shown = 0.5;
    TEST_ASSERT_EQUAL_UINT16(2048U, shown(2048U, 5U).bus_voltage_code);
    params.bus_stuck = 0.0;
    params.bus_frozen = 1.0;
    TEST_ASSERT_EQUAL_UINT16(3000U, shown(2048U, 5U).bus_voltage_code);
    state.kept_bus_code = 1U;
    TEST_ASSERT_EQUAL_UINT16(1U, shown(2048U, 5U).bus_voltage_code);
}

void test_a_frozen_rotor_sensor_stays_where_it_was_and_a_reversed_one_goes_the_other_way(void)
{
    params.rotor_frozen = 1.0;
    TEST_ASSERT_EQUAL_DOUBLE(0.3, seen_at(0.3).theta_turn);
    TEST_ASSERT_EQUAL_DOUBLE(0.3, seen_at(0.9).theta_turn);
    params.rotor_frozen = 0.0;
    TEST_ASSERT_EQUAL_DOUBLE(0.9, seen_at(0.9).theta_turn);
    params.rotor_reversed = 1.0;
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.1, seen_at(0.1).theta_turn);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.9, seen_at(0.3).theta_turn);
}

void test_a_jump_displaces_the_sensor_at_once_and_a_slip_in_time(void)
{
    params.rotor_jump_deg = -90.0;
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.85, seen_at(0.1).theta_turn);
    params.rotor_jump_deg = 0.0;
    params.rotor_slip_deg_per_s = 360.0;
    for (int k = 0; k < 4999; k++) { /* a quarter of a second */
        seen_at(0.1);
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.35, seen_at(0.1).theta_turn);
}

void test_a_floating_line_is_high_in_half_of_the_samples_and_the_others_stay(void)
{
    params.hall_floating = 2.0;
    int high = 0;
    for (int k = 0; k < 10000; k++) {
        const uint8_t halls = shown(2048U, 5U).hall_state;
        TEST_ASSERT_EQUAL_UINT8(5U, halls & 5U);
        high += (halls & 2U) != 0U ? 1 : 0;
    }
    TEST_ASSERT_INT_WITHIN(200, 5000, high); /* four standard deviations */
}

void test_a_loose_contact_shows_line_and_pull_up_in_turn(void)
{
    params.hall_bouncing = 4.0;
    params.hall_bounce_s = 10.0 * PERIOD_S;
    int high = 0;
    int changes = 0;
    uint8_t last = 0U;
    for (int k = 0; k < 1000; k++) {
        seen_at(0.0);
        const uint8_t line = shown(2048U, 1U).hall_state & 4U;
        high += line != 0U ? 1 : 0;
        changes += line != last ? 1 : 0;
        last = line;
    }
    TEST_ASSERT_INT_WITHIN(50, 500, high);
    TEST_ASSERT_INT_WITHIN(10, 100, changes);
}

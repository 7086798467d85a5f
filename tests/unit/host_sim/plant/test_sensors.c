/* SPDX-License-Identifier: Apache-2.0 */
/* Sensor models: ADC codes, hall states, angle, and injected faults. */
#include "plant/sensors.h"

#include <math.h>

#include "unity.h"

static sensors_params_t params;
static random_t noise;
static sensors_fault_t fault;
static const plant_abc_t NO_CURRENT = {0.0, 0.0, 0.0};

void setUp(void)
{
    const sensors_params_t clean = {.current_full_scale_a = 165.0,
                                    .voltage_full_scale_v = 61.8,
                                    .adc_bits = 12.0,
                                    .hall_edge_0_deg = 0.0,
                                    .hall_edge_1_deg = 60.0,
                                    .hall_edge_2_deg = 120.0,
                                    .hall_edge_3_deg = 180.0,
                                    .hall_edge_4_deg = 240.0,
                                    .hall_edge_5_deg = 300.0};
    params = clean;
    const sensors_fault_t none = {.offset_a = 0.0};
    fault = none;
    noise = random_init(1, 0);
}

void tearDown(void) {}

static sensors_sample_t sample(plant_abc_t current, double bus_v, double theta_turn)
{
    const sensors_t sensors = sensors_init(&params);
    return sensors_sample(&sensors, &fault, &noise, current, bus_v, theta_turn);
}

void test_zero_current_is_mid_range_and_full_scale_is_half_the_range(void)
{
    const plant_abc_t current = {.a = 0.0, .b = 82.5, .c = -82.5};
    const sensors_sample_t seen = sample(current, 30.9, 0.0);
    TEST_ASSERT_EQUAL_UINT16(2048, seen.phase_current_code[0]);
    TEST_ASSERT_EQUAL_UINT16(2048 + 1024, seen.phase_current_code[1]);
    TEST_ASSERT_EQUAL_UINT16(2048 - 1024, seen.phase_current_code[2]);
    TEST_ASSERT_EQUAL_UINT16(2048, seen.bus_voltage_code);
}

void test_converter_saturates_at_the_ends_of_its_range(void)
{
    const plant_abc_t current = {.a = 400.0, .b = -400.0, .c = 0.0};
    const sensors_sample_t seen = sample(current, 99.0, 0.0);
    TEST_ASSERT_EQUAL_UINT16(4095, seen.phase_current_code[0]);
    TEST_ASSERT_EQUAL_UINT16(0, seen.phase_current_code[1]);
    TEST_ASSERT_EQUAL_UINT16(4095, seen.bus_voltage_code);
}

void test_quantisation_error_is_at_most_half_a_step(void)
{
    for (int k = -1500; k <= 1500; k++) {
        const plant_abc_t current = {.a = 0.1 * k, .b = 0.0, .c = 0.0};
        const double exact = 2048.0 + current.a / 165.0 * 2048.0;
        const sensors_sample_t seen = sample(current, 50.0, 0.0);
        TEST_ASSERT_DOUBLE_WITHIN(0.5 + 1e-9, exact, (double)seen.phase_current_code[0]);
    }
}

void test_a_converter_of_lower_resolution_has_zero_low_bits(void)
{
    params.adc_bits = 10.0;
    for (int k = -300; k <= 300; k++) {
        const plant_abc_t current = {.a = 0.5 * k, .b = 0.0, .c = 0.0};
        const uint16_t code = sample(current, 50.0, 0.0).phase_current_code[0];
        TEST_ASSERT_EQUAL_UINT16(0, code % 4U);
        TEST_ASSERT_DOUBLE_WITHIN(2.0 + 1e-9, 2048.0 + current.a / 165.0 * 2048.0, (double)code);
    }
}

void test_the_offset_is_added_to_phases_a_and_c_and_subtracted_from_b(void)
{
    params.current_offset_a = 16.5;
    const sensors_sample_t seen = sample(NO_CURRENT, 50.0, 0.0);
    TEST_ASSERT_DOUBLE_WITHIN(1.0, 2048.0 + 204.8, (double)seen.phase_current_code[0]);
    TEST_ASSERT_DOUBLE_WITHIN(1.0, 2048.0 - 204.8, (double)seen.phase_current_code[1]);
    TEST_ASSERT_DOUBLE_WITHIN(1.0, 2048.0 + 204.8, (double)seen.phase_current_code[2]);
}

void test_hall_states_follow_the_forward_order_with_one_change_per_edge(void)
{
    const uint8_t order[6] = {5, 1, 3, 2, 6, 4};
    const sensors_t sensors = sensors_init(&params);
    for (int k = 0; k < 6; k++) {
        TEST_ASSERT_EQUAL_UINT8(order[k], sensors_hall_state(&sensors, (k + 0.001) / 6.0));
        TEST_ASSERT_EQUAL_UINT8(order[k], sensors_hall_state(&sensors, (k + 0.999) / 6.0));
        const unsigned changed = order[k] ^ (unsigned)order[(k + 1) % 6];
        TEST_ASSERT_TRUE(changed == 1U || changed == 2U || changed == 4U);
    }
}

/* Sensors rise a third of a turn apart, B and C in turn exchanged, lines inverted, and stuck. */
void test_lines_exchange_and_invert_what_the_sensors_show(void)
{
    for (unsigned lines = 0; lines < 16U; lines++) {
        params.hall_lines = lines;
        for (int k = 0; k < 360; k++) {
            const double turn = (k + 0.5) / 360.0;
            const bool on[3] = {turn < 0.5, turn >= 1.0 / 3.0 && turn < 5.0 / 6.0,
                                turn < 1.0 / 6.0 || turn >= 2.0 / 3.0};
            const bool exchanged = (lines & 8U) != 0;
            const unsigned expected = ((on[0] ? 1U : 0U) | (on[exchanged ? 2 : 1] ? 2U : 0U) |
                                       (on[exchanged ? 1 : 2] ? 4U : 0U)) ^
                                      (lines & 7U);
            fault.hall_stuck_low = 0U;
            TEST_ASSERT_EQUAL_UINT8(expected, sample(NO_CURRENT, 50.0, turn).hall_state);
            fault.hall_stuck_low = 4U;
            TEST_ASSERT_EQUAL_UINT8(expected & 3U, sample(NO_CURRENT, 50.0, turn).hall_state);
        }
    }
}

/* Angle at which the state after edge k begins, found by search. */
static double edge_deg(const sensors_t *sensors, uint8_t before, uint8_t after, double around_deg)
{
    for (int k = -2000; k < 2000; k++) {
        const double x = around_deg + 0.01 * k;
        const double turn = x / 360.0;
        const double next = (x + 0.01) / 360.0;
        if (sensors_hall_state(sensors, turn - floor(turn)) == before &&
            sensors_hall_state(sensors, next - floor(next)) == after) {
            return x;
        }
    }
    return NAN;
}

void test_misplaced_halls_switch_alternately_late_and_early_also_across_angle_zero(void)
{
    const uint8_t order[6] = {5, 1, 3, 2, 6, 4};
    params.hall_edge_0_deg = 357.0;
    params.hall_edge_error_deg = 5.0;
    const sensors_t sensors = sensors_init(&params);
    TEST_ASSERT_DOUBLE_WITHIN(0.02, 362.0, edge_deg(&sensors, order[5], order[0], 360.0));
    TEST_ASSERT_DOUBLE_WITHIN(0.02, 55.0, edge_deg(&sensors, order[0], order[1], 60.0));
    TEST_ASSERT_DOUBLE_WITHIN(0.02, 125.0, edge_deg(&sensors, order[1], order[2], 120.0));
}

void test_the_angle_is_rounded_and_wraps_to_zero(void)
{
    TEST_ASSERT_EQUAL_UINT16(0, sample(NO_CURRENT, 50.0, 0.0).rotor_angle_turn);
    TEST_ASSERT_EQUAL_UINT16(16384, sample(NO_CURRENT, 50.0, 0.25).rotor_angle_turn);
    TEST_ASSERT_EQUAL_UINT16(65535, sample(NO_CURRENT, 50.0, 65535.4 / 65536.0).rotor_angle_turn);
    TEST_ASSERT_EQUAL_UINT16(0, sample(NO_CURRENT, 50.0, 65535.6 / 65536.0).rotor_angle_turn);
}

void test_noise_has_the_given_standard_deviation_and_zero_mean(void)
{
    params.current_noise_a = 2.0;
    const sensors_t sensors = sensors_init(&params);
    const int samples = 20000;
    double sum = 0.0;
    double square = 0.0;
    for (int k = 0; k < samples; k++) {
        const sensors_sample_t seen =
            sensors_sample(&sensors, &fault, &noise, NO_CURRENT, 50.0, 0.0);
        const double a = (seen.phase_current_code[1] - 2048.0) / 2048.0 * 165.0;
        sum += a;
        square += a * a;
    }
    TEST_ASSERT_DOUBLE_WITHIN(4.0 * 2.0 / sqrt(samples), 0.0,
                              sum / samples); /* four standard errors */
    TEST_ASSERT_DOUBLE_WITHIN(0.04, 2.0, sqrt(square / samples));
}

void test_an_offset_drift_raises_a_and_c_and_lowers_b(void)
{
    fault.offset_a = 165.0 * 100.0 / 2048.0; /* 100 codes */
    const sensors_sample_t seen = sample(NO_CURRENT, 50.0, 0.0);
    TEST_ASSERT_EQUAL_UINT16(2148, seen.phase_current_code[0]);
    TEST_ASSERT_EQUAL_UINT16(1948, seen.phase_current_code[1]);
    TEST_ASSERT_EQUAL_UINT16(2148, seen.phase_current_code[2]);
}

void test_a_grounded_hall_line_reads_low_and_an_open_one_high_at_every_angle(void)
{
    for (int k = 0; k < 6; k++) {
        const double theta_turn = (k + 0.5) / 6.0;
        const sensors_fault_t none = {.offset_a = 0.0};
        fault = none;
        const unsigned healthy = sample(NO_CURRENT, 50.0, theta_turn).hall_state;
        fault.hall_stuck_low = 1U;
        TEST_ASSERT_EQUAL_UINT8(healthy & 6U, sample(NO_CURRENT, 50.0, theta_turn).hall_state);
        fault.hall_stuck_low = 0U;
        fault.hall_stuck_high = 2U;
        TEST_ASSERT_EQUAL_UINT8(healthy | 2U, sample(NO_CURRENT, 50.0, theta_turn).hall_state);
        fault.hall_stuck_high = 7U;
        TEST_ASSERT_EQUAL_UINT8(7U, sample(NO_CURRENT, 50.0, theta_turn).hall_state);
    }
}

void test_each_sensor_shows_its_current_by_its_own_gain(void)
{
    const plant_abc_t current = {.a = 82.5, .b = -41.25, .c = -41.25}; /* 1 024, 512 codes */
    params.current_a_gain_error = 0.25;
    params.current_b_gain_error = -0.125;
    const sensors_sample_t seen = sample(current, 50.0, 0.0);
    TEST_ASSERT_EQUAL_UINT16(2048 + 1280, seen.phase_current_code[0]);
    TEST_ASSERT_EQUAL_UINT16(2048 - 448, seen.phase_current_code[1]);
    TEST_ASSERT_EQUAL_UINT16(2048 - 512, seen.phase_current_code[2]);
}

void test_the_bus_voltage_is_shown_by_the_gain_of_its_sensor(void)
{
    params.bus_gain_error = -0.25;
    TEST_ASSERT_EQUAL_UINT16(1536, sample(NO_CURRENT, 30.9, 0.0).bus_voltage_code);
}

void test_an_angle_sensor_mounted_askew_shows_its_offset_also_across_zero(void)
{
    params.angle_offset_deg = 22.5; /* 4 096 of 65 536 */
    TEST_ASSERT_EQUAL_UINT16(16384 + 4096, sample(NO_CURRENT, 50.0, 0.25).rotor_angle_turn);
    TEST_ASSERT_EQUAL_UINT16(2048, sample(NO_CURRENT, 50.0, 1.0 - 0.03125).rotor_angle_turn);
    params.angle_offset_deg = -22.5;
    TEST_ASSERT_EQUAL_UINT16(65536 - 4096, sample(NO_CURRENT, 50.0, 0.0).rotor_angle_turn);
}

void test_the_error_of_an_angle_sensor_goes_around_once_an_electrical_turn(void)
{
    params.angle_error_deg = 22.5;
    TEST_ASSERT_EQUAL_UINT16(0, sample(NO_CURRENT, 50.0, 0.0).rotor_angle_turn);
    TEST_ASSERT_EQUAL_UINT16(16384 + 4096, sample(NO_CURRENT, 50.0, 0.25).rotor_angle_turn);
    TEST_ASSERT_EQUAL_UINT16(32768, sample(NO_CURRENT, 50.0, 0.5).rotor_angle_turn);
    TEST_ASSERT_EQUAL_UINT16(49152 - 4096, sample(NO_CURRENT, 50.0, 0.75).rotor_angle_turn);
}

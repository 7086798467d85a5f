/* SPDX-License-Identifier: Apache-2.0 */
/* Selection of the configured rotor sensor, and its angle, speed and faults. */
#include <math.h>
#include <string.h>

#include "core/angle.h"
#include "rotor.h"
#include "tracker_config.h"
#include "unity.h"

static const encoder_input_t NO_ENCODER;
static config_t config;
static rotor_state_t rotor;

void setUp(void)
{
    config = tracker_config();
    rotor_init(&rotor, &config);
}

void tearDown(void) {}

static rotor_out_t out;

static rotor_out_t look(uint16_t angle_turn, uint8_t hall_state, const encoder_input_t *encoder)
{
    const foc_input_t in = {
        .rotor_angle_turn = angle_turn, .hall_state = hall_state, .encoder = *encoder};
    static const emf_observer_t NO_OBSERVER = {.acquisition_periods = 1};
    static const observer_tuning_t NO_LEAD;
    rotor_step(&rotor, &config, &in, &NO_OBSERVER, &NO_LEAD, &out);
    return out;
}

static rotor_out_t step(double turns)
{
    return look((uint16_t)((int64_t)floor(turns * 65536.0) & 0xFFFF), 0, &NO_ENCODER);
}

void test_first_angle_is_the_sensor_s_angle(void)
{
    const rotor_out_t seen = step(0.7);
    TEST_ASSERT_INT32_WITHIN(1, 0, angle_difference(seen.theta_turn, (uint16_t)(0.7 * 65536.0)));
    TEST_ASSERT_TRUE(seen.valid);
}

void test_hall_sensors_are_read_only_if_configured(void)
{
    config.rotor.sensor = CONFIG_ROTOR_HALL;
    for (int k = 0; k < 6; k++) {
        config.rotor.edge_turn[k] = (int32_t)lround(k * 65536.0 / 6.0);
    }
    rotor_init(&rotor, &config);
    const rotor_out_t seen = look(12345, 2, &NO_ENCODER); /* 010: sector 3, 180 to 240 degrees */
    TEST_ASSERT_INT32_WITHIN(2, (int32_t)lround(3.5 * 65536.0 / 6.0), seen.theta_turn);
    TEST_ASSERT_TRUE(seen.valid);
}

void test_an_encoder_is_read_only_if_configured(void)
{
    config.rotor.sensor = CONFIG_ROTOR_ENCODER;
    config.rotor.encoder_counts = 4096;
    config.rotor.encoder_index_turn = 20000;
    rotor_init(&rotor, &config);
    const encoder_input_t before_index = {.count = 690};
    TEST_ASSERT_FALSE(look(12345, 2, &before_index).valid);
    const encoder_input_t at_index = {.count = 700, .index_count = 700, .index = true};
    TEST_ASSERT_TRUE(look(12345, 2, &at_index).valid);
    const encoder_input_t later = {.count = 710};
    const rotor_out_t seen = look(12345, 2, &later);
    /* Ten counts of 23 * 65 536 / 4096 = 368 and half of the one it is in; the loop may lag one
     * count. */
    TEST_ASSERT_INT32_WITHIN(369, 20000 + 10 * 368 + 184, seen.theta_turn);
}

/* An encoder at constant speed, one count of 4096 a period, for 30 time constants of the loop, and
 * then a false index pulse. */
void test_encoder_speed_and_faults_are_reported(void)
{
    config.rotor.sensor = CONFIG_ROTOR_ENCODER;
    config.rotor.encoder_counts = 4096;
    config.rotor.encoder_index_tolerance_counts = 4;
    rotor_init(&rotor, &config);
    encoder_input_t in = {.index = true};
    (void)look(0, 0, &in);
    in.index = false;
    for (int n = 0; n < 2000; n++) {
        in.count++;
        (void)look(0, 0, &in);
    }
    const double turns = 1.0 / 4096.0 * config.motor.pole_pairs;
    TEST_ASSERT_DOUBLE_WITHIN(0.01 * turns, turns, out.speed_q32 / 4294967296.0);
    TEST_ASSERT_EQUAL_UINT16(0, out.faults);
    in.index = true; /* 2000 counts after the last one */
    in.index_count = in.count;
    (void)look(0, 0, &in);
    TEST_ASSERT_EQUAL_UINT16(1, out.faults);
    TEST_ASSERT_FALSE(out.valid);
}

/* A fiftieth of a turn a period, 400 turns a second, for 30 time constants of the loop. */
void test_absolute_angle_sensor_gives_a_speed_and_no_faults(void)
{
    for (int n = 0; n < 2000; n++) {
        (void)step(0.02 * n);
    }
    TEST_ASSERT_DOUBLE_WITHIN(2e-5, 0.02, out.speed_q32 / 4294967296.0);
    TEST_ASSERT_EQUAL_UINT16(0, out.faults);
}

void test_init_resets_the_hall_estimate(void)
{
    config.rotor.sensor = CONFIG_ROTOR_HALL;
    memset(&rotor, 0xA5, sizeof rotor);
    rotor_init(&rotor, &config);
    TEST_ASSERT_FALSE(rotor.hall.started);
    TEST_ASSERT_FALSE(look(0, 7, &NO_ENCODER).valid); /* an impossible state gives no angle */
    TEST_ASSERT_EQUAL_UINT16(0, out.faults);
}

/* A turn in 192 periods, a sector in 32, seen at an edge together with the observer's angle: once
 * by the rotor, once by its hall sensors alone. */
static void assert_observed(uint32_t periods, bool known)
{
    config.rotor.sensor = CONFIG_ROTOR_HALL;
    for (int k = 0; k < 6; k++) {
        config.rotor.edge_turn[k] = 10923 * k;
    }
    rotor_init(&rotor, &config);
    static const uint8_t FORWARD[6] = {5, 1, 3, 2, 6, 4};
    for (int n = 0; n < 10 * 32; n++) {
        (void)look(0, FORWARD[n / 32 % 6], &NO_ENCODER);
    }
    hall_t expected = rotor.hall;
    const uint8_t sensors = FORWARD[4];
    const foc_input_t in = {.hall_state = sensors};
    const emf_observer_t observer = {
        .theta_q32 = (44500U << 16) + 65535U, .periods = periods, .acquisition_periods = 66};
    const observer_tuning_t tuning = {.lead_turn = 900};
    rotor_step(&rotor, &config, &in, &observer, &tuning, &out);
    const hall_observed_t observed = {.theta_turn = 43600, .known = known};
    TEST_ASSERT_FALSE(hall_extrapolate(&expected, sensors));
    hall_process_event(&expected, &config, sensors, observed);
    TEST_ASSERT_EQUAL_HEX32(expected.theta_q32, rotor.hall.theta_q32);
    TEST_ASSERT_EQUAL_INT32(expected.speed_q32, rotor.hall.speed_q32);
    TEST_ASSERT_EQUAL_HEX32(expected.observer_lead_q32, rotor.hall.observer_lead_q32);
    TEST_ASSERT_EQUAL_INT(known, rotor.hall.observer_lead_q32 != 0);
    TEST_ASSERT_EQUAL_INT32(expected.speed_q32, out.speed_q32);
    TEST_ASSERT_EQUAL_UINT16(expected.theta_q32 >> 16, out.theta_turn);
}

void test_hall_edge_meets_the_observed_angle_less_its_lead_once_acquired(void)
{
    assert_observed(65, false);
    assert_observed(66, true);
    assert_observed(67, true);
}

void test_hall_faults_are_reported(void)
{
    config.rotor.sensor = CONFIG_ROTOR_HALL;
    rotor_init(&rotor, &config);
    (void)look(0, 5, &NO_ENCODER);
    TEST_ASSERT_EQUAL_UINT16(0, out.faults);
    const uint16_t theta_turn = out.theta_turn;
    TEST_ASSERT_TRUE(look(0, 3, &NO_ENCODER).valid); /* a skipped sector, or a disturbance */
    TEST_ASSERT_EQUAL_UINT16(0, out.faults);
    TEST_ASSERT_EQUAL_UINT16(theta_turn, out.theta_turn);
    (void)look(0, 3, &NO_ENCODER);
    TEST_ASSERT_EQUAL_UINT16(1, out.faults);
    TEST_ASSERT_FALSE(out.valid);
}

/* SPDX-License-Identifier: Apache-2.0 */
/* One temperature sensor beside the estimate of what it measures: broken, back again, stuck. */
#include "monitor/monitor.h"
#include "monitor/monitor_temperature.h"
#include "paper_vehicle.h"
#include "unity.h"

static config_t config;
static monitor_temperature_state_t state;
static monitor_temperature_input_t in;

void setUp(void)
{
    config = paper_vehicle();
    config.monitor.sensor_fault_time_ms = 20;
    config.monitor.highest_temperature_cC = 29000;
    config.monitor.lowest_temperature_cC = -6000;
    config.monitor.stuck_rise_cC = 1600;
    monitor_temperature_init(&state);
    const monitor_temperature_input_t healthy = {.measured_cC = 4000,
                                                 .estimate_cC = 4000,
                                                 .slowest_cC = 4000,
                                                 .estimated = true,
                                                 .limit_cC = 15000};
    in = healthy;
}

void tearDown(void) {}

static monitor_temperature_output_t run(int milliseconds)
{
    monitor_temperature_output_t out = {.broken = false};
    for (int n = 0; n < milliseconds; n++) {
        out = monitor_temperature_step(&state, &config, &in);
    }
    return out;
}

void test_a_good_sensor_is_used_as_it_is(void)
{
    in.estimate_cC = 5000;
    const monitor_temperature_output_t out = run(1);
    TEST_ASSERT_EQUAL_INT(4000, out.used_cC);
    TEST_ASSERT_FALSE(out.broken);
}

/* Without a thermal model there is nothing to compare with: a reading is used, however still. */
void test_without_an_estimate_a_sensor_is_neither_stuck_nor_corrected(void)
{
    in.estimated = false;
    run(1);
    in.slowest_cC = 4000 + 10 * config.monitor.stuck_rise_cC;
    in.estimate_cC = in.slowest_cC;
    const monitor_temperature_output_t out = run(5000);
    TEST_ASSERT_FALSE(out.broken);
    TEST_ASSERT_EQUAL_INT(4000, out.used_cC);
    TEST_ASSERT_EQUAL_INT32(0, state.offset_q16);
    in.measured_cC = INT32_MAX;
    TEST_ASSERT_EQUAL_INT(MONITOR_TEMPERATURE_BROKEN_cC, run(1).used_cC);
}

void test_open_and_short_are_replaced_at_once_and_named_after_the_qualify_time(void)
{
    static const int32_t BROKEN[] = {29999, 29001, -6001, INT32_MIN, INT32_MAX};
    for (int k = 0; k < 5; k++) {
        setUp();
        run(10);
        in.measured_cC = BROKEN[k];
        const monitor_temperature_output_t first = run(1);
        TEST_ASSERT_EQUAL_INT(4000, first.used_cC);
        TEST_ASSERT_FALSE(run(18).broken);
        TEST_ASSERT_TRUE(run(1).broken);
        in.estimate_cC = 9000; /* it goes on with the estimate */
        TEST_ASSERT_EQUAL_INT(9000, run(5000).used_cC);
        in.measured_cC = 9100;
        TEST_ASSERT_EQUAL_INT(9100, run(1).used_cC);
        TEST_ASSERT_TRUE(run(MONITOR_TEMPERATURE_HEAL_STEPS - 2).broken);
        TEST_ASSERT_FALSE(run(1).broken);
    }
}

void test_a_spike_is_not_named(void)
{
    in.measured_cC = 29999;
    TEST_ASSERT_FALSE(run(19).broken);
    in.measured_cC = 4000;
    TEST_ASSERT_FALSE(run(1).broken);
    in.measured_cC = 29999;
    TEST_ASSERT_FALSE(run(19).broken);
}

void test_the_ends_of_the_range_are_plausible(void)
{
    in.measured_cC = 29000;
    TEST_ASSERT_FALSE(run(100).broken);
    setUp();
    in.measured_cC = -6000;
    TEST_ASSERT_FALSE(run(100).broken);
}

void test_without_an_estimate_a_broken_sensor_leaves_no_torque(void)
{
    in.estimated = false;
    in.measured_cC = -20000;
    TEST_ASSERT_EQUAL_INT(MONITOR_TEMPERATURE_BROKEN_cC, run(1).used_cC);
    TEST_ASSERT_TRUE(run(30).broken);
}

void test_a_limit_that_is_switched_off_expects_no_sensor(void)
{
    in.limit_cC = MONITOR_TEMPERATURE_OFF_cC;
    in.measured_cC = 29999;
    TEST_ASSERT_FALSE(run(100).broken);
}

/* The estimate's error while the sensor was good is taken off afterwards: 1 - exp(-5) of 12 K
 * after five time constants of 2^14 ms, and of 60 K only 20 K. */
void test_the_estimate_goes_on_from_what_the_sensor_showed(void)
{
    in.estimate_cC = 5200;
    run(5 * 16384);
    in.measured_cC = 29999;
    TEST_ASSERT_INT_WITHIN(12, 4000, run(1).used_cC);
    setUp();
    in.measured_cC = 10000;
    run(6 * 16384);
    in.measured_cC = 29999;
    TEST_ASSERT_INT_WITHIN(8, 6000, run(1).used_cC);
}

/* The estimate rises by 16 K; a sensor that follows by more than a quarter of it is not stuck. */
void test_a_sensor_that_stays_while_the_winding_warms_is_stuck(void)
{
    run(1);
    in.slowest_cC = in.estimate_cC = 5600;
    TEST_ASSERT_FALSE(run(100).broken);
    in.slowest_cC = in.estimate_cC = 5601;
    TEST_ASSERT_TRUE(run(1).broken);
    TEST_ASSERT_EQUAL_INT(5601, run(1).used_cC);
    in.slowest_cC = in.estimate_cC = 8000;
    TEST_ASSERT_EQUAL_INT(8000, run(1).used_cC); /* the hotter of both */
    in.estimate_cC = 3000;
    TEST_ASSERT_EQUAL_INT(4000, run(1).used_cC);
    in.measured_cC = 4401; /* it moves again */
    TEST_ASSERT_EQUAL_INT(4401, run(1).used_cC);
    TEST_ASSERT_FALSE(run(MONITOR_TEMPERATURE_HEAL_STEPS).broken);
}

void test_a_sensor_that_stays_while_the_winding_cools_is_stuck(void)
{
    run(1);
    in.slowest_cC = in.estimate_cC = 2399;
    TEST_ASSERT_TRUE(run(1).broken);
}

void test_a_sensor_that_follows_a_fifth_late_is_never_stuck(void)
{
    for (int k = 0; k < 100; k++) {
        in.slowest_cC = in.estimate_cC = 4000 + 100 * k;
        in.measured_cC = 4000 + 30 * k; /* a model three times too hot */
        TEST_ASSERT_FALSE(run(1).broken);
    }
}

void test_the_check_can_be_switched_off(void)
{
    config.monitor.stuck_rise_cC = 0;
    run(1);
    in.slowest_cC = in.estimate_cC = 20000;
    TEST_ASSERT_FALSE(run(1000).broken);
}

/* ---- limits ---- */

/* A reading near zero is no movement from a state without one. */
void test_the_first_reading_begins_the_comparison(void)
{
    in.measured_cC = 100;
    in.estimate_cC = 5000;
    in.slowest_cC = 5000;
    TEST_ASSERT_FALSE(run(1).broken);
    TEST_ASSERT_EQUAL_INT32(100, state.kept_cC);
    TEST_ASSERT_EQUAL_INT32(5000, state.kept_estimate_cC);
}

/* A quarter of 16 K is no movement, a hundredth of a kelvin more is one, in either direction. */
void test_a_sensor_moves_by_more_than_a_quarter_of_the_rise(void)
{
    for (int sign = -1; sign <= 1; sign += 2) {
        setUp();
        run(1);
        in.measured_cC = 4000 + sign * 400;
        run(1);
        TEST_ASSERT_EQUAL_INT32(4000, state.kept_cC);
        in.measured_cC = 4000 + sign * 401;
        run(1);
        TEST_ASSERT_EQUAL_INT32(4000 + sign * 401, state.kept_cC);
    }
}

/* Of a hundredth of a kelvin: the least that can be configured; the correction is forgotten. */
void test_the_least_rise_makes_a_sensor_stuck(void)
{
    config.monitor.stuck_rise_cC = 1;
    run(1);
    state.offset_q16 = 65536;
    in.slowest_cC = 4001;
    TEST_ASSERT_FALSE(run(1).broken);
    in.slowest_cC = 4002;
    TEST_ASSERT_TRUE(run(1).broken);
    TEST_ASSERT_EQUAL_INT32(0, state.offset_q16);
}

/* 10 K in 2^14 steps: 1000 * 2^16 / 2^14 in the first. */
void test_the_estimate_is_corrected_over_2_to_14_steps(void)
{
    in.estimate_cC = 3000;
    run(1);
    TEST_ASSERT_EQUAL_INT32(4000, state.offset_q16);
}

void test_a_reading_outside_its_range_does_not_heal(void)
{
    run(1);
    in.measured_cC = 29999;
    TEST_ASSERT_TRUE(run(20).broken);
    in.measured_cC = 4000;
    run(MONITOR_TEMPERATURE_HEAL_STEPS - 1);
    in.measured_cC = 29999;
    TEST_ASSERT_TRUE(run(1).broken);
    TEST_ASSERT_EQUAL_UINT16(1, state.heal_steps);
    in.measured_cC = 4000;
    TEST_ASSERT_FALSE(run(1).broken);
}

/* SPDX-License-Identifier: Apache-2.0 */
/* Which temperatures the controller uses, with the thermal model of the paper's vehicle. */
#include "controller/temperatures.h"

#include "config/finding_times.h"
#include "paper_vehicle.h"
#include "unity.h"

static config_t config;
static temperatures_t state;
static slow_input_t in;
static wheel_temperatures_t *const shown = &in.temperature;
static findings_t findings;
static measured_t now;
static last_t last;
static fast_report_t report;

void setUp(void)
{
    config = paper_vehicle();
    config.monitor.highest_temperature_cC = 29000;
    config.monitor.lowest_temperature_cC = -6000;
    config.monitor.sensor_fault_time_ms = 20;
    temperatures_init(&state, &config);
    finding_times_t times[FINDING_COUNT];
    finding_times(&config, times);
    findings_init(&findings, times, false);
    const wheel_temperatures_t as_ambient = {.winding_cC = 2500, .switch_cC = 2500};
    in.temperature = as_ambient;
    now.in = &in;
    now.report = &report;
    report.bridge = BRIDGE_OFF;
    last.current_missing_q15 = 0;
}

void tearDown(void) {}

static void run(int milliseconds, int32_t i_q_mA)
{
    now.i_q_mA = i_q_mA;
    now.speed_mrad_s = 20000;
    for (int n = 0; n < milliseconds; n++) {
        temperatures_step(&state, &config, &last, &now, &findings);
        last.temperature.winding_cC = now.winding_temperature_cC;
    }
}

/* For the limit. */
static int32_t hot_cC(void)
{
    return now.winding_temperature_cC + now.winding_hotter_cC;
}

static reason_t warning(void)
{
    return findings_reason(&findings, findings_warning(&findings));
}

void test_a_sensor_hotter_than_the_model_is_used(void)
{
    run(1, 0);
    shown->winding_cC = 14321;
    shown->switch_cC = 13210;
    run(1, 0);
    TEST_ASSERT_EQUAL_INT(14321, now.winding_temperature_cC);
    TEST_ASSERT_EQUAL_INT(13210, now.switch_temperature_cC);
    TEST_ASSERT_EQUAL_INT(14321, now.sensed.winding_cC);
    TEST_ASSERT_EQUAL_INT(13210, now.sensed.switch_cC);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, warning());
}

/* 3/2 0.031 ohm (60 A)^2 = 167 W into 580 J/K for 10 s: 2.9 K, less what flows into the housing.
 * One that never moves takes 5 K of it in the end, 1 - exp(-10/16.4) of that after 10 s. */
void test_a_sensor_that_stays_behind_leaves_the_temperature_to_the_model(void)
{
    run(10000, 60000);
    TEST_ASSERT_INT_WITHIN(5, 2500, now.sensed.winding_cC);
    const int32_t model_cC = thermal_model_inner_cC(&state.model.winding);
    TEST_ASSERT_INT_WITHIN(20, 2500 + 285, model_cC);
    TEST_ASSERT_EQUAL_INT(2500, now.winding_temperature_cC); /* of resistance and magnets */
    TEST_ASSERT_TRUE(hot_cC() > 2500);
    TEST_ASSERT_TRUE(hot_cC() <= model_cC);
    run(60000, 75000);
    const int32_t later_cC = thermal_model_inner_cC(&state.model.winding);
    TEST_ASSERT_INT_WITHIN(20, later_cC - 500, hot_cC());
    TEST_ASSERT_EQUAL_INT(2500, now.sensed.winding_cC);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, warning());
}

/* 1 - exp(-6) of 20 K after six time constants of 2^14 ms, however hot the sensor is; 20 rad/s warm
 * the iron a little. */
void test_a_hotter_sensor_corrects_the_model_by_at_most_20_kelvin(void)
{
    run(1, 0);
    shown->winding_cC = 10000;
    run(6 * 16384, 0);
    shown->winding_cC = 29999;
    run(1, 0);
    TEST_ASSERT_INT_WITHIN(20, 2500 + 2000, now.winding_temperature_cC);
}

void test_a_reading_beyond_its_range_is_replaced_at_once_and_named_after_the_qualify_time(void)
{
    static const int32_t BROKEN_cC[] = {29999, 29001, -6001, -100000, 100000};
    for (int k = 0; k < 5; k++) {
        setUp();
        run(10, 0);
        shown->winding_cC = BROKEN_cC[k];
        run(1, 0);
        TEST_ASSERT_INT_WITHIN(5, 2500, now.winding_temperature_cC);
        TEST_ASSERT_EQUAL_INT(TEMPERATURE_NONE_cC, now.sensed.winding_cC);
        run(18, 0);
        TEST_ASSERT_EQUAL_INT(REASON_NONE, warning());
        run(1, 0);
        TEST_ASSERT_EQUAL_INT(REASON_WINDING_SENSOR, warning());
        shown->winding_cC = 29000;
        run(999, 0);
        TEST_ASSERT_EQUAL_INT(29000, now.winding_temperature_cC);
        TEST_ASSERT_EQUAL_INT(REASON_WINDING_SENSOR, warning());
        run(1, 0);
        TEST_ASSERT_EQUAL_INT(REASON_NONE, warning());
    }
}

void test_each_sensor_has_its_own_finding(void)
{
    shown->switch_cC = -20000;
    run(10000, 60000);
    TEST_ASSERT_EQUAL_INT(REASON_SWITCH_SENSOR, warning());
    TEST_ASSERT_TRUE(now.switch_temperature_cC > 2700 && now.switch_temperature_cC < 5000);
    TEST_ASSERT_EQUAL_INT(TEMPERATURE_NONE_cC, now.sensed.switch_cC);
    TEST_ASSERT_EQUAL_INT(2500, now.sensed.winding_cC);
}

void test_the_ends_of_the_range_are_plausible(void)
{
    shown->winding_cC = 29000;
    shown->switch_cC = -6000;
    run(100, 0);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, warning());
}

void test_without_a_model_the_sensor_is_used_as_it_is_and_a_broken_one_leaves_no_torque(void)
{
    config.thermal.winding_heat_capacity_mJ_K = 0;
    temperatures_init(&state, &config);
    run(10000, 75000);
    TEST_ASSERT_EQUAL_INT(2500, now.winding_temperature_cC);
    shown->winding_cC = 29001;
    run(1, 0);
    TEST_ASSERT_EQUAL_INT(TEMPERATURES_BROKEN_cC, hot_cC());
    TEST_ASSERT_EQUAL_INT(TEMPERATURES_BROKEN_cC, now.sensed.winding_cC);
    TEST_ASSERT_EQUAL_INT(2500, now.winding_temperature_cC); /* of the magnets: as it was */
}

/* 20 K/s from one reading to the next, whatever it is; the limit follows at once. */
void test_resistance_and_magnets_change_no_faster_than_a_winding_while_there_is_pwm(void)
{
    static const int32_t READING_cC[] = {20000, -5000, 29999, -20000};
    for (int k = 0; k < 4; k++) {
        setUp();
        run(10, 0);
        report.bridge = BRIDGE_PWM;
        shown->winding_cC = READING_cC[k];
        int32_t before_cC = now.winding_temperature_cC;
        for (int n = 0; n < 2000; n++) {
            run(1, 0);
            TEST_ASSERT_INT_WITHIN(2, before_cC, now.winding_temperature_cC);
            before_cC = now.winding_temperature_cC;
            TEST_ASSERT_TRUE(hot_cC() >= now.sensed.winding_cC);
        }
        const int32_t expected_cC = k == 0 ? 2500 + 2 * 2000 : k == 1 ? 2500 - 2 * 2000 : 2500;
        TEST_ASSERT_INT_WITHIN(20, expected_cC, now.winding_temperature_cC);
    }
}

void test_without_a_sensor_the_model_stands_alone(void)
{
    config.monitor.winding_sensor_fitted = 0;
    config.monitor.switch_sensor_fitted = 0;
    shown->winding_cC = 12000; /* whatever the open input shows */
    shown->switch_cC = 29999;
    run(10000, 60000);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, warning());
    TEST_ASSERT_INT_WITHIN(20, config.monitor.warmest_ambient_cC + 285, now.winding_temperature_cC);
    TEST_ASSERT_EQUAL_INT(TEMPERATURE_NONE_cC, now.sensed.winding_cC);
    TEST_ASSERT_EQUAL_INT(TEMPERATURE_NONE_cC, now.sensed.switch_cC);
}

void test_a_limit_that_is_off_expects_no_sensor(void)
{
    config.drive.max_switch_temperature_cC = CONFIG_TEMPERATURE_OFF_cC;
    config.thermal.switch_heat_capacity_mJ_K = 0;
    temperatures_init(&state, &config);
    shown->switch_cC = 29999;
    run(100, 0);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, warning());
    TEST_ASSERT_EQUAL_INT(config.motor.reference_temperature_cC, now.switch_temperature_cC);
}

/* The warmest of both sensors and of what was known before a reset. */
void test_the_model_starts_warm(void)
{
    shown->winding_cC = 3000;
    shown->switch_cC = 7000;
    run(1, 0);
    TEST_ASSERT_INT_WITHIN(2, 7000, hot_cC());
    setUp();
    state.kept_cC = 9000;
    run(1, 0);
    TEST_ASSERT_INT_WITHIN(2, 9000, hot_cC());
    TEST_ASSERT_INT_WITHIN(2, 9000, now.switch_temperature_cC);
    setUp();
    shown->winding_cC = 29999; /* a broken one says nothing */
    shown->switch_cC = 3000;
    run(1, 0);
    TEST_ASSERT_INT_WITHIN(2, 3000, now.winding_temperature_cC);
}

/* Of 0.8 of the current: 60 A of 75, whose heat is 1.56 times that. */
void test_current_that_the_sensors_do_not_show_heats_as_well(void)
{
    shown->winding_cC = 29999;
    shown->switch_cC = -20000;
    run(10000, 75000);
    const int32_t winding_cC = now.winding_temperature_cC;
    const int32_t switch_cC = now.switch_temperature_cC;
    setUp();
    last.current_missing_q15 = 6554; /* 0.2 */
    shown->winding_cC = 29999;
    shown->switch_cC = -20000;
    run(10000, 60000);
    TEST_ASSERT_INT_WITHIN(2, winding_cC, now.winding_temperature_cC);
    TEST_ASSERT_INT_WITHIN(2, switch_cC, now.switch_temperature_cC);
    TEST_ASSERT_TRUE(winding_cC > config.monitor.warmest_ambient_cC + 400);
}

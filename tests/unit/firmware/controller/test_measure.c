/* SPDX-License-Identifier: Apache-2.0 */
/* What each field of measured_t is, from a report whose values are given. */
#include "controller/measure.h"

#include <math.h>
#include <string.h>

#include "config/bases.h"
#include "config/finding_times.h"
#include "core/fault.h"
#include "core/q15.h"
#include "foc/foc.h"
#include "foc/observer_design.h"
#include "paper_vehicle.h"
#include "unity.h"

#define PI 3.14159265358979323846

enum { PERIODS = 20, NAME_ms = 10, PSI_nWb = 20400000, L_nH = 76000 };

static config_t config;
static measure_t state;
static fast_report_t report;
static slow_input_t in;
static last_t last;
static findings_t findings;
static measured_t now;

/* Bases of 32 768 mA and mV: one LSB is one mA or mV. At standstill, the bridge switches. */
void setUp(void)
{
    config = paper_vehicle();
    config.drive.current_full_scale_mA = 32768;
    config.drive.voltage_full_scale_mV = 32768;
    config.rotor.observer_takeover = 1;
    config.rotor.observer_speed_mrad_s = 5000;
    config.motor.flux_linkage_nWb = PSI_nWb;
    config.motor.d_inductance_nH = L_nH;
    config.motor.q_inductance_nH = L_nH;
    memset(&report, 0, sizeof report);
    report.sensor_valid = true;
    report.bridge = BRIDGE_PWM;
    memset(&in, 0, sizeof in);
    in.temperature.winding_cC = 2500;
    in.temperature.switch_cC = 2500;
    memset(&last, 0, sizeof last);
    last.temperature.winding_cC = 2500;
    finding_times_t times[FINDING_COUNT];
    finding_times(&config, times);
    findings_init(&findings, times, false);
    measure_init(&state, &config, BASES_MODEL_TIMER_Hz);
}

void tearDown(void) {}

/* A millisecond whose periods all have these values: current and power, mA; bus voltage, mV. */
static void step_with(int32_t d, int32_t q, int32_t power, int32_t v_dc)
{
    const dq_t i_pu = {.d = d, .q = q};
    report.sums.i_d_pu += PERIODS * (uint32_t)d;
    report.sums.i_q_pu += PERIODS * (uint32_t)q;
    report.sums.power_pu += PERIODS * (uint32_t)power;
    report.sums.v_dc_pu += PERIODS * (uint32_t)v_dc;
    report.sequence = (uint16_t)(report.sequence + PERIODS);
    report.i_pu = dq16_of(i_pu);
    now = measure_step(&state, &config, &report, &in, &last, &findings);
}

static void step(void)
{
    step_with(0, 0, 0, 25000);
}

static int32_t speed_q32(double turns_per_period)
{
    return (int32_t)lround(turns_per_period * 4294967296.0);
}

/* ---- what is only passed on ---- */

void test_the_raw_report_and_the_battery_s_values_stand_beside_what_is_derived(void)
{
    step();
    TEST_ASSERT_EQUAL_PTR(&report, now.report);
    TEST_ASSERT_EQUAL_PTR(&in, now.in);
    TEST_ASSERT_EQUAL_PTR(&in.bms, now.battery);
}

/* What the fast loop may latch can be acknowledged; the bus sensor heals. Any other number is a
 * damaged word. */
void test_a_trip_that_the_fast_loop_does_not_give_is_a_damaged_memory(void)
{
    int given = 0;
    for (int code = 0; code < 256; code++) {
        report.trip = (reason_t)code;
        step();
        const bool is_given = code == REASON_NONE || code == REASON_BUS_SENSOR ||
                              fault_clearing((reason_t)code) == FAULT_CLEARING_ACKNOWLEDGED;
        TEST_ASSERT_EQUAL_INT(is_given ? code : REASON_MEMORY, now.trip);
        given += is_given ? 1 : 0;
    }
    TEST_ASSERT_GREATER_THAN_INT(10, given);
}

/* ---- means ---- */

void test_mean_currents_are_those_of_the_samples_at_standstill(void)
{
    step_with(-1234, 5678, 0, 25000);
    TEST_ASSERT_EQUAL_INT32(-1234, now.i_d_mA);
    TEST_ASSERT_EQUAL_INT32(5678, now.i_q_mA);
    TEST_ASSERT_EQUAL_INT32(-1234, now.sampled_pu.d);
    TEST_ASSERT_EQUAL_INT32(5678, now.sampled_pu.q);
    TEST_ASSERT_EQUAL_INT32(25000, now.bus_voltage_mV);
}

/* i_mean = (i_sampled - g (psi/L, 0))/(1 + g), g = (w T)^2/12, with the magnets at the temperature
 * of the step before; the samples themselves are not corrected, nor are they in the latest current.
 * psi/L is 1.63 current bases. */
void test_mean_currents_at_speed_are_less_by_the_sampling_correction(void)
{
    const double psi_over_l = 0.0204 / 76e-6 / 165.0;
    config.motor.flux_coefficient_ppm_K = -1100;
    for (int32_t warmer_K = 0; warmer_K <= 100; warmer_K += 100) {
        for (double turn = -0.05; turn < 0.06; turn += 0.1) {
            measure_init(&state, &config, BASES_MODEL_TIMER_Hz);
            memset(&report.sums, 0, sizeof report.sums);
            report.sequence = 0;
            report.speed_q32 = speed_q32(turn);
            last.temperature.winding_cC = 2500 + 100 * warmer_K;
            step_with(-3000, 9000, 0, 25000);
            const double g = 4.0 * PI * PI * turn * turn / 12.0;
            const double magnets_mA = 32768.0 * psi_over_l * (1.0 - 1100e-6 * warmer_K);
            TEST_ASSERT_DOUBLE_WITHIN(2.0, (-3000.0 - g * magnets_mA) / (1.0 + g), now.i_d_mA);
            TEST_ASSERT_DOUBLE_WITHIN(2.0, 9000.0 / (1.0 + g), now.i_q_mA);
            TEST_ASSERT_EQUAL_INT32(-3000, now.sampled_pu.d);
            TEST_ASSERT_EQUAL_INT32(9000, now.sampled_pu.q);
            TEST_ASSERT_EQUAL_INT32(-3000, now.latest_i_d_mA);
            TEST_ASSERT_EQUAL_INT32(9000, now.latest_i_q_mA);
        }
    }
}

/* P = 3/2 (u_d i_d + u_q i_q), u as shares of the voltage circle, m v_dc/sqrt 3. */
void test_bus_current_is_the_power_of_the_phases_over_the_bus_voltage(void)
{
    const double m = foc_modulation_limit_q15(&config, BASES_MODEL_TIMER_Hz) / 32768.0;
    const double power_mA = 0.3 * 4000.0 + 0.6 * 10000.0;
    step_with(4000, 10000, (int32_t)power_mA, 25000);
    TEST_ASSERT_DOUBLE_WITHIN(3.0, 1.5 / sqrt(3.0) * m * power_mA, now.bus_current_mA);
}

/* ---- the latest period ---- */

void test_latest_values_are_those_of_the_latest_period(void)
{
    const dq_t u = {.d = -16384, .q = 8192};
    report.u_pu = dq16_of(u);
    step_with(-1000, 2000, 0, 24000);
    const double circle_mV =
        foc_modulation_limit_q15(&config, BASES_MODEL_TIMER_Hz) / 32768.0 * 24000.0 / sqrt(3.0);
    TEST_ASSERT_EQUAL_INT32(-1000, now.latest_i_d_mA);
    TEST_ASSERT_EQUAL_INT32(2000, now.latest_i_q_mA);
    TEST_ASSERT_DOUBLE_WITHIN(1.5, -0.5 * circle_mV, now.latest_u_d_mV);
    TEST_ASSERT_DOUBLE_WITHIN(1.5, 0.25 * circle_mV, now.latest_u_q_mV);
}

/* Both change by less than the sampled current and the commanded voltage: 1/(1 + g), 1 - g/2. */
void test_weakening_current_and_phase_voltage_are_means(void)
{
    config.current_loop.modulation_target_pu_q15 = 30000;
    config.current_loop.modulation_reserve_pu_q15 = 1000;
    for (double turn = 0.0; turn < 0.06; turn += 0.05) {
        const double g = 4.0 * PI * PI * turn * turn / 12.0;
        report.speed_q32 = speed_q32(turn);
        report.i_d_weakening_pu = -6000;
        step();
        const double circle_mV =
            foc_modulation_limit_q15(&config, BASES_MODEL_TIMER_Hz) / 32768.0 * 25000.0 / sqrt(3.0);
        TEST_ASSERT_DOUBLE_WITHIN(2.0, -6000.0 / (1.0 + g), now.i_d_weakening_mA);
        TEST_ASSERT_DOUBLE_WITHIN(3.0, 29000.0 / 32768.0 * circle_mV * (1.0 - 0.5 * g),
                                  now.phase_voltage_mV);
    }
}

/* ---- the rotor ---- */

static double wheel_mrad_s(double turns_per_period)
{
    return 2e3 * PI * turns_per_period * config.drive.pwm_frequency_Hz / config.motor.pole_pairs;
}

static void assert_speed(double turns_per_period)
{
    TEST_ASSERT_DOUBLE_WITHIN(2.0, wheel_mrad_s(turns_per_period), now.speed_mrad_s);
}

/* What a healthy observer shows at this speed, of a sensor that is `apart` of a turn ahead of it:
 * the flux of a leaking integrator, x (e - 1 + leak) = psi (e - 1), e the turn of a period. */
static void observe(double turns_per_period, double apart)
{
    const double full_scale_wb = 1e-9 * (2.0 * PSI_nWb + 1.25 * L_nH * 32.768);
    const double leak = observer_design_leak_q24(&config) / 16777216.0;
    const double w = 2.0 * PI * turns_per_period;
    const double re = cos(w) - 1.0;
    const double im = sin(w);
    const double lead_turn = (atan2(im, re) - atan2(im, re + leak)) / (2.0 * PI);
    const double share = hypot(re, im) / hypot(re + leak, im);
    const dq_t flux_q14 = {.d = (int32_t)lround(16384.0 * PSI_nWb * 1e-9 / full_scale_wb * share)};
    report.observer.speed_q32 = speed_q32(turns_per_period);
    report.observer.theta_turn = 10000;
    report.observer.flux_q14 = dq16_of(flux_q14);
    report.observer.sensor_turn =
        (uint16_t)(int32_t)lround(10000.0 + (apart - lead_turn) * 65536.0);
    report.observer.acquired = true;
}

static void run(int milliseconds)
{
    for (int ms = 0; ms < milliseconds; ms++) {
        step();
    }
}

void test_the_sensor_s_angle_and_speed_are_used_while_it_is_right(void)
{
    for (double turn = -0.02; turn < 0.03; turn += 0.04) {
        setUp();
        report.speed_q32 = speed_q32(turn);
        observe(turn * 1.01, 0.01);
        run(20);
        TEST_ASSERT_TRUE(now.angle_valid);
        TEST_ASSERT_EQUAL_INT(ANGLE_BY_SENSOR, now.angle_by);
        TEST_ASSERT_FALSE(now.sensor_wrong);
        assert_speed(turn);
        TEST_ASSERT_EQUAL_INT(FINDING_COUNT, findings_warning(&findings));
    }
}

void test_an_invalid_sensor_without_an_observer_is_no_angle(void)
{
    report.sensor_valid = false;
    step();
    TEST_ASSERT_FALSE(now.angle_valid);
    TEST_ASSERT_EQUAL_INT(ANGLE_BY_SENSOR, now.angle_by);
    TEST_ASSERT_FALSE(now.sensor_wrong);
}

/* An observer in use for 200 ms is a warning while the bridge switches: coasting needs no angle. */
void test_the_observer_s_speed_is_used_with_its_angle(void)
{
    const double turn = 0.02;
    report.speed_q32 = speed_q32(turn);
    observe(turn * 1.1, 0.0);
    run(20);
    report.sensor_valid = false;
    report.speed_q32 = 0;
    step();
    TEST_ASSERT_TRUE(now.angle_valid);
    TEST_ASSERT_TRUE(now.rotor_observed);
    TEST_ASSERT_EQUAL_INT(ANGLE_BY_OBSERVER, now.angle_by);
    TEST_ASSERT_FALSE(now.sensor_wrong);
    assert_speed(turn * 1.1);
    run(198);
    TEST_ASSERT_FALSE(findings_present(&findings, FINDING_OBSERVER_IN_USE));
    step();
    TEST_ASSERT_TRUE(findings_present(&findings, FINDING_OBSERVER_IN_USE));
    report.bridge = BRIDGE_OFF;
    step();
    TEST_ASSERT_EQUAL_INT(ANGLE_BY_OBSERVER, now.angle_by);
    TEST_ASSERT_FALSE(findings_present(&findings, FINDING_OBSERVER_IN_USE));
}

/* Half a turn off, and a speed of its own; two steps make it wrong. */
static void contradict(double sensor_turn, double observer_turn)
{
    report.speed_q32 = speed_q32(observer_turn);
    observe(observer_turn, 0.0);
    run(20);
    observe(observer_turn, 0.5);
    report.speed_q32 = speed_q32(sensor_turn);
    run(2);
}

/* As a cause it counts from the first step on, under its name only later. */
void test_a_wrong_sensor_is_suspected_at_once_and_then_found_under_its_name(void)
{
    static const struct {
        double sensor_turn;
        finding_t row;
        reason_t reason;
    } CASES[] = {{0.02, FINDING_ROTOR_SLIPS, REASON_ROTOR_SLIPPED},
                 {0.0, FINDING_ROTOR_FREEZES, REASON_ROTOR_FROZEN},
                 {-0.02, FINDING_ROTOR_REVERSES, REASON_ROTOR_REVERSED}};
    for (int k = 0; k < 3; k++) {
        setUp();
        contradict(CASES[k].sensor_turn, 0.02);
        TEST_ASSERT_TRUE(now.sensor_wrong && now.angle_valid);
        TEST_ASSERT_EQUAL_INT(ANGLE_BY_OBSERVER, now.angle_by);
        TEST_ASSERT_TRUE(findings_suspected(&findings, FINDING_ROTOR_UNNAMED));
        TEST_ASSERT_EQUAL_INT(FINDING_COUNT, findings_warning(&findings));
        run(NAME_ms);
        TEST_ASSERT_EQUAL_INT(CASES[k].row, findings_warning(&findings));
        TEST_ASSERT_EQUAL_INT(CASES[k].reason,
                              findings_reason(&findings, findings_warning(&findings)));
    }
}

/* In a wheel that locks it was the observer that was wrong. */
void test_a_sensor_whose_observer_is_gone_is_found_without_a_name(void)
{
    contradict(0.02, 0.02);
    memset(&report.observer.flux_q14, 0, sizeof report.observer.flux_q14);
    run(NAME_ms);
    TEST_ASSERT_TRUE(now.sensor_wrong);
    TEST_ASSERT_FALSE(now.angle_valid);
    TEST_ASSERT_TRUE(findings_present(&findings, FINDING_ROTOR_UNNAMED));
}

void test_an_acknowledgement_at_rest_makes_a_wrong_sensor_right(void)
{
    for (int k = 0; k < 4; k++) {
        setUp();
        contradict(0.02, 0.02);
        report.bridge = BRIDGE_OFF;
        report.observer.acquired = false;
        in.demand.fault_reset = k % 2 != 0;
        last.at_rest = k / 2 != 0;
        step();
        TEST_ASSERT_EQUAL(k != 3, now.sensor_wrong);
        TEST_ASSERT_EQUAL(k == 3, !findings_suspected(&findings, FINDING_ROTOR_UNNAMED));
    }
}

/* ---- temperatures ---- */

void test_the_hotter_of_sensor_and_model_is_used(void)
{
    report.bridge = BRIDGE_OFF;
    in.temperature.winding_cC = 4321;
    in.temperature.switch_cC = 3210;
    run(100);
    TEST_ASSERT_EQUAL_INT32(4321, now.winding_temperature_cC);
    TEST_ASSERT_INT32_WITHIN(20, 4321, now.switch_temperature_cC); /* as the winding at start */
    TEST_ASSERT_EQUAL_INT32(3210, now.sensed.switch_cC);
}

void test_a_broken_temperature_sensor_is_a_finding(void)
{
    run(100);
    in.temperature.winding_cC = 29999;
    run(config.monitor.sensor_fault_time_ms);
    TEST_ASSERT_TRUE(findings_present(&findings, FINDING_WINDING_THERMISTOR));
    TEST_ASSERT_FALSE(findings_present(&findings, FINDING_SWITCH_THERMISTOR));
}

/* ---- the setpoint ---- */

/* Samples that are held at the reference have the mean that was wanted, at any speed. */
void test_the_reference_of_a_mean_current_is_measured_as_that_mean(void)
{
    for (double turn = -0.06; turn < 0.07; turn += 0.03) {
        setUp();
        report.speed_q32 = speed_q32(turn);
        step();
        fast_setpoint_t setpoint;
        measure_setpoint(&state, &config, -2000, 9000, &setpoint);
        step_with(setpoint.i_reference_pu.d, setpoint.i_reference_pu.q, 0, 25000);
        TEST_ASSERT_INT32_WITHIN(2, -2000, now.i_d_mA);
        TEST_ASSERT_INT32_WITHIN(2, 9000, now.i_q_mA);
    }
}

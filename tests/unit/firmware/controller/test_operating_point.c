/* SPDX-License-Identifier: Apache-2.0 */
/* The translation between the loops: means in SI upwards, samples per unit downwards. */
#include "config/bases.h"
#include "controller/operating_point.h"

#include <math.h>
#include <string.h>

#include "core/q15.h"
#include "paper_vehicle.h"
#include "unity.h"

enum { TEMPERATURE_cC = 2500 };

static config_t config;
static operating_point_state_t state;
static fast_report_t report;

/* Bases of 32 768 mA and mV: one LSB is one mA or mV, so that the conversion hides no rounding. */
void setUp(void)
{
    config = paper_vehicle();
    config.drive.current_full_scale_mA = 32768;
    config.drive.voltage_full_scale_mV = 32768;
    config.battery.min_voltage_mV = 10000;
    config.battery.max_voltage_mV = 20000;
    memset(&report, 0, sizeof(report));
    operating_point_init(&state, &config, BASES_MODEL_TIMER_Hz);
}

void tearDown(void) {}

static measured_t step(void)
{
    measured_t out = {.report = &report};
    const rotor_view_t rotor = operating_point_rotor(&state, &config, &report);
    const rotor_speed_t speed = {.turn_q32 = report.speed_q32, .wheel_mrad_s = rotor.sensor_mrad_s};
    operating_point_of(&state, &config, speed, TEMPERATURE_cC, &out);
    return out;
}

/* One PWM period with these values. */
static void add(int32_t d, int32_t q, int32_t power, int32_t v_dc)
{
    report.sums.i_d_pu += (uint32_t)d;
    report.sums.i_q_pu += (uint32_t)q;
    report.sums.power_pu += (uint32_t)power;
    report.sums.v_dc_pu += (uint32_t)v_dc;
    report.sequence++;
}

/* ---- means ---- */

void test_initial_bus_voltage_is_the_batterys_middle_and_initial_current_zero(void)
{
    const measured_t at = step();
    TEST_ASSERT_EQUAL_INT32(15000, at.bus_voltage_mV);
    TEST_ASSERT_EQUAL_INT32(0, at.i_q_mA);
    TEST_ASSERT_EQUAL_INT32(0, at.bus_current_mA);
}

void test_each_step_averages_the_periods_since_the_step_before(void)
{
    for (int window = 0; window < 4; window++) {
        int32_t sum = 0;
        for (int n = 0; n < 20; n++) {
            add(-100 * window, 7 * n - 50 * window, 3000 * window, 28000 + n);
            sum += 7 * n - 50 * window;
        }
        const measured_t at = step();
        TEST_ASSERT_EQUAL_INT32(-100 * window, at.i_d_mA);
        TEST_ASSERT_EQUAL_INT32(sum / 20, at.i_q_mA);
        TEST_ASSERT_EQUAL_INT32(28009, at.bus_voltage_mV); /* 28000 + 9.5, towards zero */
    }
}

void test_without_a_new_period_the_means_stay(void)
{
    add(-300, 400, 500, 28000);
    (void)step();
    const measured_t at = step();
    TEST_ASSERT_EQUAL_INT32(-300, at.i_d_mA);
    TEST_ASSERT_EQUAL_INT32(28000, at.bus_voltage_mV);
}

void test_sums_and_sequence_may_wrap_in_either_direction(void)
{
    for (int sign = -1; sign <= 1; sign += 2) {
        setUp();
        /* 200 000 periods: the sums wrap twice, the sequence three times. */
        for (int window = 0; window < 10000; window++) {
            for (int n = 0; n < 20; n++) {
                add(sign * 50000, -sign * 50000, sign * 40000, 32760);
            }
            const measured_t at = step();
            TEST_ASSERT_EQUAL_INT32(sign * 50000, at.i_d_mA);
            TEST_ASSERT_EQUAL_INT32(-sign * 50000, at.i_q_mA);
            TEST_ASSERT_EQUAL_INT32(32760, at.bus_voltage_mV);
        }
    }
}

void test_the_largest_values_over_the_most_periods_do_not_overflow(void)
{
    for (int32_t n = 0; n < 40000; n++) {
        add(-50200, 50200, -50200, 32760);
    }
    const measured_t at = step();
    TEST_ASSERT_EQUAL_INT32(-50200, at.i_d_mA);
    TEST_ASSERT_EQUAL_INT32(50200, at.i_q_mA);
}

/* ---- upwards ---- */

void test_bus_current_is_the_phases_power_over_the_bus_voltage(void)
{
    /* 3/2 (u_d i_d + u_q i_q) over the bus voltage, u in volts of the circle. */
    const double u_d = -0.3, u_q = 0.6, i_d_A = -4.0, i_q_A = 10.0, bus_V = 25.0;
    const double circle_V = state.modulation_limit_q15 / 32768.0 * bus_V / sqrt(3.0);
    add(-4000, 10000, (int32_t)lround(u_d * -4000.0 + u_q * 10000.0), 25000);
    const double expected_A = 1.5 * circle_V * (u_d * i_d_A + u_q * i_q_A) / bus_V;
    TEST_ASSERT_DOUBLE_WITHIN(3.0, 1e3 * expected_A, step().bus_current_mA);
}

void test_latest_voltage_and_current_are_those_of_the_latest_period(void)
{
    const dq_t i = {.d = -1234, .q = 5678};
    const dq_t u = {.d = -16384, .q = 8192};
    add(9000, 9000, 0, 25000);
    report.i_pu = dq16_of(i);
    report.u_pu = dq16_of(u);
    const measured_t at = step();
    const double circle_mV = state.modulation_limit_q15 / 32768.0 * 25000.0 / sqrt(3.0);
    TEST_ASSERT_EQUAL_INT32(-1234, at.latest_i_d_mA);
    TEST_ASSERT_EQUAL_INT32(5678, at.latest_i_q_mA);
    TEST_ASSERT_DOUBLE_WITHIN(1.5, -0.5 * circle_mV, at.latest_u_d_mV);
    TEST_ASSERT_DOUBLE_WITHIN(1.5, 0.25 * circle_mV, at.latest_u_q_mV);
}

void test_phase_voltage_keeps_a_reserve_below_the_field_weakening(void)
{
    config.current_loop.modulation_target_pu_q15 = 30000;
    config.current_loop.modulation_reserve_pu_q15 = 1000;
    add(0, 0, 0, 25000);
    const double circle_mV = state.modulation_limit_q15 / 32768.0 * 25000.0 / sqrt(3.0);
    TEST_ASSERT_DOUBLE_WITHIN(2.0, 29000.0 / 32768.0 * circle_mV, step().phase_voltage_mV);
}

/* ---- there and back ---- */

static const double TURNS[] = {0.0, 0.002, 0.01, 0.0123, -0.03, 0.06};

/* The fast loop holds its samples at the reference plus the field-weakening current: the mean is
 * then the setpoint plus the mean weakening current, whatever the speed. */
void test_a_setpoint_is_reported_as_mean_current_with_the_weakening_share_once(void)
{
    for (int n = 0; n < 6; n++) {
        for (int32_t weakening = -6000; weakening <= 0; weakening += 3000) {
            setUp();
            report.speed_q32 = (int32_t)lround(TURNS[n] * 4294967296.0);
            report.i_d_weakening_pu = weakening;
            add(0, 0, 0, 25000);
            (void)step();
            fast_setpoint_t setpoint;
            operating_point_setpoint(&state, &config, -2000, 9000, &setpoint);
            for (int k = 0; k < 20; k++) {
                add(setpoint.i_reference_pu.d + weakening, setpoint.i_reference_pu.q, 0, 25000);
            }
            const measured_t at = step();
            TEST_ASSERT_INT32_WITHIN(2, -2000 + at.i_d_weakening_mA, at.i_d_mA);
            TEST_ASSERT_INT32_WITHIN(2, 9000, at.i_q_mA);
        }
    }
}

void test_the_reference_does_not_depend_on_the_weakening_current(void)
{
    fast_setpoint_t without;
    fast_setpoint_t with;
    report.speed_q32 = 100000000;
    add(0, 0, 0, 25000);
    (void)step();
    operating_point_setpoint(&state, &config, -2000, 9000, &without);
    report.i_d_weakening_pu = -6000;
    (void)step();
    operating_point_setpoint(&state, &config, -2000, 9000, &with);
    TEST_ASSERT_EQUAL_INT32(without.i_reference_pu.d, with.i_reference_pu.d);
    TEST_ASSERT_EQUAL_INT32(without.i_reference_pu.q, with.i_reference_pu.q);
}

void test_a_reference_beyond_the_current_base_saturates(void)
{
    fast_setpoint_t setpoint;
    (void)step();
    operating_point_setpoint(&state, &config, -1000000, 1000000, &setpoint);
    TEST_ASSERT_TRUE(setpoint.i_reference_pu.d >= -32768 && setpoint.i_reference_pu.d <= -32767);
    TEST_ASSERT_EQUAL_INT32(32767, setpoint.i_reference_pu.q);
}

/* ---- tuning ---- */

void test_gains_are_those_of_the_present_bus_voltage(void)
{
    fast_setpoint_t low;
    fast_setpoint_t high;
    add(0, 0, 0, 12000);
    (void)step();
    operating_point_setpoint(&state, &config, 0, 0, &low);
    add(0, 0, 0, 24000);
    (void)step();
    operating_point_setpoint(&state, &config, 0, 0, &high);
    TEST_ASSERT_INT32_WITHIN(2, low.tuning.q.proportional_q10, 2 * high.tuning.q.proportional_q10);
    TEST_ASSERT_TRUE(low.dead_time_slope.alpha_q8 > high.dead_time_slope.alpha_q8);
}

void test_the_initial_setpoint_is_zero_current_with_the_smallest_gains(void)
{
    fast_setpoint_t initial;
    operating_point_initial_setpoint(&config, BASES_MODEL_TIMER_Hz, &initial);
    TEST_ASSERT_EQUAL_INT32(0, initial.i_reference_pu.d);
    TEST_ASSERT_EQUAL_INT32(0, initial.i_reference_pu.q);
    fast_setpoint_t setpoint;
    add(0, 0, 0, 20000);
    (void)step();
    operating_point_setpoint(&state, &config, 0, 0, &setpoint);
    TEST_ASSERT_EQUAL_INT32(setpoint.tuning.q.proportional_q10, initial.tuning.q.proportional_q10);
    TEST_ASSERT_EQUAL_INT32(setpoint.tuning.forward_q_q25, initial.tuning.forward_q_q25);
}

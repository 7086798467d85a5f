/* SPDX-License-Identifier: Apache-2.0 */
/* The speed upper bound: by the rotor sensor, by the largest deceleration of a vehicle, and by the
 * currents in active short circuit and in freewheel. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "monitor/monitor_speed.h"
#include "monitor_case.h"
#include "paper_vehicle.h"
#include "random_values.h"
#include "unity.h"

enum { PERIODS_PER_MS = 20 };

static const double PI = 3.14159265358979323846;
static config_t config;
static monitor_speed_state_t state;
static monitor_case_t in;
static double theta; /* of the short's current, radians */
static int32_t quadrant;
static int32_t bound_mrad_s;

void setUp(void)
{
    const monitor_speed_state_t initial = {.windows = 0};
    const monitor_case_t rest = {.report = {.offsets_done = true, .bridge = BRIDGE_PWM},
                                 .now = {.angle_valid = true, .bus_voltage_mV = 53000}};
    config = paper_vehicle();
    state = initial;
    in = rest;
    bound_mrad_s = 0;
    theta = 0.3;
    quadrant = 0;
}

void tearDown(void) {}

static double radius_m(void)
{
    return config.vehicle.wheel_radius_um * 1e-6;
}

/* Currents in active short circuit with a DC component for a millisecond, and the quadrant
 * transitions that the fast loop counts in it. */
static void turn(double rad_s, double turning_a, double direct_a, bool line_only)
{
    for (int n = 0; n < PERIODS_PER_MS; n++) {
        theta += rad_s * config.motor.pole_pairs / config.drive.pwm_frequency_Hz;
        const double alpha = turning_a * cos(theta) + direct_a;
        const double beta = line_only ? 0.57735 * alpha : turning_a * sin(theta);
        const int32_t now = (int32_t)floor((atan2(beta, alpha) + 2.0 * PI) / (PI / 2.0)) & 3;
        const int32_t change = (now - quadrant) & 3;
        quadrant = now;
        in.report.sequence++;
        if (change == 1 || change == 3) {
            in.report.quadrant_transitions =
                (uint16_t)(in.report.quadrant_transitions + (change == 1 ? 1 : UINT16_MAX));
            in.report.quadrant_step = in.report.sequence;
        }
        in.now.latest_i_d_mA = (int32_t)lround(1e3 * alpha);
        in.now.latest_i_q_mA = (int32_t)lround(1e3 * beta);
    }
}

/* Steps at zero current. */
static int32_t run(int milliseconds)
{
    for (int n = 0; n < milliseconds; n++) {
        turn(0.0, 0.0, 0.0, false);
        bound_mrad_s = monitor_speed_step(&state, &config, measured_of(&in));
    }
    return bound_mrad_s;
}

static double impedance_ohm(double rad_s)
{
    const double w = fabs(rad_s) * config.motor.pole_pairs;
    return hypot(config.motor.phase_resistance_uOhm * 1e-6,
                 w * config.motor.d_inductance_nH * 1e-9);
}

static double short_a(double rad_s)
{
    return fabs(rad_s) * config.motor.pole_pairs * config.motor.flux_linkage_nWb * 1e-9 /
           impedance_ohm(rad_s);
}

static int32_t run_short(int milliseconds, double rad_s)
{
    in.report.bridge = BRIDGE_SHORT;
    for (int n = 0; n < milliseconds; n++) {
        turn(rad_s, short_a(rad_s), 0.0, false);
        bound_mrad_s = monitor_speed_step(&state, &config, measured_of(&in));
    }
    return bound_mrad_s;
}

/* ---- rotor sensor ---- */

void test_valid_sensor_speed_applies_in_the_same_step(void)
{
    random_t random = random_seeded(1);
    double rad_s = 0.0;
    for (int n = 0; n < 20000; n++) {
        /* Tyres decelerate a wheel by less than 1.2 g; its acceleration has no bound. */
        const double fall = 1.19 * 9.81 / radius_m() * 1e-3;
        rad_s = fmin(rad_s + random_real(&random, -fall, random_chance(&random, 0.5) ? fall : 0.0),
                     80.0);
        rad_s = fmax(rad_s, -80.0);
        in.now.speed_mrad_s = (int32_t)lround(rad_s * 1e3);
        const int32_t before = abs(in.now.speed_mrad_s);
        /* Tolerance for the rounding near zero speed. */
        TEST_ASSERT_INT32_WITHIN(1, before, run(1));
    }
}

void test_bound_falls_at_1_2_g_with_a_valid_sensor_and_at_0_01_g_without(void)
{
    const double rates_m_s2[] = {1.2 * 9.80665, 0.01 * 9.80665};
    for (int valid = 0; valid < 2; valid++) {
        setUp();
        in.now.speed_mrad_s = 70000;
        run(1);
        in.now.speed_mrad_s = 0;
        in.now.angle_valid = valid != 0;
        const double expected = 70.0 - rates_m_s2[1 - valid] / radius_m() * 0.5;
        TEST_ASSERT_DOUBLE_WITHIN(0.02, expected, run(500) * 1e-3);
    }
}

/* At 44 rad/s (40 km/h) the sensor freezes: valid, zero. The bound is zero after 44 / 47.1 s; rest
 * is known when coasting at 0.01 g would have stopped the vehicle, 44 / 0.392 s later. */
void test_a_sensor_that_stops_faster_than_a_tyre_does_not_show_rest(void)
{
    const double seconds = 44.0 * radius_m() / (config.monitor.coasting_mm_s2 * 1e-3);
    in.now.speed_mrad_s = 44000;
    (void)run(10);
    TEST_ASSERT_EQUAL_INT64(44000000, state.rest_urad_s);
    in.now.speed_mrad_s = 0;
    TEST_ASSERT_EQUAL_INT32(0, run(1000));
    TEST_ASSERT_GREATER_THAN_INT64(43000000, state.rest_urad_s);
    (void)run((int)(seconds * 990.0) - 1000);
    TEST_ASSERT_GREATER_THAN_INT64(0, state.rest_urad_s);
    (void)run((int)(seconds * 20.0));
    TEST_ASSERT_EQUAL_INT64(0, state.rest_urad_s);
}

void test_a_sensor_that_slows_down_as_a_tyre_can_shows_rest_with_its_speed(void)
{
    for (int32_t mrad_s = 44000; mrad_s > 0; mrad_s -= 45) {
        in.now.speed_mrad_s = mrad_s;
        (void)run(1);
        TEST_ASSERT_EQUAL_INT64(INT64_C(1000) * bound_mrad_s, state.rest_urad_s);
    }
    in.now.speed_mrad_s = 0;
    (void)run(200);
    TEST_ASSERT_EQUAL_INT64(0, state.rest_urad_s);
}

/* A hall sensor's speed ends at once when its next edge is overdue. */
void test_a_sensor_may_fall_to_zero_from_the_hand_over_speed(void)
{
    in.now.speed_mrad_s = config.brake.blend_out_end_mrad_s;
    (void)run(10);
    in.now.speed_mrad_s = 0;
    (void)run(1000);
    TEST_ASSERT_EQUAL_INT64(0, state.rest_urad_s);
}

void test_a_sensor_that_moves_again_counts_again_after_100_ms(void)
{
    in.now.speed_mrad_s = 44000;
    (void)run(10);
    in.now.speed_mrad_s = 0;
    (void)run(1000);
    in.now.speed_mrad_s =
        2 * config.brake.blend_out_end_mrad_s; /* a locked wheel that turns again */
    (void)run(MONITOR_SPEED_MOVING_STEPS - 1);
    TEST_ASSERT_GREATER_THAN_INT64(43000000, state.rest_urad_s);
    (void)run(1);
    TEST_ASSERT_EQUAL_INT64(INT64_C(1000) * in.now.speed_mrad_s, state.rest_urad_s);
}

void test_bound_is_zero_before_any_sensor_has_measured_a_speed(void)
{
    in.now.angle_valid = false;
    in.report.bridge = BRIDGE_OFF;
    TEST_ASSERT_EQUAL_INT32(0, run(1000));
}

/* ---- active short circuit ---- */

void test_quadrant_transitions_of_the_short_circuit_current_give_the_speed(void)
{
    random_t random = random_seeded(2);
    for (int k = 0; k < 40; k++) {
        setUp();
        const double rad_s =
            random_real(&random, 5.0, 100.0) * (random_chance(&random, 0.5) ? 1.0 : -1.0);
        in.now.speed_mrad_s = (int32_t)lround(1e3 * random_real(&random, 1.0, 1.5) *
                                              fabs(rad_s)); /* last valid speed, too high */
        run(1);
        in.now.angle_valid = false;
        in.now.speed_mrad_s = 0;
        const double measured = run_short(300, rad_s) * 1e-3;
        /* A window is four electrical turns, each end known within a period. Where they take longer
         * than 100 ms, it may count two quadrant transitions too many. */
        const double quarters_per_s = fabs(rad_s) * config.motor.pole_pairs / (PI / 2.0);
        const bool full = 16.0 / quarters_per_s < 0.098;
        const double above = full ? quarters_per_s / 16.0 / config.drive.pwm_frequency_Hz
                                  : 2.0 / (quarters_per_s * 0.1);
        const double below = quarters_per_s / 16.0 / config.drive.pwm_frequency_Hz;
        char text[100];
        snprintf(text, sizeof(text), "%.3f measured at %.3f rad/s", measured, rad_s);
        TEST_ASSERT_TRUE_MESSAGE(measured <= fabs(rad_s) * (1.0 + above) + 0.002, text);
        TEST_ASSERT_TRUE_MESSAGE(measured >= fabs(rad_s) * (1.0 - below) - 0.002, text);
    }
}

void test_a_valid_sensor_speed_above_that_of_the_current_applies(void)
{
    in.now.speed_mrad_s = 60000;
    run_short(300, 40.0);
    TEST_ASSERT_EQUAL_INT32(60000, bound_mrad_s);
    in.now.angle_valid = false;
    run_short(50, 40.0);
    TEST_ASSERT_INT32_WITHIN(200, 40000, bound_mrad_s);
}

void test_a_current_speed_above_that_of_a_stuck_sensor_applies(void)
{
    in.now.speed_mrad_s = 70000;
    run(1);
    in.now.speed_mrad_s = 0;
    run_short(1500, 70.0);
    TEST_ASSERT_INT32_WITHIN(350, 70000, bound_mrad_s);
}

void test_zero_current_in_active_short_circuit_is_standstill(void)
{
    in.now.speed_mrad_s = 70000;
    run(1);
    in.now.speed_mrad_s = 0;
    in.now.angle_valid = false;
    in.report.bridge = BRIDGE_SHORT;
    TEST_ASSERT_TRUE(run(199) > 69000);
    TEST_ASSERT_EQUAL_INT32(0, run(2));
}

/* The DC component at the beginning of a short circuit, up to three times the AC amplitude, decays
 * with a time constant of 5 to 60 ms. */
void test_decaying_dc_component_never_lowers_the_bound(void)
{
    random_t random = random_seeded(3);
    for (int k = 0; k < 25; k++) {
        setUp();
        const double rad_s = random_real(&random, 50.0, 100.0);
        const double tau_ms = random_real(&random, 5.0, 60.0);
        const double direct = short_a(rad_s) * random_real(&random, 0.5, 3.0);
        in.now.speed_mrad_s = (int32_t)lround(1e3 * rad_s);
        run(1);
        in.now.angle_valid = false;
        in.now.speed_mrad_s = 0;
        in.report.bridge = BRIDGE_SHORT;
        theta = random_real(&random, 0.0, 2.0 * PI);
        for (int ms = 0; ms < 300; ms++) {
            turn(rad_s, short_a(rad_s), direct * exp(-ms / tau_ms), false);
            bound_mrad_s = monitor_speed_step(&state, &config, measured_of(&in));
            char text[120];
            snprintf(text, sizeof(text), "%d at %.3f rad/s after %d ms, %.2f of it direct, %.1f ms",
                     (int)bound_mrad_s, rad_s, ms, direct / short_a(rad_s), tau_ms);
            TEST_ASSERT_TRUE_MESSAGE(bound_mrad_s * 1e-3 > 0.98 * rad_s, text);
        }
    }
}

void test_dead_current_sensor_does_not_lower_the_bound(void)
{
    in.now.speed_mrad_s = 70000;
    run(1);
    in.now.angle_valid = false;
    in.now.speed_mrad_s = 0;
    in.report.bridge = BRIDGE_SHORT;
    for (int ms = 0; ms < 2000; ms++) {
        turn(70.0, short_a(70.0), 0.0, true); /* the current vector moves on a straight line */
        bound_mrad_s = monitor_speed_step(&state, &config, measured_of(&in));
    }
    TEST_ASSERT_TRUE(bound_mrad_s > 69000); /* 2 s at 0.01 g are 0.8 rad/s */
}

/* ---- freewheel ---- */

static const double THRESHOLD_A = 8.26; /* 5 % of 165 A */

static void assert_speed_of_emf_at_bus_voltage(int32_t speed_mrad_s)
{
    /* sqrt(3) * 0.0204 * 23 * w = v_dc, and no more than 3 % beyond it. */
    const double limit = in.now.bus_voltage_mV / (sqrt(3.0) * 0.0204 * 23.0);
    TEST_ASSERT_TRUE(speed_mrad_s > limit * 1.005);
    TEST_ASSERT_TRUE(speed_mrad_s < limit * 1.03);
}

void test_lasting_current_in_freewheel_means_an_emf_above_the_bus_voltage(void)
{
    in.now.angle_valid = false;
    in.report.bridge = BRIDGE_OFF;
    for (int ms = 0; ms < 19; ms++) {
        in.now.latest_i_d_mA = (int32_t)(1e3 * (THRESHOLD_A + 0.1));
        TEST_ASSERT_EQUAL_INT32(0, monitor_speed_step(&state, &config, measured_of(&in)));
    }
    assert_speed_of_emf_at_bus_voltage(monitor_speed_step(&state, &config, measured_of(&in)));
}

void test_intermittent_or_small_current_in_freewheel_is_ignored(void)
{
    in.now.angle_valid = false;
    in.report.bridge = BRIDGE_OFF;
    for (int ms = 0; ms < 1000; ms++) {
        in.now.latest_i_q_mA = ms % 2 == 0 ? 50000 : 0;
        TEST_ASSERT_EQUAL_INT32(0, monitor_speed_step(&state, &config, measured_of(&in)));
    }
    in.now.latest_i_q_mA = (int32_t)(1e3 * (THRESHOLD_A - 0.1));
    for (int ms = 0; ms < 1000; ms++) {
        TEST_ASSERT_EQUAL_INT32(0, monitor_speed_step(&state, &config, measured_of(&in)));
    }
}

void test_current_threshold_includes_the_offset_tolerance_before_calibration(void)
{
    in.now.angle_valid = false;
    in.report.bridge = BRIDGE_OFF;
    in.report.offsets_done = false;
    /* Twice the tolerance of 200 codes of 2048. */
    in.now.latest_i_d_mA = (int32_t)(1e3 * (THRESHOLD_A + 165.0 * 400.0 / 2048.0 - 0.3));
    for (int ms = 0; ms < 100; ms++) {
        TEST_ASSERT_EQUAL_INT32(0, monitor_speed_step(&state, &config, measured_of(&in)));
    }
    in.now.latest_i_d_mA += 600;
    for (int ms = 0; ms < 20; ms++) {
        bound_mrad_s = monitor_speed_step(&state, &config, measured_of(&in));
    }
    assert_speed_of_emf_at_bus_voltage(bound_mrad_s);
}

void test_sensor_speed_above_blend_out_overrides_the_freewheel_current(void)
{
    in.report.bridge = BRIDGE_OFF;
    in.now.speed_mrad_s = config.brake.blend_out_end_mrad_s;
    in.now.bus_voltage_mV = config.battery.overvoltage_trip_mV + 1;
    in.now.latest_i_d_mA = 50000;
    for (int ms = 0; ms < 1000; ms++) {
        TEST_ASSERT_EQUAL_INT32(in.now.speed_mrad_s,
                                monitor_speed_step(&state, &config, measured_of(&in)));
    }
    in.now.speed_mrad_s--; /* below the blend-out speed the current decides */
    for (int ms = 0; ms < 20; ms++) {
        bound_mrad_s = monitor_speed_step(&state, &config, measured_of(&in));
    }
    assert_speed_of_emf_at_bus_voltage(bound_mrad_s);
}

void test_overvoltage_in_freewheel_raises_the_bound_once(void)
{
    in.now.angle_valid = false;
    in.report.bridge = BRIDGE_OFF;
    in.now.bus_voltage_mV = config.battery.overvoltage_trip_mV;
    TEST_ASSERT_EQUAL_INT32(0, run(100));
    in.now.bus_voltage_mV++;
    assert_speed_of_emf_at_bus_voltage(run(1));
    /* Zero current in active short circuit: another wheel raised the bus voltage. */
    in.report.bridge = BRIDGE_SHORT;
    TEST_ASSERT_EQUAL_INT32(0, run(201));
    in.report.bridge = BRIDGE_OFF;
    TEST_ASSERT_EQUAL_INT32(0, run(1000));
    in.now.bus_voltage_mV--;
    run(1);
    in.now.bus_voltage_mV++;
    assert_speed_of_emf_at_bus_voltage(run(1));
}

void test_current_and_voltage_while_switching_do_not_raise_the_bound(void)
{
    in.now.angle_valid = false;
    in.report.bridge = BRIDGE_PWM;
    in.now.latest_i_d_mA = 90000;
    in.now.bus_voltage_mV = 70000;
    for (int ms = 0; ms < 100; ms++) {
        TEST_ASSERT_EQUAL_INT32(0, monitor_speed_step(&state, &config, measured_of(&in)));
    }
}

/* A stopped fast loop counts no quadrant transitions. This is no evidence of standstill. */
void test_windows_without_fast_steps_do_not_lower_the_bound(void)
{
    in.now.speed_mrad_s = 30000;
    TEST_ASSERT_EQUAL_INT32(30000, run(1));
    in.now.speed_mrad_s = 0;
    in.now.angle_valid = false;
    in.report.bridge = BRIDGE_SHORT;
    for (int n = 0; n < 250; n++) {
        bound_mrad_s = monitor_speed_step(&state, &config, measured_of(&in));
    }
    const double coasted_mrad_s = 0.0981 / radius_m() * 250.0;
    TEST_ASSERT_TRUE(bound_mrad_s >= 30000 - lround(coasted_mrad_s) - 1);
}

/* 16 quadrant transitions of 23 pole pairs take 27.3 ms at 40 rad/s and 54.6 ms at 20 rad/s. The
 * third window begins after 54.6 ms and contains 5.4 ms at 40 rad/s. It ends 48.9 ms later with
 * 22.3 rad/s, more than an eighth below 40. */
void test_falling_speed_needs_two_windows_in_a_row(void)
{
    in.now.speed_mrad_s = 0;
    in.now.angle_valid = false;
    TEST_ASSERT_INT32_WITHIN(400, 40000, run_short(60, 40.0));
    TEST_ASSERT_INT32_WITHIN(400, 40000, run_short(54, 20.0));
    TEST_ASSERT_INT32_WITHIN(200, 20000, run_short(60, 20.0));
}

/* ---- any input ---- */

void test_bound_is_at_least_the_valid_sensor_speed_for_any_input(void)
{
    random_t random = random_seeded(4);
    for (int n = 0; n < 100000; n++) {
        in.now.speed_mrad_s = random_wild(&random);
        in.now.angle_valid = random_chance(&random, 0.5);
        in.report.bridge = (bridge_mode_t)random_between(&random, 0, 2);
        in.now.latest_i_d_mA = random_wild(&random);
        in.now.latest_i_q_mA = random_wild(&random);
        in.report.offsets_done = random_chance(&random, 0.5);
        in.report.quadrant_transitions = (uint16_t)random_between(&random, 0, UINT16_MAX);
        in.report.quadrant_step = (uint16_t)random_between(&random, 0, UINT16_MAX);
        in.report.sequence = (uint16_t)random_between(&random, 0, UINT16_MAX);
        in.now.bus_voltage_mV = random_wild(&random);
        const int64_t bounded = monitor_speed_step(&state, &config, measured_of(&in));
        TEST_ASSERT_TRUE(bounded >= 0);
        TEST_ASSERT_TRUE(!in.now.angle_valid ||
                         bounded >= llabs((long long)in.now.speed_mrad_s) - 1);
        if (random_chance(&random, 0.01)) {
            state.bound_urad_s = 0;
        }
    }
}

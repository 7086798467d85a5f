/* SPDX-License-Identifier: Apache-2.0 */
/* How fast the wheel may be turning: what a sensor says, what a vehicle can do, what the currents
 * of a short and of an open bridge show. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "monitor/monitor_speed.h"
#include "paper_vehicle.h"
#include "random_values.h"
#include "unity.h"

enum { PERIODS_PER_MS = 20 };

static const double PI = 3.14159265358979323846;
static config_t config;
static monitor_speed_state_t state;
static monitor_speed_input_t in;
static double theta; /* of the short's current, radians */
static int32_t quarter;
static int32_t held_mrad_s;

void setUp(void)
{
    const monitor_speed_state_t nothing = {.windows = 0};
    const monitor_speed_input_t rest = {
        .rotor_valid = true, .offsets_known = true, .bridge = BRIDGE_PWM, .bus_voltage_mV = 53000};
    config = paper_vehicle();
    state = nothing;
    in = rest;
    theta = 0.3;
    quarter = 0;
}

void tearDown(void) {}

static double radius_m(void)
{
    return config.vehicle.wheel_radius_um * 1e-6;
}

/* The currents of a short with a direct part, period by period, as the fast loop counts them. */
static void turn(double rad_s, double turning_a, double direct_a, bool line_only)
{
    for (int n = 0; n < PERIODS_PER_MS; n++) {
        theta += rad_s * config.motor.pole_pairs / config.drive.pwm_frequency_Hz;
        const double alpha = turning_a * cos(theta) + direct_a;
        const double beta = line_only ? 0.57735 * alpha : turning_a * sin(theta);
        const int32_t now = (int32_t)floor((atan2(beta, alpha) + 2.0 * PI) / (PI / 2.0)) & 3;
        const int32_t gone = (now - quarter) & 3;
        quarter = now;
        in.fast_step_count++;
        if (gone == 1 || gone == 3) {
            in.current_quarters = (uint16_t)(in.current_quarters + (gone == 1 ? 1 : UINT16_MAX));
            in.quarter_step = in.fast_step_count;
        }
        in.i_d_mA = (int32_t)lround(1e3 * alpha);
        in.i_q_mA = (int32_t)lround(1e3 * beta);
    }
}

/* Steps with nothing flowing. */
static int32_t run(int milliseconds)
{
    for (int n = 0; n < milliseconds; n++) {
        turn(0.0, 0.0, 0.0, false);
        held_mrad_s = monitor_speed_step(&state, &config, &in);
    }
    return held_mrad_s;
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
    in.bridge = BRIDGE_SHORT;
    for (int n = 0; n < milliseconds; n++) {
        turn(rad_s, short_a(rad_s), 0.0, false);
        held_mrad_s = monitor_speed_step(&state, &config, &in);
    }
    return held_mrad_s;
}

/* ---- what the sensor says ---- */

void test_a_valid_sensor_is_believed_at_once_whatever_a_vehicle_can_do(void)
{
    random_t random = random_seeded(1);
    double rad_s = 0.0;
    for (int n = 0; n < 20000; n++) {
        /* Tyres do not hold 1.2 g; a wheel that loses its grip speeds up as it likes. */
        const double fall = 1.19 * 9.81 / radius_m() * 1e-3;
        rad_s = fmin(rad_s + random_real(&random, -fall, random_chance(&random, 0.5) ? fall : 0.0),
                     80.0);
        rad_s = fmax(rad_s, -80.0);
        in.speed_mrad_s = (int32_t)lround(rad_s * 1e3);
        const int32_t before = abs(in.speed_mrad_s);
        /* Through nothing the magnitude turns round. */
        TEST_ASSERT_INT32_WITHIN(1, before, run(1));
    }
}

void test_a_speed_that_vanishes_is_held_and_falls_as_the_tyres_or_the_road_allow(void)
{
    const double rates_m_s2[] = {1.2 * 9.80665, 0.01 * 9.80665};
    for (int valid = 0; valid < 2; valid++) {
        setUp();
        in.speed_mrad_s = 70000;
        run(1);
        in.speed_mrad_s = 0;
        in.rotor_valid = valid != 0;
        const double expected = 70.0 - rates_m_s2[1 - valid] / radius_m() * 0.5;
        TEST_ASSERT_DOUBLE_WITHIN(0.02, expected, run(500) * 1e-3);
    }
}

void test_a_wheel_that_was_never_seen_to_turn_stands(void)
{
    in.rotor_valid = false;
    in.bridge = BRIDGE_OFF;
    TEST_ASSERT_EQUAL_INT32(0, run(1000));
}

/* ---- the short ---- */

void test_the_current_of_a_short_says_how_fast_the_wheel_turns_whatever_the_sensor_says(void)
{
    random_t random = random_seeded(2);
    for (int k = 0; k < 40; k++) {
        setUp();
        const double rad_s =
            random_real(&random, 5.0, 100.0) * (random_chance(&random, 0.5) ? 1.0 : -1.0);
        in.speed_mrad_s = (int32_t)lround(1e3 * random_real(&random, 1.0, 1.5) *
                                          fabs(rad_s)); /* before it is lost */
        run(1);
        in.rotor_valid = false;
        in.speed_mrad_s = 0;
        const double measured = run_short(300, rad_s) * 1e-3;
        /* Four turns, each end to a period; where they take longer than 100 ms, one quarter too
         * much, and one more that had begun before. */
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

void test_a_valid_sensor_that_says_more_than_the_current_is_believed(void)
{
    in.speed_mrad_s = 60000;
    run_short(300, 40.0);
    TEST_ASSERT_EQUAL_INT32(60000, held_mrad_s);
    in.rotor_valid = false;
    run_short(50, 40.0);
    TEST_ASSERT_INT32_WITHIN(200, 40000, held_mrad_s);
}

void test_a_stuck_sensor_that_calls_itself_valid_is_overruled_by_the_current(void)
{
    in.speed_mrad_s = 70000;
    run(1);
    in.speed_mrad_s = 0;
    run_short(1500, 70.0);
    TEST_ASSERT_INT32_WITHIN(350, 70000, held_mrad_s);
}

void test_a_short_without_current_is_a_wheel_that_stands(void)
{
    in.speed_mrad_s = 70000;
    run(1);
    in.speed_mrad_s = 0;
    in.rotor_valid = false;
    in.bridge = BRIDGE_SHORT;
    TEST_ASSERT_TRUE(run(199) > 69000);
    TEST_ASSERT_EQUAL_INT32(0, run(2));
}

/* The direct current with which a short begins, up to three times the turning one, decays with 5 to
 * 60 ms. */
void test_a_direct_current_that_decays_never_makes_a_turning_wheel_look_slow(void)
{
    random_t random = random_seeded(3);
    for (int k = 0; k < 25; k++) {
        setUp();
        const double rad_s = random_real(&random, 50.0, 100.0);
        const double tau_ms = random_real(&random, 5.0, 60.0);
        const double direct = short_a(rad_s) * random_real(&random, 0.5, 3.0);
        in.speed_mrad_s = (int32_t)lround(1e3 * rad_s);
        run(1);
        in.rotor_valid = false;
        in.speed_mrad_s = 0;
        in.bridge = BRIDGE_SHORT;
        theta = random_real(&random, 0.0, 2.0 * PI);
        for (int ms = 0; ms < 300; ms++) {
            turn(rad_s, short_a(rad_s), direct * exp(-ms / tau_ms), false);
            held_mrad_s = monitor_speed_step(&state, &config, &in);
            char text[120];
            snprintf(text, sizeof(text), "%d at %.3f rad/s after %d ms, %.2f of it direct, %.1f ms",
                     (int)held_mrad_s, rad_s, ms, direct / short_a(rad_s), tau_ms);
            TEST_ASSERT_TRUE_MESSAGE(held_mrad_s * 1e-3 > 0.98 * rad_s, text);
        }
    }
}

void test_a_dead_current_sensor_does_not_make_a_turning_wheel_look_slow(void)
{
    in.speed_mrad_s = 70000;
    run(1);
    in.rotor_valid = false;
    in.speed_mrad_s = 0;
    in.bridge = BRIDGE_SHORT;
    for (int ms = 0; ms < 2000; ms++) {
        turn(70.0, short_a(70.0), 0.0, true); /* on a line, to and fro */
        held_mrad_s = monitor_speed_step(&state, &config, &in);
    }
    TEST_ASSERT_TRUE(held_mrad_s > 69000); /* 2 s at 0.01 g are 0.8 rad/s */
}

/* ---- the open bridge ---- */

static const double SILENCE_A = 8.26; /* 5 % of 165 A */

static void assert_taken_for_as_fast_as_the_bus(int32_t speed_mrad_s)
{
    /* sqrt(3) * 0.0204 * 23 * w = v_dc, and no more than 3 % beyond it. */
    const double limit = in.bus_voltage_mV / (sqrt(3.0) * 0.0204 * 23.0);
    TEST_ASSERT_TRUE(speed_mrad_s > limit * 1.005);
    TEST_ASSERT_TRUE(speed_mrad_s < limit * 1.03);
}

void test_a_current_that_goes_on_in_the_open_bridge_is_the_emf_s(void)
{
    in.rotor_valid = false;
    in.bridge = BRIDGE_OFF;
    for (int ms = 0; ms < 19; ms++) {
        in.i_d_mA = (int32_t)(1e3 * (SILENCE_A + 0.1));
        TEST_ASSERT_EQUAL_INT32(0, monitor_speed_step(&state, &config, &in));
    }
    assert_taken_for_as_fast_as_the_bus(monitor_speed_step(&state, &config, &in));
}

void test_a_current_in_one_look_of_two_or_a_small_one_is_none(void)
{
    in.rotor_valid = false;
    in.bridge = BRIDGE_OFF;
    for (int ms = 0; ms < 1000; ms++) {
        in.i_q_mA = ms % 2 == 0 ? 50000 : 0;
        TEST_ASSERT_EQUAL_INT32(0, monitor_speed_step(&state, &config, &in));
    }
    in.i_q_mA = (int32_t)(1e3 * (SILENCE_A - 0.1));
    for (int ms = 0; ms < 1000; ms++) {
        TEST_ASSERT_EQUAL_INT32(0, monitor_speed_step(&state, &config, &in));
    }
}

void test_sensors_whose_zero_is_not_known_yet_may_show_that_much_more(void)
{
    in.rotor_valid = false;
    in.bridge = BRIDGE_OFF;
    in.offsets_known = false;
    /* Twice the tolerance of 200 codes of 2048. */
    in.i_d_mA = (int32_t)(1e3 * (SILENCE_A + 165.0 * 400.0 / 2048.0 - 0.3));
    for (int ms = 0; ms < 100; ms++) {
        TEST_ASSERT_EQUAL_INT32(0, monitor_speed_step(&state, &config, &in));
    }
    in.i_d_mA += 600;
    for (int ms = 0; ms < 20; ms++) {
        held_mrad_s = monitor_speed_step(&state, &config, &in);
    }
    assert_taken_for_as_fast_as_the_bus(held_mrad_s);
}

void test_a_wheel_that_is_seen_to_turn_is_as_fast_as_it_is_seen(void)
{
    in.bridge = BRIDGE_OFF;
    in.speed_mrad_s = config.brake.blend_out_end_mrad_s;
    in.bus_voltage_mV = config.battery.overvoltage_trip_mV + 1;
    in.i_d_mA = 50000;
    for (int ms = 0; ms < 1000; ms++) {
        TEST_ASSERT_EQUAL_INT32(in.speed_mrad_s, monitor_speed_step(&state, &config, &in));
    }
    in.speed_mrad_s--; /* as good as standing: nothing contradicts the current */
    for (int ms = 0; ms < 20; ms++) {
        held_mrad_s = monitor_speed_step(&state, &config, &in);
    }
    assert_taken_for_as_fast_as_the_bus(held_mrad_s);
}

void test_an_over_voltage_of_the_open_bridge_counts_once(void)
{
    in.rotor_valid = false;
    in.bridge = BRIDGE_OFF;
    in.bus_voltage_mV = config.battery.overvoltage_trip_mV;
    TEST_ASSERT_EQUAL_INT32(0, run(100));
    in.bus_voltage_mV++;
    assert_taken_for_as_fast_as_the_bus(run(1));
    /* The short finds no current: it was not this wheel. */
    in.bridge = BRIDGE_SHORT;
    TEST_ASSERT_EQUAL_INT32(0, run(201));
    in.bridge = BRIDGE_OFF;
    TEST_ASSERT_EQUAL_INT32(0, run(1000));
    in.bus_voltage_mV--;
    run(1);
    in.bus_voltage_mV++;
    assert_taken_for_as_fast_as_the_bus(run(1));
}

void test_a_current_while_switching_says_nothing(void)
{
    in.rotor_valid = false;
    in.bridge = BRIDGE_PWM;
    in.i_d_mA = 90000;
    in.bus_voltage_mV = 70000;
    for (int ms = 0; ms < 100; ms++) {
        TEST_ASSERT_EQUAL_INT32(0, monitor_speed_step(&state, &config, &in));
    }
}

/* A reach that stands still counts no quarters: that is no wheel that stands. */
void test_windows_in_which_the_fast_loop_made_no_step_measure_nothing(void)
{
    in.speed_mrad_s = 30000;
    TEST_ASSERT_EQUAL_INT32(30000, run(1));
    in.speed_mrad_s = 0;
    in.rotor_valid = false;
    in.bridge = BRIDGE_SHORT;
    for (int n = 0; n < 250; n++) {
        held_mrad_s = monitor_speed_step(&state, &config, &in);
    }
    const double coasted_mrad_s = 0.0981 / radius_m() * 250.0;
    TEST_ASSERT_TRUE(held_mrad_s >= 30000 - lround(coasted_mrad_s) - 1);
}

/* 16 quarters of 23 pole pairs take 27.3 ms at 40 rad/s and 54.6 ms at 20. The third window begins
 * after 54.6 ms and has seen 5.4 ms of the faster turning: it ends 48.9 ms later with 22.3 rad/s,
 * more than an eighth below 40. */
void test_a_speed_that_falls_within_a_window_is_believed_when_the_next_one_confirms_it(void)
{
    in.speed_mrad_s = 0;
    in.rotor_valid = false;
    TEST_ASSERT_INT32_WITHIN(400, 40000, run_short(60, 40.0));
    TEST_ASSERT_INT32_WITHIN(400, 40000, run_short(54, 20.0));
    TEST_ASSERT_INT32_WITHIN(200, 20000, run_short(60, 20.0));
}

/* ---- whatever comes ---- */

void test_no_input_makes_it_negative_or_slower_than_a_valid_sensor(void)
{
    random_t random = random_seeded(4);
    for (int n = 0; n < 100000; n++) {
        in.speed_mrad_s = random_wild(&random);
        in.rotor_valid = random_chance(&random, 0.5);
        in.bridge = (bridge_mode_t)random_between(&random, 0, 2);
        in.i_d_mA = random_wild(&random);
        in.i_q_mA = random_wild(&random);
        in.offsets_known = random_chance(&random, 0.5);
        in.current_quarters = (uint16_t)random_between(&random, 0, UINT16_MAX);
        in.quarter_step = (uint16_t)random_between(&random, 0, UINT16_MAX);
        in.fast_step_count = (uint16_t)random_between(&random, 0, UINT16_MAX);
        in.bus_voltage_mV = random_wild(&random);
        const int64_t held = monitor_speed_step(&state, &config, &in);
        TEST_ASSERT_TRUE(held >= 0);
        TEST_ASSERT_TRUE(!in.rotor_valid || held >= llabs((long long)in.speed_mrad_s) - 1);
        if (random_chance(&random, 0.01)) {
            state.bound_urad_s = 0;
        }
    }
}

/* SPDX-License-Identifier: Apache-2.0 */
/* The speed upper bound by windows of a short circuit and by diode currents: lengths and
 * thresholds, each on both sides. The vehicle is chosen so that they are whole numbers: 10 pole
 * pairs at 20 kHz, of which 16 quadrant transitions in n periods are 50 265 600/n mrad/s; tyre grip
 * slows the wheel by 100 mrad/s in a step, coasting by 1; the silence of the current sensors is 10
 * 240 mA. */
#include <math.h>

#include "monitor/monitor_speed.h"
#include "monitor_case.h"
#include "paper_vehicle.h"
#include "unity.h"

enum {
    PERIODS_PER_MS = 20,
    SILENCE_mA = 10240,
    GRIP_urad_s = 100000,
    COASTING_urad_s = 1000,
    SPEED_OF_700_mrad_s = 71808,
    HAND_OVER_mrad_s = 2000
};

static config_t config;
static monitor_speed_state_t state;
static monitor_case_t in;

void setUp(void)
{
    const monitor_speed_state_t initial = {.windows = 0};
    const monitor_case_t rest = {.report = {.offsets_done = true, .bridge = BRIDGE_PWM},
                                 .now = {.angle_valid = true, .bus_voltage_mV = 40000}};
    config = paper_vehicle();
    config.drive.pwm_frequency_Hz = 20000;
    config.drive.current_full_scale_mA = 163840;
    config.monitor.current_sum_pu_q15 = 2048;   /* 1/16 of the range: the silence */
    config.monitor.offset_tolerance_codes = 64; /* twice that is as much */
    config.monitor.tyre_grip_mm_s2 = 9800;
    config.monitor.coasting_mm_s2 = 98;
    config.vehicle.wheel_radius_um = 98000;
    config.brake.blend_out_end_mrad_s = HAND_OVER_mrad_s;
    config.motor.pole_pairs = 10;
    config.motor.phase_resistance_uOhm = 10000;
    config.motor.d_inductance_nH = 1000;
    config.motor.flux_linkage_nWb = 20000000;
    state = initial;
    in = rest;
}

void tearDown(void) {}

static int32_t step(void)
{
    return monitor_speed_step(&state, &config, measured_of(&in));
}

/* Milliseconds without quadrant transitions. */
static int32_t wait(int milliseconds)
{
    int32_t bound_mrad_s = 0;
    for (int n = 0; n < milliseconds; n++) {
        in.report.sequence = (uint16_t)(in.report.sequence + PERIODS_PER_MS);
        bound_mrad_s = step();
    }
    return bound_mrad_s;
}

/* Quadrant transitions that all fall into one slow step, the last of them at its end. */
static int32_t transitions(int quarters, int periods, int32_t current_mA)
{
    in.now.latest_i_d_mA = current_mA;
    in.report.sequence = (uint16_t)(in.report.sequence + periods);
    in.report.quadrant_transitions = (uint16_t)(in.report.quadrant_transitions + quarters);
    in.report.quadrant_step = in.report.sequence;
    return step();
}

/* The sensor is lost at 70 rad/s, and the bridge is shorted. */
static void lose_sensor_and_short(void)
{
    in.now.speed_mrad_s = 70000;
    (void)step();
    in.now.speed_mrad_s = 0;
    in.now.angle_valid = false;
    in.report.bridge = BRIDGE_SHORT;
}

/* ---- windows of the short circuit ---- */

/* A sensor that stops in the 100 steps before: rest falls as a coasting vehicle, the bound by what
 * a tyre can do; both stay until the short circuit has measured. */
void test_a_short_circuit_holds_rest_above_the_bound_until_its_second_window_ends(void)
{
    in.now.speed_mrad_s = 70000;
    (void)step();
    in.now.speed_mrad_s = 0;
    (void)wait(100);
    in.report.bridge = BRIDGE_SHORT;
    in.now.latest_i_d_mA = 1000000;
    for (int n = 1; n <= 199; n++) {
        (void)wait(1);
        TEST_ASSERT_EQUAL_INT64(70000000 - 100 * COASTING_urad_s, state.rest_urad_s);
        TEST_ASSERT_EQUAL_INT64(70000000 - 100 * GRIP_urad_s, state.bound_urad_s);
    }
    (void)wait(1);
    TEST_ASSERT_EQUAL_INT64(70000000 - 101 * COASTING_urad_s, state.rest_urad_s);
}

void test_what_a_short_circuit_measures_replaces_rest_of_a_stopped_sensor(void)
{
    lose_sensor_and_short();
    in.now.angle_valid = true;
    (void)transitions(16, 2000, 20000);
    (void)transitions(16, 2000, 20000);
    TEST_ASSERT_TRUE(state.stopped);
    TEST_ASSERT_EQUAL_INT64(25132000, state.bound_urad_s);
    TEST_ASSERT_EQUAL_INT64(25132000, state.rest_urad_s);
}

void test_a_vector_that_turns_backwards_ends_its_windows_as_well(void)
{
    lose_sensor_and_short();
    TEST_ASSERT_EQUAL_INT32(70000, transitions(-16, 800, 20000));
    TEST_ASSERT_EQUAL_INT32(62832, transitions(-16, 800, 20000));
}

/* 15 transitions early in each window of 100 ms: with the one that may have been missed they are 16
 * in 2000 periods. Each window begins where the one before ended. */
void test_a_window_of_100_ms_counts_one_transition_more(void)
{
    lose_sensor_and_short();
    for (int window = 0; window < 4; window++) {
        (void)transitions(15, PERIODS_PER_MS, 20000);
        (void)wait(98);
        TEST_ASSERT_EQUAL_INT32(window < 2 ? window : 2, state.windows);
        const int32_t bound_mrad_s = wait(1);
        TEST_ASSERT_EQUAL_INT32(window == 0 ? 70000 : 25132, bound_mrad_s);
    }
}

/* 71 808 - 71 808/8 = 62 832: 16 transitions in 800 periods. */
void test_a_window_an_eighth_slower_counts_at_once_and_a_slower_one_does_not(void)
{
    for (int beyond = 0; beyond < 2; beyond++) {
        setUp();
        lose_sensor_and_short();
        (void)transitions(16, 700, 20000);
        TEST_ASSERT_EQUAL_INT32(SPEED_OF_700_mrad_s, transitions(16, 700, 20000));
        TEST_ASSERT_EQUAL_INT32(beyond == 0 ? 62832 : SPEED_OF_700_mrad_s,
                                transitions(16, 800 + beyond, 20000));
    }
}

void test_two_valid_windows_in_a_row_make_a_speed(void)
{
    lose_sensor_and_short();
    (void)transitions(16, 700, 9000000);
    (void)transitions(16, 700, 20000);
    TEST_ASSERT_EQUAL_INT64(70000000 - COASTING_urad_s, state.bound_urad_s);
    TEST_ASSERT_EQUAL_INT32(SPEED_OF_700_mrad_s, transitions(16, 700, 20000));
    (void)transitions(16, 700, 9000000);
    TEST_ASSERT_EQUAL_INT64(SPEED_OF_700_mrad_s * 1000 - COASTING_urad_s, state.bound_urad_s);
}

void test_a_short_circuit_begins_without_the_windows_of_the_one_before(void)
{
    lose_sensor_and_short();
    (void)transitions(16, 2000, 20000);
    TEST_ASSERT_EQUAL_INT32(25132, transitions(16, 2000, 20000));
    (void)transitions(10, 100, 20000); /* and half of a third */
    (void)wait(50);
    in.report.bridge = BRIDGE_OFF;
    in.now.latest_i_d_mA = 0;
    in.now.speed_mrad_s = 70000;
    in.now.angle_valid = true;
    (void)wait(5);
    lose_sensor_and_short();
    (void)wait(99);
    TEST_ASSERT_EQUAL_INT32(0, state.windows);
    (void)wait(1);
    TEST_ASSERT_EQUAL_INT32(1, state.windows);
    TEST_ASSERT_EQUAL_INT64(70000000, state.bound_urad_s);
    (void)wait(99);
    TEST_ASSERT_EQUAL_INT64(70000000, state.bound_urad_s);
    (void)wait(1); /* two windows without a current: standstill */
    TEST_ASSERT_EQUAL_INT64(0, state.bound_urad_s);
}

/* ---- thresholds ---- */

/* At the silence there is no current, above it one quarter turn in 2000 periods may be missed:
 * 15 708 * 20 000/(10 * 2000 * 10) mrad/s. Offsets that are not known are another silence. */
void test_current_above_the_silence_is_no_standstill(void)
{
    for (int known = 0; known < 2; known++) {
        for (int above = 0; above < 2; above++) {
            setUp();
            in.report.offsets_done = known != 0;
            lose_sensor_and_short();
            in.now.latest_i_q_mA = -(known != 0 ? 1 : 2) * SILENCE_mA - above;
            TEST_ASSERT_EQUAL_INT32(above == 0 ? 0 : 1570, wait(200));
        }
    }
}

/* 71.808 rad/s are an EMF of 14.3616 V: twice that at 0.1 ohm is 287.232 A, and at the reactance of
 * 0.2 mH, 0.143616 ohm, 200 A. The volts are whole millivolts, rounded down. */
void test_current_up_to_twice_what_the_speed_drives_fits(void)
{
    static const struct {
        int32_t r_uOhm, l_nH, fits_mA, beyond_mA;
    } CASES[] = {{100000, 10000, 287220, 287240}, {1000, 200000, 199990, 200010}};
    for (int n = 0; n < 2; n++) {
        for (int beyond = 0; beyond < 2; beyond++) {
            setUp();
            config.motor.phase_resistance_uOhm = CASES[n].r_uOhm;
            config.motor.d_inductance_nH = CASES[n].l_nH;
            lose_sensor_and_short();
            const int32_t current_mA = beyond != 0 ? CASES[n].beyond_mA : CASES[n].fits_mA;
            (void)transitions(16, 700, current_mA);
            (void)transitions(16, 700, current_mA);
            TEST_ASSERT_EQUAL_INT64(beyond != 0 ? 70000000 - COASTING_urad_s
                                                : SPEED_OF_700_mrad_s * 1000,
                                    state.bound_urad_s);
        }
    }
}

/* ---- diodes ---- */

/* 1.02 v/(sqrt(3) psi p): 2 % beyond the speed at which the EMF reaches the bus. */
static int32_t bus_speed_mrad_s(void)
{
    return (int32_t)lround(1.02 * in.now.bus_voltage_mV / (sqrt(3.0) * 0.02 * 10.0));
}

static void freewheel(bool valid, int32_t mrad_s, int32_t current_mA)
{
    in.report.bridge = BRIDGE_OFF;
    in.now.angle_valid = valid;
    in.now.speed_mrad_s = mrad_s;
    in.now.latest_i_d_mA = current_mA;
}

void test_a_diode_current_shows_the_speed_of_the_bus_whatever_an_invalid_sensor_shows(void)
{
    freewheel(false, 50000, 2 * SILENCE_mA);
    TEST_ASSERT_EQUAL_INT32(50000, wait(19));
    TEST_ASSERT_INT32_WITHIN(1, bus_speed_mrad_s(), wait(1));
}

void test_a_valid_sensor_beyond_the_hand_over_speed_applies_in_either_direction(void)
{
    for (int32_t sign = -1; sign <= 1; sign += 2) {
        setUp();
        freewheel(true, sign * 50000, 2 * SILENCE_mA);
        TEST_ASSERT_EQUAL_INT32(50000, wait(100));
    }
}

void test_a_step_with_pwm_begins_the_qualification_again(void)
{
    freewheel(false, 0, 2 * SILENCE_mA);
    (void)wait(19);
    in.report.bridge = BRIDGE_PWM;
    (void)wait(1);
    in.report.bridge = BRIDGE_OFF;
    TEST_ASSERT_EQUAL_INT32(0, wait(19));
    TEST_ASSERT_INT32_WITHIN(1, bus_speed_mrad_s(), wait(1));
}

/* Another wheel, or this one, raised the bus while switching: in freewheel it still has to be
 * looked at. */
void test_an_overvoltage_that_began_while_switching_raises_the_bound_in_freewheel(void)
{
    in.now.angle_valid = false;
    in.now.bus_voltage_mV = config.battery.overvoltage_trip_mV + 1;
    TEST_ASSERT_EQUAL_INT32(0, wait(10));
    in.report.bridge = BRIDGE_OFF;
    TEST_ASSERT_INT32_WITHIN(1, bus_speed_mrad_s(), wait(1));
}

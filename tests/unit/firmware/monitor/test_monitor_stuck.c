/* SPDX-License-Identifier: Apache-2.0 */
/* Side of a switch stuck closed, from half waves made by hand: a period each, 20 in a step. */
#include "monitor/monitor_stuck.h"

#include <math.h>

#include "monitor_case.h"
#include "unity.h"

extern const config_t CONFIG_LU2013, CONFIG_IPM400V;

enum { PERIODS = 20 };
static const double TWO_PI = 6.283185307179586;

static config_t motor;
static monitor_stuck_state_t state;
static monitor_case_t in;
static bool turning;
static monitor_stuck_output_t out;
static double turns;

void setUp(void)
{
    const monitor_stuck_state_t fresh = {.side = BRIDGE_OFF};
    const monitor_case_t tripped = {.report = {.offsets_done = true, .bridge = BRIDGE_OFF},
                                    .now = {.trip = REASON_HARDWARE_BREAK, .angle_valid = true}};
    motor = CONFIG_LU2013;
    state = fresh;
    in = tripped;
    turning = false;
    turns = 0.1;
}

void tearDown(void) {}

/* Of the currents: as they should be, or not. */
static void set_sum(bool good)
{
    in.report.current_sum_pu = CONFIG_LU2013.monitor.current_sum_pu_q15 + (good ? 0 : 1);
}

static void add(double a, double b, double c)
{
    in.report.idle_alpha_pu += (uint32_t)(int32_t)lround((2.0 * a - b - c) / 3.0);
    in.report.idle_beta_pu += (uint32_t)(int32_t)lround((b - c) / 1.7320508075688772);
    in.report.sequence++;
}

/* phase 0 .. 2 or -1, healthy: three sines. Low side stuck: the other two carry the positive half
 * waves of their sine, this one brings both back; high side: all negative. */
static void milliseconds(int count, double hz, double peak_pu, int phase, bool high)
{
    const double sign = high ? -1.0 : 1.0;
    in.now.speed_mrad_s = (int32_t)lround(TWO_PI * hz * 1000.0 / CONFIG_LU2013.motor.pole_pairs);
    for (int n = 0; n < count; n++) {
        for (int k = 0; k < PERIODS; k++) {
            turns += hz / 1000.0 / PERIODS;
            double i[3];
            double back = 0.0;
            for (int x = 0; x < 3; x++) {
                i[x] = peak_pu * sin(TWO_PI * (turns - x / 3.0));
                if (phase >= 0 && x != phase) {
                    i[x] = sign * fmax(sign * i[x], 0.0);
                    back -= i[x];
                }
            }
            if (phase >= 0) {
                i[phase] = back;
            }
            add(i[0], i[1], i[2]);
        }
        out = monitor_stuck_step(&state, &motor, measured_of(&in), turning);
    }
}

static double trip_pu(void)
{
    return CONFIG_LU2013.monitor.overcurrent_pu_q15;
}

void test_half_waves_of_any_phase_tell_the_side_within_two_turns(void)
{
    static const double HZ[] = {10.0, 40.0, 163.0, 420.0, 700.0};
    for (unsigned n = 0; n < sizeof(HZ) / sizeof(HZ[0]); n++) {
        for (int phase = 0; phase < 3; phase++) {
            for (int high = 0; high < 2; high++) {
                setUp();
                turns = 0.17 * phase + 0.3 * high;
                milliseconds((int)ceil(2000.0 / HZ[n]) + 1, HZ[n], trip_pu(), phase, high != 0);
                TEST_ASSERT_EQUAL_INT(high != 0 ? BRIDGE_SHORT_HIGH : BRIDGE_SHORT, out.side);
            }
        }
    }
}

/* The diodes of an open bridge above the EMF limit: a symmetrical current at its limit. */
void test_a_healthy_rectified_current_has_no_side(void)
{
    const double limit_pu = CONFIG_LU2013.current_loop.max_current_pu_q15;
    for (int hz = 5; hz < 1500; hz += 7) {
        setUp();
        turns = hz * 0.37;
        milliseconds(60, hz, limit_pu, -1, false);
        TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, out.side);
        TEST_ASSERT_FALSE(out.release_break);
    }
}

void test_no_side_without_a_trip_while_switching_or_with_a_sensor_in_question(void)
{
    for (int reason = 0; reason < 5; reason++) {
        setUp();
        in.now.trip = reason != 0 ? REASON_HARDWARE_BREAK : REASON_NONE;
        in.report.bridge = reason == 1 ? BRIDGE_PWM : BRIDGE_OFF;
        in.report.offsets_done = reason != 2;
        in.now.angle_valid = reason != 3;
        set_sum(reason != 4);
        milliseconds(200, 40.0, 2.0 * trip_pu(), 1, false);
        TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, out.side);
    }
}

/* Half waves beyond the sensors' range do not add up in parts of a turn. */
void test_a_sum_that_is_good_now_and_then_is_enough(void)
{
    int steps = 0;
    while (out.side == BRIDGE_OFF && steps < 30) {
        set_sum(steps % 3 == 0);
        milliseconds(1, 163.0, trip_pu(), 2, true);
        steps++;
    }
    TEST_ASSERT_EQUAL_INT(BRIDGE_SHORT_HIGH, out.side);
    TEST_ASSERT_TRUE(steps <= 14);
}

/* After the 5 ms, (L_d + L_q)/R, in which a short circuit's own direct current decays. */
void test_a_commanded_short_circuit_has_a_side_after_three_equal_windows(void)
{
    in.report.bridge = BRIDGE_SHORT;
    milliseconds(18, 163.0, trip_pu(), 0, true);
    TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, out.side);
    milliseconds(12, 163.0, trip_pu(), 0, true);
    TEST_ASSERT_EQUAL_INT(BRIDGE_SHORT_HIGH, out.side);
}

/* With windings of next to no resistance, 152 uH over 0.1 mohm, for a second at most. */
void test_the_direct_current_of_a_short_circuit_is_waited_for_no_longer_than_a_second(void)
{
    motor.motor.phase_resistance_uOhm = 100;
    in.report.bridge = BRIDGE_SHORT;
    milliseconds(MONITOR_STUCK_LONGEST_STEPS, 163.0, trip_pu(), 0, true);
    TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, out.side);
    milliseconds(30, 163.0, trip_pu(), 0, true);
    TEST_ASSERT_EQUAL_INT(BRIDGE_SHORT_HIGH, out.side);
}

void test_the_latch_is_released_for_ten_steps_and_the_side_stays_until_acknowledged(void)
{
    int released = 0;
    for (int n = 0; n < 100; n++) {
        milliseconds(1, 163.0, trip_pu(), 0, false);
        released += out.release_break ? 1 : 0;
        in.report.bridge = out.side == BRIDGE_OFF ? BRIDGE_OFF : BRIDGE_SHORT;
    }
    TEST_ASSERT_EQUAL_INT(MONITOR_STUCK_RELEASE_STEPS, released);
    milliseconds(500, 163.0, 0.0, -1, false);
    TEST_ASSERT_EQUAL_INT(BRIDGE_SHORT, out.side);
    in.now.trip = REASON_NONE;
    milliseconds(1, 0.0, 0.0, -1, false);
    TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, out.side);
}

/* ipm400v at its largest speed, 550 Hz, shorted from full braking: the flux of the windings stands
 * still in the stator and decays with 2 L_d L_q/(R (L_d + L_q)) = 31 ms, seventeen turns. Up to
 * twice the largest phase current of it, at any angle. */
void test_a_short_circuit_whose_direct_current_lasts_for_many_turns_has_no_side(void)
{
    const config_t *config = &CONFIG_IPM400V;
    const double l_d = config->motor.d_inductance_nH;
    const double l_q = config->motor.q_inductance_nH;
    const double decay_ms = 2.0 * l_d * l_q / (l_d + l_q) / config->motor.phase_resistance_uOhm;
    const double settled_pu =
        32768.0 * config->motor.flux_linkage_nWb / l_d * 1e3 / config->drive.current_full_scale_mA;
    const double begin_pu =
        2.0 * 32768.0 * config->motor.max_phase_current_mA / config->drive.current_full_scale_mA;
    for (int angle = 0; angle < 12; angle++) {
        setUp();
        in.report.bridge = BRIDGE_SHORT;
        in.now.speed_mrad_s = config->motor.max_speed_mrad_s;
        const double turns_ms = in.now.speed_mrad_s * 1e-6 * config->motor.pole_pairs / TWO_PI;
        for (int n = 0; n < 300; n++) {
            for (int k = 0; k < 10; k++) {
                const double ms = n + k / 10.0;
                const double dc_pu = begin_pu * exp(-ms / decay_ms);
                double i[3];
                for (int x = 0; x < 3; x++) {
                    i[x] = settled_pu * cos(TWO_PI * (turns_ms * ms - x / 3.0)) +
                           dc_pu * cos(TWO_PI * (angle / 12.0 - x / 3.0));
                }
                add(i[0], i[1], i[2]);
            }
            out = monitor_stuck_step(&state, config, measured_of(&in), turning);
            TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, out.side);
        }
    }
}

/* Any input: a side only with a trip or while the wheel turns, and no undefined behaviour. */
void test_extreme_inputs_are_harmless(void)
{
    static const int32_t SPEEDS[] = {INT32_MIN, -1, 0, 1, INT32_MAX};
    for (unsigned n = 0; n < 5000; n++) {
        in.now.trip = n % 7 != 0 ? REASON_HARDWARE_BREAK : REASON_NONE;
        turning = n % 3 == 0;
        in.now.speed_mrad_s = SPEEDS[n % 5];
        in.report.idle_alpha_pu = n * 2654435761U;
        in.report.idle_beta_pu = n * 40503U * 65537U;
        in.report.sequence = (uint16_t)(n * 977U);
        out = monitor_stuck_step(&state, &CONFIG_LU2013, measured_of(&in), turning);
        TEST_ASSERT_TRUE(in.now.trip != REASON_NONE || turning || out.side == BRIDGE_OFF);
        TEST_ASSERT_TRUE(in.now.trip != REASON_NONE || !out.release_break);
        TEST_ASSERT_NOT_EQUAL_INT(BRIDGE_PWM, out.side);
    }
}

/* ---- Without a trip: a wheel that coasts with the bridge off ---- */

void test_half_waves_of_a_coasting_wheel_tell_the_side_until_it_is_at_rest(void)
{
    for (int phase = 0; phase < 3; phase++) {
        for (int high = 0; high < 2; high++) {
            setUp();
            in.now.trip = REASON_NONE;
            turning = true;
            milliseconds(60, 40.0, 1.2 * trip_pu(), phase, high != 0);
            TEST_ASSERT_EQUAL_INT(high != 0 ? BRIDGE_SHORT_HIGH : BRIDGE_SHORT, out.side);
            TEST_ASSERT_FALSE(out.release_break); /* there is no latch */
            in.report.bridge = out.side;
            milliseconds(100, 40.0, 0.0, -1, false);
            TEST_ASSERT_EQUAL_INT(in.report.bridge, out.side);
            turning = false;
            milliseconds(1, 0.0, 0.0, -1, false);
            TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, out.side);
        }
    }
}

void test_without_a_trip_only_a_bridge_that_is_off_is_watched(void)
{
    static const bridge_mode_t MODES[] = {BRIDGE_PWM, BRIDGE_SHORT, BRIDGE_SHORT_HIGH};
    for (int k = 0; k < 3; k++) {
        setUp();
        in.now.trip = REASON_NONE;
        turning = true;
        in.report.bridge = MODES[k];
        milliseconds(2000, 40.0, 1.2 * trip_pu(), 0, false);
        TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, out.side);
    }
}

/* Two sensors, the third phase computed: a constant and its opposite, their sum always right. */
void test_a_sensor_that_shows_a_constant_is_no_stuck_switch(void)
{
    for (int shown = 0; shown < 3; shown++) {
        for (int sign = -1; sign <= 1; sign += 2) {
            setUp();
            in.now.trip = REASON_NONE;
            turning = true;
            in.now.speed_mrad_s = 5000;
            for (int n = 0; n < 2000; n++) {
                double i[3] = {0.0, 0.0, 0.0};
                i[shown] = sign * trip_pu();
                i[(shown + 1) % 3] = -sign * trip_pu();
                for (int k = 0; k < PERIODS; k++) {
                    add(i[0], i[1], i[2]);
                }
                out = monitor_stuck_step(&state, &motor, measured_of(&in), turning);
                TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, out.side);
            }
        }
    }
}

/* The short circuit's own direct current fills most of the turn in which it ends. */
void test_short_circuit_that_ends_within_a_turn_is_no_stuck_switch(void)
{
    for (int shorted_ms = 1; shorted_ms < 30; shorted_ms++) {
        setUp();
        in.now.speed_mrad_s =
            (int32_t)lround(TWO_PI * 40.0 * 1000.0 / CONFIG_LU2013.motor.pole_pairs);
        for (int ms = 0; ms < 100; ms++) {
            in.report.bridge = ms < shorted_ms ? BRIDGE_SHORT : BRIDGE_OFF;
            const double direct_pu = ms < shorted_ms ? trip_pu() : 0.0;
            for (int k = 0; k < PERIODS; k++) {
                add(direct_pu, -0.5 * direct_pu, -0.5 * direct_pu);
            }
            out = monitor_stuck_step(&state, &CONFIG_LU2013, measured_of(&in), turning);
            TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, out.side);
        }
    }
}

/* A sum that is never right names no side, however long the windows agree. */
void test_windows_that_agree_for_ever_are_counted_without_overflow(void)
{
    set_sum(false);
    milliseconds(100, 40.0, trip_pu(), 0, false);
    TEST_ASSERT_GREATER_THAN_INT32(1, state.windows);
    state.windows = INT32_MAX;
    milliseconds(200, 40.0, trip_pu(), 0, false);
    TEST_ASSERT_GREATER_OR_EQUAL_INT32(1, state.windows);
    TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, out.side);
}

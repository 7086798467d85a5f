/* SPDX-License-Identifier: Apache-2.0 */
/* Side of a stuck switch by the windows of its sums, made by hand: one electrical turn in each
 * step, of one pole pair and 6284 mrad; a trip current of 4096, so that a mean above 1024 has a
 * side. */
#include "monitor/monitor_stuck.h"

#include <math.h>

#include "monitor_case.h"
#include "paper_vehicle.h"
#include "unity.h"

enum { PERIODS = 20, TURN_mrad = 6284, QUARTER_pu = 1024 };

static config_t config;
static monitor_stuck_state_t state;
static monitor_case_t in;
static bool turning;

void setUp(void)
{
    const monitor_stuck_state_t fresh = {.side = BRIDGE_OFF};
    const monitor_case_t tripped = {.report = {.offsets_done = true, .bridge = BRIDGE_OFF},
                                    .now = {.trip = REASON_HARDWARE_BREAK, .angle_valid = true}};
    config = paper_vehicle();
    config.motor.pole_pairs = 1;
    config.monitor.overcurrent_pu_q15 = 4 * QUARTER_pu;
    state = fresh;
    in = tripped;
    turning = false;
}

void tearDown(void) {}

/* Of the currents: as they should be, or not. */
static void set_sum(bool good)
{
    in.report.current_sum_pu = config.monitor.current_sum_pu_q15 + (good ? 0 : 1);
}

/* A step in which the rotor turns by so much and the sums of alpha and beta grow by so much. */
static bridge_mode_t add(int32_t turn_mrad, int64_t alpha_pu, int64_t beta_pu)
{
    in.now.speed_mrad_s = turn_mrad * 1000;
    in.report.idle_alpha_pu += (uint32_t)alpha_pu;
    in.report.idle_beta_pu += (uint32_t)beta_pu;
    in.report.sequence = (uint16_t)(in.report.sequence + PERIODS);
    return monitor_stuck_step(&state, &config, measured_of(&in), turning).side;
}

/* A whole turn with a mean of alpha: the window ends. */
static bridge_mode_t turn(int32_t mean_alpha_pu)
{
    return add(TURN_mrad, (int64_t)mean_alpha_pu * PERIODS, 0);
}

void test_a_mean_above_a_quarter_of_the_trip_current_has_a_side(void)
{
    for (int sign = -1; sign <= 1; sign += 2) {
        for (int above = 0; above < 2; above++) {
            setUp();
            const bridge_mode_t side = sign > 0 ? BRIDGE_SHORT_HIGH : BRIDGE_SHORT;
            TEST_ASSERT_EQUAL_INT(above != 0 ? side : BRIDGE_OFF,
                                  add(TURN_mrad, sign * (QUARTER_pu * PERIODS + above), 0));
        }
    }
}

/* Means M, -M/8 and -7/8 M: 6144 alpha = 14192 beta in units of 1024. A sensor that shows a
 * constant, the third phase computed, has M, 0 and -M. */
void test_each_of_the_other_phases_brings_back_an_eighth_at_least(void)
{
    const int64_t k = 1 + (int64_t)QUARTER_pu * PERIODS / 14192;
    for (int sign = -1; sign <= 1; sign += 2) {
        const bridge_mode_t side = sign > 0 ? BRIDGE_SHORT_HIGH : BRIDGE_SHORT;
        for (int turned = -1; turned <= 1; turned += 2) {
            setUp();
            TEST_ASSERT_EQUAL_INT(side, add(TURN_mrad, sign * 14192 * k, turned * 6144 * k));
            setUp();
            TEST_ASSERT_EQUAL_INT(BRIDGE_OFF,
                                  add(TURN_mrad, sign * 14192 * k, turned * (6144 * k + 1)));
        }
        setUp();
        TEST_ASSERT_EQUAL_INT(BRIDGE_OFF,
                              add(TURN_mrad, sign * INT64_C(887000), INT64_C(512000) * sign));
    }
}

void test_a_window_without_periods_has_no_side(void)
{
    in.now.speed_mrad_s = 2 * TURN_mrad * 1000;
    for (int n = 0; n < 10; n++) {
        TEST_ASSERT_EQUAL_INT(BRIDGE_OFF,
                              monitor_stuck_step(&state, &config, measured_of(&in), turning).side);
    }
}

void test_a_window_is_a_whole_turn_in_either_direction(void)
{
    for (int sign = -1; sign <= 1; sign += 2) {
        setUp();
        (void)turn(0); /* a window that begins again at zero */
        const int32_t much = 4 * QUARTER_pu * PERIODS;
        TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, add(sign * (TURN_mrad - 1), much, 0));
        TEST_ASSERT_EQUAL_INT(BRIDGE_SHORT_HIGH, add(sign * 1, 0, 0));
        TEST_ASSERT_EQUAL_INT32(0, state.turned_mrad);
    }
}

/* 25 mrad a step: in 249 steps 59 mrad are left, in 250 steps 34. */
void test_a_window_is_at_most_250_steps_long(void)
{
    for (int longer = 0; longer < 2; longer++) {
        setUp();
        (void)turn(0);
        for (int n = 0; n < MONITOR_STUCK_STEPS - 1 + longer; n++) {
            (void)add(25, 4 * QUARTER_pu * PERIODS, 0);
        }
        TEST_ASSERT_EQUAL_INT(longer != 0 ? BRIDGE_OFF : BRIDGE_SHORT_HIGH,
                              add(longer != 0 ? 34 : 59, 4 * QUARTER_pu * PERIODS, 0));
    }
}

/* Not in more than three quarters of the steps: one of four is enough, one of five is not. In the
 * window before all were plausible. */
void test_a_quarter_of_plausible_sums_is_enough(void)
{
    for (int steps = 4; steps <= 5; steps++) {
        setUp();
        for (int n = 0; n < 8; n++) {
            (void)add(TURN_mrad / 8 + 1, 0, 0);
        }
        for (int n = 1; n <= steps; n++) {
            set_sum(n == 2);
            (void)add(n == steps ? TURN_mrad : 1, 4 * QUARTER_pu * PERIODS, 0);
        }
        TEST_ASSERT_EQUAL_INT(steps == 4 ? BRIDGE_SHORT_HIGH : BRIDGE_OFF, state.side);
    }
}

/* ---- a commanded short circuit ---- */

/* Steps until a commanded short circuit has a side; one turn, one window a step. */
static int steps_to_side(void)
{
    in.report.bridge = BRIDGE_SHORT;
    int steps = 0;
    while (turn(4 * QUARTER_pu) == BRIDGE_OFF && steps < 2000) {
        steps++;
    }
    return steps;
}

void test_the_decay_is_waited_for_1000_steps(void)
{
    config.motor.phase_resistance_uOhm = 1;
    config.motor.d_inductance_nH = 1000000;
    config.motor.q_inductance_nH = 1000000;
    TEST_ASSERT_EQUAL_INT(MONITOR_STUCK_LONGEST_STEPS + MONITOR_STUCK_SHORT_WINDOWS - 1,
                          steps_to_side());
    (void)turn(0);
    TEST_ASSERT_EQUAL_INT32(MONITOR_STUCK_LONGEST_STEPS, state.same_steps);
}

void test_windows_of_a_short_circuit_that_is_left_count_no_more(void)
{
    config.motor.phase_resistance_uOhm = 1000000;
    in.report.bridge = BRIDGE_SHORT;
    (void)turn(4 * QUARTER_pu);
    (void)turn(4 * QUARTER_pu);
    (void)turn(4 * QUARTER_pu);
    in.report.offsets_done = false;
    TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, turn(4 * QUARTER_pu));
    in.report.offsets_done = true;
    TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, turn(4 * QUARTER_pu));
    TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, turn(4 * QUARTER_pu));
    TEST_ASSERT_EQUAL_INT(BRIDGE_SHORT_HIGH, turn(4 * QUARTER_pu));
}

void test_the_latch_is_released_once(void)
{
    TEST_ASSERT_EQUAL_INT(BRIDGE_SHORT_HIGH, turn(4 * QUARTER_pu));
    for (int n = 0; n < 100; n++) {
        const monitor_stuck_output_t out =
            monitor_stuck_step(&state, &config, measured_of(&in), turning);
        TEST_ASSERT_EQUAL_INT(n < MONITOR_STUCK_RELEASE_STEPS - 1, out.release_break);
    }
    TEST_ASSERT_EQUAL_INT32(0, state.release_steps);
    in.now.trip = REASON_NONE;
    (void)monitor_stuck_step(&state, &config, measured_of(&in), turning);
    TEST_ASSERT_EQUAL_INT32(0, state.release_steps);
}

/* SPDX-License-Identifier: Apache-2.0 */
/* The steps of a round of available_ahead, each from a given table of limits, to the unit. A
 * low-pass of an eighth and a lead of 92/32 make a change of 800 into 700 * 92/32 = 2012 ahead. On
 * ramps of whole drives: test_available_ahead.c. */
#include <string.h>

#include "available_ahead_rig.h"
#include "motor/loss_maps.h"
#include "paper_vehicle.h"
#include "unity.h"

enum { MOST = 1 << 25, FASTEST_mrad_s = 67021 / 4 * 5 };
enum { INPUTS, BRAKING, SOLVE_BRAKING, DRIVING, SOLVE_DRIVING, STRATEGY, OTHERS, RESULTS };

static config_t config;
static motor_constants_t motor;
static torque_limits_t limits;
static available_ahead_state_t state;
static available_inputs_t in;

void setUp(void)
{
    config = paper_vehicle();
    config.brake.strategy = CONFIG_STRATEGY_SERIES_OPTIMAL;
    motor_constants_init(&motor, &config);
    memset(&limits, 0, sizeof limits);
    for (int line = 0; line < TORQUE_LINE_COUNT; line++) {
        limits.driving[line] = limit_init(FEASIBLE_UNBOUNDED, REASON_NONE);
        limits.braking[line] = limit_init(FEASIBLE_UNBOUNDED, REASON_NONE);
    }
    limits.losses.returned.power_b = MOST; /* a battery that sets no bound */
    limits.drawn_b = MOST;
    memset(&in, 0, sizeof in);
    in.phase_voltage_mV = 28000;
    in.winding_temperature_cC = 2500;
    in.switch_temperature_cC = 2500;
    memset(&state, 0x5A, sizeof state);
    available_ahead_init(&state);
}

void tearDown(void) {}

/* One step of the round, whatever came before. */
static void phase(uint32_t number)
{
    state.step = 2 * number;
    ahead_step(&state, &motor, &config, &limits, &in);
    TEST_ASSERT_EQUAL_UINT32((2 * number + 1) % AVAILABLE_AHEAD_ROUND_steps, state.step);
}

static void assert_limit(int32_t torque_mNm, reason_t reason, limit_t limit)
{
    TEST_ASSERT_EQUAL_INT32(torque_mNm, limit.torque_mNm);
    TEST_ASSERT_EQUAL_INT(reason, limit.reason);
}

static void assert_fresh(const available_slope_t *slope)
{
    TEST_ASSERT_TRUE(!slope->known && slope->value == 0 && slope->low_passed_q3 == 0);
}

void test_a_start_leaves_no_number_of_before(void)
{
    const available_slope_t *slopes[] = {&state.speed,    &state.voltage,  &state.winding,
                                         &state.switches, &state.returned, &state.drawn};
    for (int n = 0; n < 6; n++) {
        assert_fresh(slopes[n]);
    }
    for (int n = 0; n < AVAILABLE_SLOPED_LINES; n++) {
        assert_fresh(&state.driving[n]);
        assert_fresh(&state.braking[n]);
    }
    for (int line = 0; line < TORQUE_LINE_COUNT; line++) {
        assert_limit(FEASIBLE_UNBOUNDED, REASON_NONE, state.driving_lines[line]);
        assert_limit(FEASIBLE_UNBOUNDED, REASON_NONE, state.braking_lines[line]);
    }
    TEST_ASSERT_EQUAL_UINT32(0, state.step);
    TEST_ASSERT_EQUAL_INT32(0, state.expected.speed_mrad_s);
    TEST_ASSERT_EQUAL_INT32(0, state.expected.phase_voltage_mV);
    TEST_ASSERT_EQUAL_INT32(0, state.expected.brake_torque_mNm);
    TEST_ASSERT_EQUAL_INT32(0, state.returned_b);
    TEST_ASSERT_EQUAL_INT32(0, state.drawn_b);
    assert_limit(0, REASON_TORQUE_ENABLE, state.now.driving);
    assert_limit(0, REASON_TORQUE_ENABLE, state.now.braking);
    assert_limit(0, REASON_TORQUE_ENABLE, state.ahead.driving);
    assert_limit(0, REASON_TORQUE_ENABLE, state.ahead.braking);
}

/* Every other step is idle; a round ends with its results. */
void test_a_round_takes_16_steps(void)
{
    limits.driving[TORQUE_LINE_MAX_TORQUE] = limit_init(40000, REASON_MAX_TORQUE);
    limits.braking[TORQUE_LINE_MAX_TORQUE] = limit_init(40000, REASON_MAX_TORQUE);
    in.speed_mrad_s = 5000;
    for (uint32_t n = 0; n < AVAILABLE_AHEAD_ROUND_steps; n++) {
        TEST_ASSERT_EQUAL_UINT32(n, state.step);
        TEST_ASSERT_EQUAL_INT32(n <= 14 ? 0 : 40000, state.now.driving.torque_mNm);
        in.speed_mrad_s = n == 0 ? 5000 : 9000; /* read in the first step only */
        ahead_step(&state, &motor, &config, &limits, &in);
        TEST_ASSERT_EQUAL_INT32(5000, state.speed.value);
    }
    TEST_ASSERT_EQUAL_UINT32(0, state.step);
    assert_limit(40000, REASON_MAX_TORQUE, state.now.braking);
    assert_limit(40000, REASON_MAX_TORQUE, state.ahead.driving);
}

/* ---- inputs ---- */

static int32_t speed_after(int32_t first_mrad_s, int32_t second_mrad_s)
{
    available_ahead_init(&state);
    in.speed_mrad_s = first_mrad_s;
    phase(INPUTS);
    TEST_ASSERT_EQUAL_INT32(q_limit(first_mrad_s, MOST), state.expected.speed_mrad_s);
    in.speed_mrad_s = second_mrad_s;
    phase(INPUTS);
    return state.expected.speed_mrad_s;
}

void test_the_expected_speed_follows_its_slope_and_never_through_zero(void)
{
    TEST_ASSERT_EQUAL_INT32(10800 + 2012, speed_after(10000, 10800));
    TEST_ASSERT_EQUAL_INT32(-10800 - 2013, speed_after(-10000, -10800)); /* rounded down */
    TEST_ASSERT_EQUAL_INT32(10000 - 2013, speed_after(10800, 10000));
    TEST_ASSERT_EQUAL_INT32(0, speed_after(10000, 2000));
    TEST_ASSERT_EQUAL_INT32(0, speed_after(-10000, -2000));
    TEST_ASSERT_EQUAL_INT32(1, speed_after(1, 1));
    TEST_ASSERT_EQUAL_INT32(-1, speed_after(-1, -1));
    TEST_ASSERT_EQUAL_INT32(0, speed_after(1000, 0)); /* a wheel that stands is to stand */
    TEST_ASSERT_EQUAL_INT32(0, speed_after(-1000, 0));
}

void test_the_expected_speed_ends_a_quarter_beyond_the_highest_or_at_the_present_one(void)
{
    TEST_ASSERT_EQUAL_INT32(FASTEST_mrad_s, speed_after(30000, 67000));
    TEST_ASSERT_EQUAL_INT32(-FASTEST_mrad_s, speed_after(-30000, -67000));
    TEST_ASSERT_EQUAL_INT32(100000, speed_after(50000, 100000));
    TEST_ASSERT_EQUAL_INT32(MOST, speed_after(INT32_MAX, INT32_MAX));
    TEST_ASSERT_EQUAL_INT32(MOST, speed_after(MOST - 8000, INT32_MAX));
    TEST_ASSERT_EQUAL_INT32(-MOST, speed_after(INT32_MIN, INT32_MIN));
}

/* A voltage rises from zero to 2^25 and back as any other does; beyond it is that. */
void test_the_expected_voltage_follows_its_slope_from_zero_to_the_largest_number(void)
{
    in.phase_voltage_mV = 28000;
    phase(INPUTS);
    TEST_ASSERT_EQUAL_INT32(28000, state.expected.phase_voltage_mV);
    in.phase_voltage_mV = 28800;
    phase(INPUTS);
    TEST_ASSERT_EQUAL_INT32(28800 + 2012, state.expected.phase_voltage_mV);
    in.phase_voltage_mV = 0;
    phase(INPUTS);
    TEST_ASSERT_EQUAL_INT32(0, state.expected.phase_voltage_mV);
    in.phase_voltage_mV = INT32_MAX;
    phase(INPUTS);
    TEST_ASSERT_EQUAL_INT32(MOST, state.voltage.value);
    TEST_ASSERT_EQUAL_INT32(MOST, state.expected.phase_voltage_mV);
}

/* Half a kelvin in a round; 50 cC after an eighth are 44, and 126 ahead. */
static void assert_temperature(const int32_t *expected_cC, int32_t *given_cC)
{
    static const int32_t CHANGES_cC[][2] = {{50, 50 + 126}, {-50, -50 - 124}, {51, 51}, {-51, -51}};
    for (int n = 0; n < 4; n++) {
        available_ahead_init(&state);
        *given_cC = 2000;
        phase(INPUTS);
        *given_cC = 2000 + CHANGES_cC[n][0];
        phase(INPUTS);
        TEST_ASSERT_EQUAL_INT32(2000 + CHANGES_cC[n][1], *expected_cC);
    }
}

void test_temperatures_follow_their_slope_unless_they_step(void)
{
    assert_temperature(&state.expected.winding_temperature_cC, &in.winding_temperature_cC);
    assert_temperature(&state.expected.switch_temperature_cC, &in.switch_temperature_cC);
}

void test_powers_of_the_battery_follow_their_slope_from_zero_on(void)
{
    limits.losses.returned.power_b = 1000000;
    limits.drawn_b = 500000;
    phase(INPUTS);
    TEST_ASSERT_EQUAL_INT32(1000000, state.returned_b);
    TEST_ASSERT_EQUAL_INT32(500000, state.drawn_b);
    limits.losses.returned.power_b = 1000800;
    limits.drawn_b = 500800;
    phase(INPUTS);
    TEST_ASSERT_EQUAL_INT32(1000800 + 2012, state.returned_b);
    TEST_ASSERT_EQUAL_INT32(500800 + 2012, state.drawn_b);
    limits.losses.returned.power_b = 0;
    limits.drawn_b = 0;
    phase(INPUTS);
    TEST_ASSERT_EQUAL_INT32(0, state.returned_b);
    TEST_ASSERT_EQUAL_INT32(0, state.drawn_b);
    limits.losses.returned.power_b = INT32_MAX;
    limits.drawn_b = INT32_MAX;
    phase(INPUTS);
    TEST_ASSERT_EQUAL_INT32(MOST, state.returned_b);
    TEST_ASSERT_EQUAL_INT32(MOST, state.drawn_b);
}

void test_the_demand_counts_from_zero_on(void)
{
    in.brake_torque_mNm = 1234;
    phase(INPUTS);
    TEST_ASSERT_EQUAL_INT32(1234, state.expected.brake_torque_mNm);
    in.brake_torque_mNm = -5;
    phase(INPUTS);
    TEST_ASSERT_EQUAL_INT32(0, state.expected.brake_torque_mNm);
}

/* ---- lines with a slope ---- */

static const torque_line_t SLOPED[] = {TORQUE_LINE_MAX_POWER, TORQUE_LINE_PHASE_CURRENT,
                                       TORQUE_LINE_VOLTAGE, TORQUE_LINE_DRAWN,
                                       TORQUE_LINE_RETURNED};

/* The table's value of a line; loss braking makes the braking bound of returned power. */
static void give(bool drives, torque_line_t line, int32_t torque_mNm)
{
    limit_t *const lines = drives ? limits.driving : limits.braking;
    lines[line] = limit_init(torque_mNm, REASON_VOLTAGE);
    if (!drives && line == TORQUE_LINE_RETURNED) {
        limits.losses.by_map_mNm = torque_mNm;
        limits.losses.torque_mNm = 0;
        lines[line].torque_mNm = torque_mNm == FEASIBLE_UNBOUNDED ? torque_mNm : 77;
    }
}

static limit_t *expected_of(bool drives, torque_line_t line)
{
    return drives ? &state.driving_lines[line] : &state.braking_lines[line];
}

static int32_t carried_mNm(bool drives, torque_line_t line, int32_t torque_mNm)
{
    give(drives, line, torque_mNm);
    phase(drives ? DRIVING : BRAKING);
    return expected_of(drives, line)->torque_mNm;
}

void test_bounds_follow_their_slope_unless_they_step_by_a_16th_of_the_largest_torque(void)
{
    limits.losses.by_map_mNm = FEASIBLE_UNBOUNDED;
    for (int n = 0; n < 10; n++) {
        const bool drives = n % 2 != 0;
        const torque_line_t line = SLOPED[n / 2];
        TEST_ASSERT_EQUAL_INT32(20000, carried_mNm(drives, line, 20000));
        TEST_ASSERT_EQUAL_INT32(20800 + 2012, carried_mNm(drives, line, 20800));
        assert_limit(20800 + 2012, REASON_VOLTAGE, *expected_of(drives, line));
        available_ahead_init(&state);
        (void)carried_mNm(drives, line, 20000);
        /* 2500 less 313 are 2188 behind, 6290 ahead */
        TEST_ASSERT_EQUAL_INT32(22500 + 6290, carried_mNm(drives, line, 22500));
        available_ahead_init(&state);
        (void)carried_mNm(drives, line, 20000);
        TEST_ASSERT_EQUAL_INT32(22501, carried_mNm(drives, line, 22501));
        available_ahead_init(&state);
        (void)carried_mNm(drives, line, 2000);
        TEST_ASSERT_EQUAL_INT32(0, carried_mNm(drives, line, 0)); /* not below zero */
        give(drives, line, FEASIBLE_UNBOUNDED);
        available_ahead_init(&state);
    }
}

/* A bound that was expected begins with the slope that leads there: 3220 N m are 161 times 20. */
void test_a_bound_that_was_expected_comes_as_expected(void)
{
    limits.losses.by_map_mNm = FEASIBLE_UNBOUNDED;
    for (int n = 0; n < 10; n++) {
        const bool drives = n % 2 != 0;
        const torque_line_t line = SLOPED[n / 2];
        expected_of(drives, line)->torque_mNm = 5000000 + 3220000;
        TEST_ASSERT_EQUAL_INT32(5000000 + 3220000, carried_mNm(drives, line, 5000000));
        give(drives, line, FEASIBLE_UNBOUNDED);
        phase(drives ? DRIVING : BRAKING); /* there is none: no slope is left of it */
        TEST_ASSERT_EQUAL_INT32(5000000 + 3220000, expected_of(drives, line)->torque_mNm);
        expected_of(drives, line)->torque_mNm = 5000000 - 3220000;
        TEST_ASSERT_EQUAL_INT32(5000000 - 3220000, carried_mNm(drives, line, 5000000));
        give(drives, line, FEASIBLE_UNBOUNDED);
        phase(drives ? DRIVING : BRAKING);
        expected_of(drives, line)->torque_mNm = MOST;
        TEST_ASSERT_INT32_WITHIN(1000, MOST, carried_mNm(drives, line, 20000));
        give(drives, line, FEASIBLE_UNBOUNDED);
        phase(drives ? DRIVING : BRAKING);
        expected_of(drives, line)->torque_mNm = MOST + 1; /* none was expected */
        TEST_ASSERT_EQUAL_INT32(20000, carried_mNm(drives, line, 20000));
        give(drives, line, FEASIBLE_UNBOUNDED);
        available_ahead_init(&state);
    }
}

/* ---- other lines and results ---- */

void test_lines_without_a_slope_are_the_present_ones(void)
{
    static const torque_line_t PRESENT[] = {TORQUE_LINE_MAX_TORQUE, TORQUE_LINE_ROTOR,
                                            TORQUE_LINE_ENABLE, TORQUE_LINE_CURRENT_GAIN,
                                            TORQUE_LINE_ABS};
    enum { COUNT = sizeof PRESENT / sizeof PRESENT[0] };
    for (int n = 0; n < COUNT; n++) {
        limits.driving[PRESENT[n]] = limit_init(100 + n, REASON_ABS);
        limits.braking[PRESENT[n]] = limit_init(200 + n, REASON_TORQUE_ENABLE);
    }
    state.expected.speed_mrad_s = 66900;
    state.expected.winding_temperature_cC = config.motor.derate_winding_temperature_cC + 300;
    state.expected.switch_temperature_cC = config.drive.derate_switch_temperature_cC + 200;
    phase(OTHERS);
    for (int n = 0; n < COUNT; n++) {
        assert_limit(100 + n, REASON_ABS, state.driving_lines[PRESENT[n]]);
        assert_limit(200 + n, REASON_TORQUE_ENABLE, state.braking_lines[PRESENT[n]]);
    }
    const limit_t winding = torque_limits_winding(&config, state.expected.winding_temperature_cC);
    const limit_t switches = torque_limits_switch(&config, state.expected.switch_temperature_cC);
    const limit_t speed = torque_limits_max_speed(&config, 66900);
    assert_limit(winding.torque_mNm, winding.reason, state.driving_lines[TORQUE_LINE_WINDING]);
    assert_limit(winding.torque_mNm, winding.reason, state.braking_lines[TORQUE_LINE_WINDING]);
    assert_limit(switches.torque_mNm, switches.reason, state.driving_lines[TORQUE_LINE_SWITCH]);
    assert_limit(switches.torque_mNm, switches.reason, state.braking_lines[TORQUE_LINE_SWITCH]);
    assert_limit(speed.torque_mNm, speed.reason, state.driving_lines[TORQUE_LINE_MAX_SPEED]);
    TEST_ASSERT_EQUAL_INT32(FEASIBLE_UNBOUNDED,
                            state.braking_lines[TORQUE_LINE_MAX_SPEED].torque_mNm);
    TEST_ASSERT_LESS_THAN_INT32(40000, winding.torque_mNm);
    TEST_ASSERT_LESS_THAN_INT32(40000, speed.torque_mNm);
}

/* The first and the last line of each side alone. */
void test_results_are_the_tightest_lines_of_both_sides_now_and_then(void)
{
    limit_t *const sides[] = {limits.driving, limits.braking, state.driving_lines,
                              state.braking_lines};
    const limit_t *const results[] = {&state.now.driving, &state.now.braking, &state.ahead.driving,
                                      &state.ahead.braking};
    const torque_line_t ends[] = {TORQUE_LINE_MAX_TORQUE, TORQUE_LINE_ABS};
    for (int n = 0; n < 8; n++) {
        limit_t *const line = &sides[n / 2][ends[n % 2]];
        const limit_t before = *line;
        *line = limit_init(1000 + n, REASON_ABS);
        phase(RESULTS);
        for (int side = 0; side < 4; side++) {
            const bool own = side == n / 2;
            assert_limit(own ? 1000 + n : FEASIBLE_UNBOUNDED, own ? REASON_ABS : REASON_NONE,
                         *results[side]);
        }
        *line = before;
    }
}

/* The optimum's map between the present and the expected speed and temperature, upon the line. */
void test_the_loss_optimum_moves_as_its_map_does(void)
{
    limits.braking[TORQUE_LINE_LOSS_OPTIMUM] = limit_init(60000, REASON_LOSS_OPTIMUM);
    state.speed.value = 20000;
    state.winding.value = 2500;
    state.expected.speed_mrad_s = 12000;
    state.expected.winding_temperature_cC = 6000;
    state.expected.brake_torque_mNm = 30000;
    phase(STRATEGY);
    const int32_t change_mNm =
        loss_maps_torque_mNm(&config, 12000, 6000) - loss_maps_torque_mNm(&config, 20000, 2500);
    TEST_ASSERT_NOT_EQUAL_INT32(0, change_mNm);
    TEST_ASSERT_EQUAL_INT32(60000 + change_mNm,
                            state.braking_lines[TORQUE_LINE_LOSS_OPTIMUM].torque_mNm);
    limits.braking[TORQUE_LINE_LOSS_OPTIMUM].torque_mNm = FEASIBLE_UNBOUNDED;
    phase(STRATEGY);
    TEST_ASSERT_EQUAL_INT32(FEASIBLE_UNBOUNDED,
                            state.braking_lines[TORQUE_LINE_LOSS_OPTIMUM].torque_mNm);
}

/* SPDX-License-Identifier: Apache-2.0 */
/* Which bounds available_ahead solves at the expected speed and voltage, and with which cap. What
 * the solved bounds are: feasible_torque, whose tests compare it with the circuit. */
#include <string.h>

#include "available_ahead_rig.h"
#include "paper_vehicle.h"
#include "unity.h"

enum { MOST = 1 << 25, SOLVE_BRAKING = 2, SOLVE_DRIVING = 4, SOLVED_LATER_mNm = 12345 };

static config_t config;
static motor_constants_t motor;
static motor_model_t model;
static feasible_set_t set;
static torque_limits_t limits;
static available_ahead_state_t state;
static const available_inputs_t IN = {.speed_mrad_s = 0};

static void expect(int32_t speed_mrad_s, int32_t phase_voltage_mV)
{
    state.expected.speed_mrad_s = speed_mrad_s;
    state.expected.phase_voltage_mV = phase_voltage_mV;
    state.expected.winding_temperature_cC = 2500;
    model = motor_model_at(&motor, &config, speed_mrad_s, 2500);
    set = feasible_set_at(&model, phase_voltage_mV);
}

/* 54 rad/s at 20 V: the current's circle bounds the torque of either side, of a motor of 50 N m. */
void setUp(void)
{
    config = paper_vehicle();
    config.motor.max_torque_mNm = 50000;
    motor_constants_init(&motor, &config);
    memset(&limits, 0, sizeof limits);
    available_ahead_init(&state);
    for (int line = 0; line < TORQUE_LINE_COUNT; line++) {
        limits.driving[line] = limit_init(FEASIBLE_UNBOUNDED, REASON_NONE);
        limits.braking[line] = limit_init(FEASIBLE_UNBOUNDED, REASON_NONE);
    }
    expect(54000, 20000);
}

void tearDown(void) {}

static void solve(side_t sign)
{
    state.step = 2 * (sign == SIDE_DRIVING ? SOLVE_DRIVING : SOLVE_BRAKING);
    ahead_step(&state, &motor, &config, &limits, &IN);
}

static limit_t *now_of(side_t sign)
{
    return sign == SIDE_DRIVING ? limits.driving : limits.braking;
}

static limit_t *expected_of(side_t sign)
{
    return sign == SIDE_DRIVING ? state.driving_lines : state.braking_lines;
}

static torque_line_t battery_of(side_t sign)
{
    return sign == SIDE_DRIVING ? TORQUE_LINE_DRAWN : TORQUE_LINE_RETURNED;
}

/* The bound by the battery's power of a side up to a cap. */
static int32_t by_battery_mNm(side_t sign, int32_t cap_mNm, bool with_ends)
{
    feasible_side_t side = feasible_side_at(&set, sign, cap_mNm);
    if (with_ends) {
        feasible_circle_t circle = {.known = false};
        (void)feasible_by_voltage_and_current(&side, &circle);
    }
    const feasible_returned_t returned = {.power_b = state.returned_b};
    return sign == SIDE_DRIVING ? feasible_by_drawn_mNm(&side, state.drawn_b)
                                : feasible_by_returned_mNm(&side, returned);
}

/* The power of the battery that bounds a side at about such a torque. */
static void battery_bounds_at(side_t sign, int32_t torque_mNm, bool with_ends)
{
    int32_t low_b = 0;
    int32_t high_b = MOST;
    while (high_b - low_b > 1) {
        const int32_t b = (low_b + high_b) / 2;
        state.drawn_b = b;
        state.returned_b = b;
        const bool below = by_battery_mNm(sign, 200000, with_ends) < torque_mNm;
        low_b = below ? b : low_b;
        high_b = below ? high_b : b;
    }
}

static const side_t SIDES[] = {SIDE_DRIVING, SIDE_BRAKING};

/* At 42 rad/s and 12 V there is no torque at all within the voltage. */
void test_of_an_unbounded_side_the_ends_and_the_battery_are_solved(void)
{
    for (int n = 0; n < 4; n++) {
        const side_t sign = SIDES[n % 2];
        setUp();
        battery_bounds_at(sign, 5000, true);
        if (n >= 2) {
            expect(42000, 12000);
        }
        const limit_t *lines = expected_of(sign);
        feasible_side_t side = feasible_side_at(&set, sign, config.motor.max_torque_mNm);
        feasible_circle_t circle = {.known = false};
        const feasible_bounds_t ends = feasible_by_voltage_and_current(&side, &circle);
        solve(sign);
        TEST_ASSERT_EQUAL_INT32(ends.voltage_mNm, lines[TORQUE_LINE_VOLTAGE].torque_mNm);
        TEST_ASSERT_EQUAL_INT32(ends.current_mNm, lines[TORQUE_LINE_PHASE_CURRENT].torque_mNm);
        TEST_ASSERT_EQUAL_INT32(by_battery_mNm(sign, config.motor.max_torque_mNm, true),
                                lines[battery_of(sign)].torque_mNm);
        if (n < 2) {
            TEST_ASSERT_LESS_THAN_INT32(config.motor.max_torque_mNm, ends.current_mNm);
            TEST_ASSERT_INT32_WITHIN(100, 5000, lines[battery_of(sign)].torque_mNm);
        } else {
            TEST_ASSERT_EQUAL_INT32(0, ends.voltage_mNm);
        }
    }
}

/* Lines that are not solved anew and have no bound now: none is expected of them, while another
 * one's stays. */
void test_lines_without_a_bound_now_have_none_expected(void)
{
    for (int n = 0; n < 2; n++) {
        setUp();
        limit_t *const now = now_of(SIDES[n]);
        limit_t *const lines = expected_of(SIDES[n]);
        now[TORQUE_LINE_VOLTAGE] = limit_init(30000, REASON_VOLTAGE);
        now[battery_of(SIDES[n])] = limit_init(30000, REASON_DISCHARGE_CURRENT);
        now[TORQUE_LINE_MAX_POWER] = limit_init(MOST, REASON_MAX_POWER);
        for (int line = 0; line < TORQUE_LINE_COUNT; line++) {
            lines[line] = limit_init(SOLVED_LATER_mNm, REASON_NONE);
        }
        solve(SIDES[n]);
        for (int line = 0; line < TORQUE_LINE_COUNT; line++) {
            const torque_line_t other =
                SIDES[1 - n] == SIDE_DRIVING ? TORQUE_LINE_DRAWN : TORQUE_LINE_RETURNED;
            const bool none = line == TORQUE_LINE_PHASE_CURRENT || line == (int)other;
            TEST_ASSERT_EQUAL_INT32(none ? FEASIBLE_UNBOUNDED : SOLVED_LATER_mNm,
                                    lines[line].torque_mNm);
        }
        now[TORQUE_LINE_MAX_POWER] = limit_init(MOST + 1, REASON_MAX_POWER);
        solve(SIDES[n]);
        TEST_ASSERT_EQUAL_INT32(FEASIBLE_UNBOUNDED, lines[TORQUE_LINE_MAX_POWER].torque_mNm);
    }
}

/* Where one of the ends bounds the torque now, the battery is solved up to what is expected of
 * them, or the largest torque or power: a bound below, and none above. */
static void assert_capped(side_t sign, torque_line_t end, int32_t expected_mNm,
                          int32_t max_power_mNm, int32_t max_torque_mNm)
{
    const int32_t cap_mNm = q_min(q_min(expected_mNm, max_power_mNm), max_torque_mNm);
    for (int above = 0; above < 2; above++) {
        setUp();
        expect(30000, 20000);
        battery_bounds_at(sign, above != 0 ? cap_mNm + 1500 : cap_mNm - 1500, false);
        config.motor.max_torque_mNm = max_torque_mNm;
        limit_t *const lines = expected_of(sign);
        now_of(sign)[end] = limit_init(30000, REASON_VOLTAGE);
        lines[end].torque_mNm = expected_mNm;
        now_of(sign)[TORQUE_LINE_MAX_POWER] = limit_init(max_power_mNm, REASON_MAX_POWER);
        lines[TORQUE_LINE_MAX_POWER].torque_mNm = max_power_mNm;
        solve(sign);
        TEST_ASSERT_EQUAL_INT32(by_battery_mNm(sign, cap_mNm, false),
                                lines[battery_of(sign)].torque_mNm);
        TEST_ASSERT_TRUE((lines[battery_of(sign)].torque_mNm == FEASIBLE_UNBOUNDED) ==
                         (above != 0));
        TEST_ASSERT_EQUAL_INT32(expected_mNm, lines[end].torque_mNm);
    }
}

void test_the_battery_is_solved_up_to_the_torque_that_is_left(void)
{
    for (int n = 0; n < 2; n++) {
        assert_capped(SIDES[n], TORQUE_LINE_VOLTAGE, 6000, FEASIBLE_UNBOUNDED, 50000);
        assert_capped(SIDES[n], TORQUE_LINE_PHASE_CURRENT, 6000, FEASIBLE_UNBOUNDED, 50000);
        assert_capped(SIDES[n], TORQUE_LINE_VOLTAGE, 20000, 7000, 50000);
        assert_capped(SIDES[n], TORQUE_LINE_VOLTAGE, 20000, FEASIBLE_UNBOUNDED, 6000);
    }
}

/* A step solves one bound more than the table of limits has solved of the other side and the
 * battery; the ends of the side itself and its battery's bound in one step are too much as well. */
void test_bounds_are_solved_in_steps_that_have_effort_left(void)
{
    for (int n = 0; n < 64; n++) {
        const side_t sign = SIDES[n % 2];
        const side_t other = SIDES[1 - n % 2];
        const torque_line_t end = n / 2 % 2 != 0 ? TORQUE_LINE_VOLTAGE : TORQUE_LINE_PHASE_CURRENT;
        const bool own_ends = n / 4 % 2 != 0;
        const bool other_ends = n / 8 % 2 != 0;
        const bool own_battery = n / 16 % 2 != 0;
        const bool other_battery = n / 32 % 2 != 0;
        setUp();
        battery_bounds_at(sign, 5000, true);
        limit_t *const lines = expected_of(sign);
        if (own_ends) {
            now_of(sign)[end] = limit_init(30000, REASON_VOLTAGE);
            lines[end].torque_mNm = 20000;
        }
        if (other_ends) {
            now_of(other)[end] = limit_init(30000, REASON_VOLTAGE);
        }
        if (own_battery) {
            now_of(sign)[battery_of(sign)] = limit_init(30000, REASON_CHARGE_CURRENT);
            lines[battery_of(sign)].torque_mNm = SOLVED_LATER_mNm;
        }
        if (other_battery) {
            now_of(other)[battery_of(other)] = limit_init(30000, REASON_CHARGE_CURRENT);
        }
        const int others = (other_ends ? 1 : 0) + (own_battery ? 1 : 0) + (other_battery ? 1 : 0);
        const bool solves = others <= 1 && !(own_ends && own_battery);
        solve(sign);
        const torque_line_t ends = TORQUE_LINE_PHASE_CURRENT;
        if (!own_ends) {
            TEST_ASSERT_TRUE((lines[ends].torque_mNm != FEASIBLE_UNBOUNDED) == solves);
        }
        if (own_battery) {
            TEST_ASSERT_EQUAL_INT32(SOLVED_LATER_mNm, lines[battery_of(sign)].torque_mNm);
        } else {
            TEST_ASSERT_TRUE((lines[battery_of(sign)].torque_mNm != FEASIBLE_UNBOUNDED) == solves);
        }
    }
}

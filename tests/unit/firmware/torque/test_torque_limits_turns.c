/* SPDX-License-Identifier: Apache-2.0 */
/*
 * What a step of the table solves: the demanded side in every step, of the other one circle and
 * ellipse in step 1 of 8 and the battery's lines in step 3; and up to which torque.
 */
#include "torque_limits_rig.h"
#include "unity.h"

enum { SPEED_mrad_s = 30000, STALE_mNm = 12345 };

static const torque_line_t ENDS[] = {TORQUE_LINE_PHASE_CURRENT, TORQUE_LINE_VOLTAGE};
static const torque_line_t BATTERY[] = {TORQUE_LINE_DRAWN, TORQUE_LINE_RETURNED,
                                        TORQUE_LINE_RETURNED_PEAK};
static torque_limits_t whole; /* both sides in one step */

static void step(side_t demanded, torque_limits_state_t *used, torque_limits_t *out)
{
    const motor_model_t model = model_at(&config, SPEED_mrad_s, winding_temperature_cC);
    const feasible_set_t set = feasible_set_at(&model, phase_mV);
    conditions.demanded = demanded;
    torque_limits_case_step(used, &set, &conditions, out);
}

/* Limits of the battery on both sides, of which a peak. */
void setUp(void)
{
    rig_up(paper_vehicle_without_i_d());
    config.brake.loss_braking = 0;
    conditions.bms_charge_current_mA = 40000;
    conditions.bms_charge_peak_mA = 60000;
    conditions.bms_discharge_current_mA = 40000;
    torque_limits_state_t copy = state;
    whole = table;
    step(SIDE_BOTH, &copy, &whole);
    TEST_ASSERT_GREATER_THAN_INT32(whole.braking[TORQUE_LINE_RETURNED].torque_mNm,
                                   whole.braking[TORQUE_LINE_RETURNED_PEAK].torque_mNm);
    TEST_ASSERT_NOT_EQUAL_INT32(FEASIBLE_UNBOUNDED, whole.driving[TORQUE_LINE_DRAWN].torque_mNm);
    state.turn.step = 0;
    table.driving[TORQUE_LINE_RETURNED] = whole.driving[TORQUE_LINE_RETURNED];
}

void tearDown(void) {}

static void make_stale(limit_t *lines)
{
    for (int k = 0; k < 2; k++) {
        lines[ENDS[k]] = limit_init(STALE_mNm, REASON_NONE);
    }
    for (int k = 0; k < 3; k++) {
        lines[BATTERY[k]] = limit_init(STALE_mNm, REASON_NONE);
    }
}

static void assert_solved(bool solved, torque_line_t line, const limit_t *lines,
                          const limit_t *expected)
{
    TEST_ASSERT_EQUAL_INT32(solved ? expected[line].torque_mNm : STALE_mNm, lines[line].torque_mNm);
}

static void assert_lines(bool ends, bool battery, bool braking)
{
    const limit_t *const lines = braking ? table.braking : table.driving;
    const limit_t *const expected = braking ? whole.braking : whole.driving;
    for (int k = 0; k < 2; k++) {
        assert_solved(ends, ENDS[k], lines, expected);
    }
    assert_solved(battery, TORQUE_LINE_DRAWN, lines, expected);
    assert_solved(battery && braking, TORQUE_LINE_RETURNED, lines, expected);
    assert_solved(battery && braking, TORQUE_LINE_RETURNED_PEAK, lines, expected);
}

static void step_from_stale(side_t demanded)
{
    make_stale(table.driving);
    make_stale(table.braking);
    step(demanded, &state, &table);
}

void test_the_side_without_a_demand_is_solved_in_two_steps_of_eight(void)
{
    for (int n = 0; n < 2 * TORQUE_LIMITS_TURN_steps; n++) {
        const int turn = n % TORQUE_LIMITS_TURN_steps;
        const bool braking = n >= TORQUE_LIMITS_TURN_steps;
        step_from_stale(braking ? SIDE_BRAKING : SIDE_DRIVING);
        assert_lines(true, true, braking);
        assert_lines(turn == 1, turn == 3, !braking);
    }
}

void test_both_sides_are_solved_in_every_step_if_both_are_demanded(void)
{
    for (int n = 0; n < TORQUE_LIMITS_TURN_steps; n++) {
        step_from_stale(SIDE_BOTH);
        assert_lines(true, true, false);
        assert_lines(true, true, true);
    }
}

/* The cap that step 1 has left is of the side that had no demand then. */
void test_a_side_whose_demand_ends_between_waits_for_the_next_turn(void)
{
    for (int n = 0; n < TORQUE_LIMITS_TURN_steps; n++) {
        step_from_stale(n < 2 ? SIDE_DRIVING : SIDE_BRAKING);
    }
    for (int n = 0; n < 4; n++) {
        step_from_stale(n < 2 ? SIDE_DRIVING : SIDE_BRAKING);
    }
    assert_lines(true, true, true);
    assert_lines(false, false, false);
}

/* ---- the cap ---- */

/* Phase current for 0.7038 N m/A: 35 N m of 50 A. */
static void assert_current_line_is_open(int32_t max_torque_mNm, int32_t power_torque_mNm)
{
    config.motor.max_phase_current_mA = 50000;
    config.motor.max_torque_mNm = max_torque_mNm;
    config.motor.max_power_mW = power_torque_mNm * (SPEED_mrad_s / 1000);
    step_from_stale(SIDE_BOTH);
    TEST_ASSERT_EQUAL_INT32(max_torque_mNm, table.driving[TORQUE_LINE_MAX_TORQUE].torque_mNm);
    TEST_ASSERT_EQUAL_INT32(power_torque_mNm, table.driving[TORQUE_LINE_MAX_POWER].torque_mNm);
    const int32_t least_mNm = q_min(max_torque_mNm, power_torque_mNm);
    for (int side = 0; side < 2; side++) {
        const limit_t *const lines = side == 0 ? table.driving : table.braking;
        const int32_t found_mNm = lines[TORQUE_LINE_PHASE_CURRENT].torque_mNm;
        if (least_mNm < 30000) {
            TEST_ASSERT_EQUAL_INT32(FEASIBLE_UNBOUNDED, found_mNm);
        } else {
            TEST_ASSERT_INT32_WITHIN(3000, 35000, found_mNm);
        }
    }
}

void test_no_bound_beyond_largest_torque_and_power_is_solved(void)
{
    assert_current_line_is_open(80000, 80000);
    assert_current_line_is_open(80000, 20000);
    assert_current_line_is_open(20000, 80000);
}

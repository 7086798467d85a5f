/* SPDX-License-Identifier: Apache-2.0 */
/* The table of torque limits as a table: what the smallest bound of each line does, alone. */
#include <string.h>

#include "core/scaled.h"
#include "torque/torque_limits.h"
#include "unity.h"

static limit_t lines[TORQUE_LINE_COUNT];

void setUp(void)
{
    for (int k = 0; k < TORQUE_LINE_COUNT; k++) {
        lines[k] = limit_init(FEASIBLE_UNBOUNDED, REASON_NONE);
    }
}

void tearDown(void) {}

/* What falls at once; design: a device, the bus or the driver's safety is at stake. */
static bool is_hard(int line)
{
    return line == TORQUE_LINE_MAX_TORQUE || line == TORQUE_LINE_MAX_POWER ||
           line == TORQUE_LINE_PHASE_CURRENT || line == TORQUE_LINE_VOLTAGE ||
           line == TORQUE_LINE_RETURNED_PEAK || line == TORQUE_LINE_ROTOR ||
           line == TORQUE_LINE_ENABLE || line == TORQUE_LINE_ABS;
}

void test_every_line_has_its_class(void)
{
    for (int k = 0; k < TORQUE_LINE_COUNT; k++) {
        TEST_ASSERT_EQUAL_INT(!is_hard(k), torque_limits_deferrable((torque_line_t)k));
    }
    TEST_ASSERT_FALSE(torque_limits_deferrable(TORQUE_LINE_COUNT));
    TEST_ASSERT_FALSE(torque_limits_deferrable((torque_line_t)(1 << 30)));
}

/* One bound at a time; the share of a parallel brake follows the demand and is in no class. */
void test_each_bound_is_in_one_class(void)
{
    for (int k = 0; k < TORQUE_LINE_COUNT; k++) {
        setUp();
        lines[k].torque_mNm = 1000 + k;
        const int32_t hard_mNm = is_hard(k) ? 1000 + k : FEASIBLE_UNBOUNDED;
        const bool deferrable = !is_hard(k) && k != TORQUE_LINE_ELECTRIC_SHARE;
        const int32_t deferrable_mNm = deferrable ? 1000 + k : FEASIBLE_UNBOUNDED;
        const torque_limits_classes_t all = torque_limits_classes(lines);
        TEST_ASSERT_EQUAL_INT32(hard_mNm, all.hard_mNm);
        TEST_ASSERT_EQUAL_INT32(deferrable_mNm, all.deferrable_mNm);
    }
}

/* Every line has another bound, in both orders: the least of each class. */
void test_the_tightest_bound_of_each_class_wins(void)
{
    for (int falling = 0; falling < 2; falling++) {
        int32_t hard_mNm = FEASIBLE_UNBOUNDED;
        int32_t deferrable_mNm = FEASIBLE_UNBOUNDED;
        for (int k = 0; k < TORQUE_LINE_COUNT; k++) {
            lines[k].torque_mNm = 5000 + (falling != 0 ? -100 * k : 100 * k);
            int32_t *const least_mNm = is_hard(k) ? &hard_mNm : &deferrable_mNm;
            const bool counts = k != TORQUE_LINE_ELECTRIC_SHARE;
            *least_mNm =
                counts && lines[k].torque_mNm < *least_mNm ? lines[k].torque_mNm : *least_mNm;
        }
        const torque_limits_classes_t all = torque_limits_classes(lines);
        TEST_ASSERT_EQUAL_INT32(hard_mNm, all.hard_mNm);
        TEST_ASSERT_EQUAL_INT32(deferrable_mNm, all.deferrable_mNm);
    }
}

void test_tightest_line_is_the_first_of_the_least(void)
{
    for (int k = 0; k < TORQUE_LINE_COUNT; k++) {
        setUp();
        lines[k] = limit_init(700, REASON_ABS);
        if (k + 1 < TORQUE_LINE_COUNT) { /* a tie */
            lines[k + 1] = limit_init(700, REASON_VOLTAGE);
        }
        TEST_ASSERT_EQUAL_INT(k, torque_limits_tightest_line(lines));
        const limit_t whole = torque_limits_tightest(lines, (torque_line_t)0, TORQUE_LINE_COUNT);
        TEST_ASSERT_EQUAL_INT32(700, whole.torque_mNm);
        TEST_ASSERT_EQUAL_INT(REASON_ABS, whole.reason);
        const limit_t part =
            torque_limits_tightest(lines, (torque_line_t)0, TORQUE_LINE_LOSS_OPTIMUM);
        const bool within = k < TORQUE_LINE_LOSS_OPTIMUM;
        TEST_ASSERT_EQUAL_INT32(within ? 700 : FEASIBLE_UNBOUNDED, part.torque_mNm);
        TEST_ASSERT_EQUAL_INT(within ? REASON_ABS : REASON_NONE, part.reason);
    }
}

/* Equal counts, one more does not. */
void test_first_line_of_at_most_a_torque(void)
{
    lines[3] = limit_init(900, REASON_VOLTAGE);
    lines[5] = limit_init(800, REASON_ABS);
    lines[7] = limit_init(700, REASON_MAX_SPEED);
    TEST_ASSERT_EQUAL_INT(REASON_VOLTAGE, torque_limits_at_most(lines, 900).reason);
    TEST_ASSERT_EQUAL_INT(REASON_ABS, torque_limits_at_most(lines, 899).reason);
    TEST_ASSERT_EQUAL_INT(REASON_ABS, torque_limits_at_most(lines, 800).reason);
    TEST_ASSERT_EQUAL_INT32(700, torque_limits_at_most(lines, 799).torque_mNm);
}

/* Whatever the memory held. */
void test_a_table_begins_without_bounds_and_without_folding_back(void)
{
    static torque_limits_state_t state;
    static torque_limits_t table;
    memset(&state, 0x5A, sizeof state);
    memset(&table, 0x5A, sizeof table);
    torque_limits_init(&state, &table);
    for (int k = 0; k < TORQUE_LINE_COUNT; k++) {
        TEST_ASSERT_EQUAL_INT32(FEASIBLE_UNBOUNDED, table.driving[k].torque_mNm);
        TEST_ASSERT_EQUAL_INT32(FEASIBLE_UNBOUNDED, table.braking[k].torque_mNm);
        TEST_ASSERT_EQUAL_INT(REASON_NONE, table.driving[k].reason);
        TEST_ASSERT_EQUAL_INT(REASON_NONE, table.braking[k].reason);
    }
    TEST_ASSERT_EQUAL_INT32(0, table.losses.current_b);
    TEST_ASSERT_EQUAL_INT32(0, table.drawn_b);
    TEST_ASSERT_EQUAL_INT32(SCALED_ONE, state.charge.allowed_q24);
    TEST_ASSERT_EQUAL_INT32(SCALED_ONE, state.discharge.allowed_q24);
    TEST_ASSERT_EQUAL_INT32(0, state.abs_hold_steps);
    TEST_ASSERT_EQUAL_INT32(FEASIBLE_UNBOUNDED, table.losses.by_map_mNm);
    TEST_ASSERT_EQUAL_STRING("ABS", torque_limits_line_text(TORQUE_LINE_ABS));
}

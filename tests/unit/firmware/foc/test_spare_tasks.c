/* SPDX-License-Identifier: Apache-2.0 */
/* When field weakening, the observer's acquisition and the look for frozen readings are due, and
 * for what they wait. */
#include "spare_tasks.h"

#include "foc_rig.h"

void setUp(void)
{
    rig_up();
}

void tearDown(void) {}

void test_next_is_the_following_multiple_of_four(void)
{
    static const uint32_t NEXT[][2] = {{0, 4}, {3, 4}, {4, 8}, {7, 8}, {UINT32_MAX, 0}};
    for (int k = 0; k < 5; k++) {
        TEST_ASSERT_EQUAL_UINT32(NEXT[k][1], spare_tasks_next(NEXT[k][0]));
    }
}

/* Whatever a flipped bit makes of it. */
void test_due_within_four_periods_of_a_setpoint(void)
{
    static const uint32_t DUE[][2] = {{99, 101},  {100, 101}, {101, 101},
                                      {104, 104}, {105, 101}, {100 + 0x80000000U, 101}};
    for (int k = 0; k < 6; k++) {
        TEST_ASSERT_EQUAL_UINT32(DUE[k][1], spare_tasks_after_setpoint(DUE[k][0], 100));
    }
    TEST_ASSERT_EQUAL_UINT32(2, spare_tasks_after_setpoint(2, UINT32_MAX)); /* counts wrap */
}

void test_every_fourth_period_acquires_the_angle(void)
{
    for (uint32_t n = 1; n <= 8; n++) {
        step(true);
        TEST_ASSERT_EQUAL_UINT32(n / 4 * 4, foc.observer.periods);
    }
}

static const uint8_t FORWARD[6] = {5, 1, 3, 2, 6, 4};

/* Due in period 4, and from then on until it is done. busy: bit n for period n; in those there is a
 * new setpoint, or a hall edge. Returns the period of the first acquisition, or of the second. */
static uint32_t period_of_acquisition(uint32_t busy, bool edges, uint32_t which)
{
    rig_up();
    config.rotor.sensor = edges ? CONFIG_ROTOR_HALL : CONFIG_ROTOR_ANGLE;
    restart();
    uint32_t sector = 0;
    for (uint32_t n = 1; n <= 20; n++) {
        const bool now = (busy >> n & 1U) != 0;
        sector += now ? 1U : 0U;
        if (now && !edges) {
            setpoint.sequence++;
        }
        in.hall_state = FORWARD[sector % 6U];
        step(true);
        if (foc.observer.periods == which * SPARE_TASKS_PERIODS) {
            return n;
        }
    }
    return 0;
}

void test_wait_while_there_are_setpoints_or_hall_edges(void)
{
    static const uint32_t FIRST[][2] = {{0, 4},       {1U << 3, 4},  {1U << 4, 5},
                                        {1U << 5, 4}, {3U << 4, 6},  {5U << 4, 5},
                                        {7U << 3, 6}, {15U << 4, 8}, {31U << 4, 9}};
    for (int k = 0; k < 9; k++) {
        TEST_ASSERT_EQUAL_UINT32(FIRST[k][1], period_of_acquisition(FIRST[k][0], false, 1));
        TEST_ASSERT_EQUAL_UINT32(FIRST[k][1], period_of_acquisition(FIRST[k][0], true, 1));
    }
}

void test_delay_does_not_add_up(void)
{
    for (int edges = 0; edges <= 1; edges++) {
        TEST_ASSERT_EQUAL_UINT32(8, period_of_acquisition(3U << 4, edges != 0, 2));
        TEST_ASSERT_EQUAL_UINT32(9, period_of_acquisition(1U << 8, edges != 0, 2));
        TEST_ASSERT_EQUAL_UINT32(12, period_of_acquisition(15U << 4, edges != 0, 2));
    }
}

/* Period 4 or 8; the start's setpoint, in the first period after the idle ones, comes before. */
void test_first_of_a_start_is_in_the_next_fourth_period(void)
{
    static const uint32_t FIRST[5] = {0, 4, 4, 5, 8};
    for (uint32_t idle = 1; idle <= 4; idle++) {
        restart();
        for (uint32_t n = 0; n < idle; n++) {
            step(false);
        }
        while (foc.observer.periods == 0) {
            step(true);
        }
        TEST_ASSERT_EQUAL_UINT32(FIRST[idle], foc.period.step_count);
    }
}

/* The error calls for a look each time. */
void test_look_for_frozen_readings_comes_a_period_before_the_other_tasks(void)
{
    setpoint.i_reference_pu.q = 600 * 16;
    for (uint32_t n = 1; n <= 13; n++) {
        step(true);
        TEST_ASSERT_EQUAL_UINT32(n / 4 * 4, foc.current.frozen.last_step);
        TEST_ASSERT_EQUAL_UINT32((n - 1) / 4 * 4, foc.observer.periods);
    }
}

static void steps(uint32_t periods)
{
    for (uint32_t n = 0; n < periods; n++) {
        step(true);
    }
}

/* A look that was late by one period is no reason to leave the next one out; by two it is. The
 * setpoints keep it waiting. */
void test_look_comes_three_periods_after_the_last_one_at_the_earliest(void)
{
    for (uint32_t late = 1; late <= 2; late++) {
        rig_up();
        setpoint.i_reference_pu.q = 600 * 16;
        steps(3);
        for (uint32_t n = 0; n < late; n++) {
            setpoint.sequence++;
            setpoint.i_reference_pu.q += 10; /* not shaped: applied once */
            step(true);
        }
        TEST_ASSERT_EQUAL_UINT32(0, foc.current.frozen.last_step);
        step(true);
        TEST_ASSERT_EQUAL_UINT32(4 + late, foc.current.frozen.last_step);
        steps(4 - late);
        TEST_ASSERT_EQUAL_UINT32(8, foc.period.step_count);
        TEST_ASSERT_EQUAL_UINT32(late == 1 ? 8 : 6, foc.current.frozen.last_step);
        step(true);
        TEST_ASSERT_EQUAL_UINT32(8, foc.observer.periods);
    }
}

/* The square of 1/2 is 1/4: the aim is `margin` above it. */
static void weaken(int32_t margin, int32_t current_q28)
{
    restart();
    foc.period.voltage.unsaturated_q_q25 = 16384 * 1024;
    foc.weakening.target_square_q15 = 8192 + margin;
    foc.weakening.current_q28 = current_q28;
    foc.sequence = 7;
    config.current_loop.field_weakening_gain_pu_q15 = 20;
    config.current_loop.field_weakening_current_pu_q15 = 6000;
    (void)spare_tasks_run(&foc, &config, codes);
}

static void assert_weakened(int32_t current_q28, int32_t sequence)
{
    TEST_ASSERT_EQUAL_INT32(current_q28, foc.weakening.current_q28);
    TEST_ASSERT_EQUAL_INT32(sequence, foc.sequence);
}

void test_field_is_weakened_from_the_first_unit_of_shortfall_on(void)
{
    weaken(-1, 0);
    assert_weakened(-20, FOC_NO_SETPOINT);
}

void test_exactly_sufficient_voltage_changes_only_what_is_weakened_already(void)
{
    weaken(0, 0);
    assert_weakened(0, 7);
    weaken(0, -100);
    assert_weakened(-100, FOC_NO_SETPOINT);
    weaken(2, -100);
    assert_weakened(-60, FOC_NO_SETPOINT);
    weaken(1, 0);
    assert_weakened(0, 7);
}

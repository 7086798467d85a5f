/* SPDX-License-Identifier: Apache-2.0 */
/* The hall fault ride-through from one chosen state to the next: which edges it follows, and what
 * ends it. */
#include "hall.h"

#include "hall_state.h"

void setUp(void)
{
    hall_state_up();
    ride_through_sector_2(48);
}

void tearDown(void) {}

/* `expected` goes on by a period without an edge. */
static void expect_period(void)
{
    expected.theta_q32 += (uint32_t)expected.speed_q32;
    expected.periods_since_edge++;
    expected.steady_sensors = HALL_NO_READING;
}

void test_same_sector_and_an_impossible_state_move_the_angle(void)
{
    hall.plausible_edges = 5;
    expected = hall;
    event(2);
    expect_period();
    assert_expected_state();
    sensors_read(7);
    expect_period();
    expected.plausible_edges = 0;
    assert_expected_state();
}

void test_dead_reckoning_leaves_the_sector_reported(void)
{
    hall.theta_q32 = angle_q32(EDGE_3 + 9000);
    expected = hall;
    event(2);
    expect_period();
    assert_expected_state();
}

/* An edge less than 5 461 from the predicted angle takes half of the difference. */
static void assert_first_edge(int32_t early, bool followed)
{
    ride_through_sector_2(48);
    hall.theta_q32 = angle_q32(EDGE_3 - 128 - early) + 1000U;
    expected = hall;
    event(3);
    expect_period();
    expect_sector(3, EDGE_3, WIDTH_3);
    expected.plausible_edges = 1;
    expected.theta_q32 += followed ? (uint32_t)(early * 32768) : 0U;
    assert_expected_state();
}

void test_first_edge_counts_within_30_degrees_of_its_prediction(void)
{
    assert_first_edge(7, true);
    assert_first_edge(5460, true);
    assert_first_edge(5461, false);
    assert_first_edge(-5460, true);
    assert_first_edge(-5461, false);
}

/* 75 periods of sector 2, 9 600: exactly 128 a period. */
static void assert_second_edge(uint8_t edges_before)
{
    ride_through_sector_2(63); /* 64 periods: 150 a period */
    hall.plausible_edges = edges_before;
    hall.theta_q32 = angle_q32(EDGE_3 - 128 - 8000); /* however far */
    expected = hall;
    event(3);
    expect_period();
    expect_sector(3, EDGE_3, WIDTH_3);
    expected.plausible_edges = (uint8_t)(edges_before + 1);
    expected.sectors_timed = 1;
    expected.timed_turn = WIDTH_2;
    expected.timed_periods = 64;
    expected.sector_periods[2] = 64;
    expected.bounce_periods = 8;
    expected.overdue_periods = 256;
    expected.speed_q32 = (3 * 128 + 150) * 65536 / 4;
    expected.theta_q32 += angle_q32(4000);
    assert_expected_state();
}

void test_edge_after_a_plausible_one_counts_and_weighs_a_quarter_in_the_speed(void)
{
    assert_second_edge(1);
    assert_second_edge(4);
}

void test_edge_backward_is_the_begin_of_the_sector_left_by_dead_reckoning(void)
{
    hall.direction = -1;
    hall.speed_q32 = -SPEED_q32;
    hall.theta_q32 = angle_q32(EDGE_2 + 128 + 1000);
    hall.plausible_edges = 1;
    hall.periods_since_edge = 63;
    expected = hall;
    event(1);
    TEST_ASSERT_EQUAL_INT32((-3 * 128 - 150) * 65536 / 4, hall.speed_q32);
    TEST_ASSERT_EQUAL_HEX32(angle_q32(EDGE_2 + 500), hall.theta_q32);
    TEST_ASSERT_EQUAL_UINT8(1, hall.sector);
}

void test_edge_of_dead_reckoning_is_overdue_after_a_quarter_of_a_second_at_the_latest(void)
{
    static const int32_t TOOK[][2] = {{1249, 4996}, {1250, 5000}, {1251, 5000}};
    for (int k = 0; k < 3; k++) {
        ride_through_sector_2(TOOK[k][0] - 1);
        hall.overdue_periods = STANDSTILL_PERIODS;
        hall.plausible_edges = 1;
        event(3);
        TEST_ASSERT_EQUAL_INT32(TOOK[k][1], hall.overdue_periods);
    }
}

void test_back_within_an_eighth_of_the_sector_is_a_bounce_in_dead_reckoning_too(void)
{
    ride_through_sector_2(10);
    hall.plausible_edges = 5;
    expected = hall;
    event(1);
    expect_period();
    assert_expected_state();
    event(1); /* the twelfth period, of 11 */
    expect_period();
    expect_sector(1, EDGE_1, EDGE_2 - EDGE_1);
    expected.plausible_edges = 0;
    assert_expected_state();
}

void test_edge_forward_within_an_eighth_of_the_sector_counts(void)
{
    ride_through_sector_2(5);
    event(3);
    TEST_ASSERT_EQUAL_UINT8(1, hall.plausible_edges);
    TEST_ASSERT_EQUAL_UINT8(3, hall.sector);
}

void test_skipped_sector_restarts_the_count_of_plausible_edges(void)
{
    for (int direction = 0; direction <= 1; direction++) {
        ride_through_sector_2(5); /* within the time of a bounce */
        hall.direction = (int8_t)direction;
        hall.plausible_edges = 5;
        expected = hall;
        event(4);
        expect_period();
        expect_sector(4, EDGE_4, EDGE_5 - EDGE_4);
        expected.plausible_edges = 0;
        assert_expected_state();
    }
}

void test_first_edge_of_an_unknown_direction_gives_it(void)
{
    for (int direction = -1; direction <= 1; direction += 2) {
        ride_through_sector_2(48);
        hall.direction = 0;
        hall.plausible_edges = 5;
        event((uint8_t)(2 + direction));
        TEST_ASSERT_EQUAL_INT(direction, hall.direction);
        TEST_ASSERT_EQUAL_UINT8(0, hall.plausible_edges);
    }
}

void test_speed_of_dead_reckoning_decays_only_while_a_possible_state_is_late(void)
{
    hall.periods_since_edge = hall.overdue_periods;
    expected = hall;
    sensors_read(0);
    expect_period();
    assert_expected_state();
    event(2);
    expect_period();
    expected.speed_q32 = SPEED_q32 - SPEED_q32 / 64;
    assert_expected_state();
}

void test_standstill_ends_dead_reckoning_with_a_possible_state_only(void)
{
    hall.periods_since_edge = STANDSTILL_PERIODS - 1;
    hall.overdue_periods = STANDSTILL_PERIODS;
    sensors_read(0);
    TEST_ASSERT_EQUAL_INT32(SPEED_q32, hall.speed_q32);
    sensors_read(0);
    TEST_ASSERT_EQUAL_INT32(0, hall.speed_q32);
    TEST_ASSERT_FALSE(hall.valid);
    ride_through_sector_2(STANDSTILL_PERIODS - 1);
    hall.overdue_periods = STANDSTILL_PERIODS;
    event(2);
    TEST_ASSERT_FALSE(hall.valid);
    event(2);
    TEST_ASSERT_TRUE(hall.valid);
    TEST_ASSERT_EQUAL_INT32(STANDSTILL_PERIODS / 2, hall.overdue_periods);
}

void test_sixth_plausible_edge_ends_dead_reckoning_inside_the_sector(void)
{
    ride_through_sector_2(74);
    hall.plausible_edges = 4;
    hall.theta_q32 = angle_q32(EDGE_3 - 128 - 1000);
    event(3);
    TEST_ASSERT_FALSE(hall.valid);
    ride_through_sector_2(74);
    hall.plausible_edges = 5;
    hall.theta_q32 = angle_q32(EDGE_3 - 128 - 1000);
    event(3);
    TEST_ASSERT_TRUE(hall.valid);
    TEST_ASSERT_EQUAL_HEX32(angle_q32(EDGE_3), hall.theta_q32);
    TEST_ASSERT_EQUAL_HEX32(angle_q32(EDGE_3), hall.edge_theta_q32);
    TEST_ASSERT_EQUAL_INT32(hall.speed_q32, hall.edge_speed_q32);
    TEST_ASSERT_EQUAL_INT32(150, hall.overdue_periods); /* twice the sector's time from now on */
    TEST_ASSERT_EQUAL_UINT8(STATE_OF_SECTOR[3], hall.steady_sensors);
}

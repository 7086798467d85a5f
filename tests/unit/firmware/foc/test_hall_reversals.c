/* SPDX-License-Identifier: Apache-2.0 */
/* Hall sensors that turn back, bounce, are late or impossible, from one chosen state to the next:
 * what is a reversal, what is a fault, and the dead reckoning from a fault on. */
#include "hall.h"

#include "hall_state.h"

void setUp(void)
{
    hall_state_up();
}

void tearDown(void) {}

/* ---- Reversal, bounce, the same sector ---- */

void test_back_within_an_eighth_of_the_sector_is_a_bounce(void)
{
    forward_in_sector_2(10);
    event(1);
    expected.theta_q32 += SPEED_q32;
    expected.periods_since_edge = 11;
    expected.steady_sensors = HALL_NO_READING;
    assert_expected_state();
    hall.overdue_periods = REVERSAL_PERIODS; /* slow enough to turn round */
    event(1);
    TEST_ASSERT_EQUAL_INT(-1, hall.direction);
}

void test_skipped_sector_within_an_eighth_of_the_sector_is_no_bounce(void)
{
    forward_in_sector_2(5);
    event(4);
    TEST_ASSERT_EQUAL_UINT16(1, hall.faults);
}

/* The angle stays at the edge passed back over; dead reckoning would go on from there forward. */
void test_reversal_waits_at_its_edge_as_long_as_the_last_sector_took(void)
{
    hall.overdue_periods = 400;
    hall.observer_lead_q32 = 77;
    expected = hall;
    event(1);
    expect_sector(1, EDGE_1, EDGE_2 - EDGE_1);
    expected.direction = -1;
    expected.speed_q32 = 0;
    expected.sectors_timed = 0;
    expected.timed_turn = 0;
    expected.timed_periods = 0;
    expected.bounce_periods = 0;
    expected.theta_q32 = angle_q32(EDGE_2);
    expected.edge_theta_q32 = angle_q32(EDGE_2);
    expected.edge_speed_q32 = SPEED_q32;
    expected.steady_sensors = STATE_OF_SECTOR[1];
    assert_expected_state();
}

/* Behind a sector of 30 ms and more; the speed beyond it is not known either. */
void test_reversal_of_a_slow_rotor_waits_in_the_middle(void)
{
    for (int32_t overdue = 4 * REVERSAL_PERIODS - 2; overdue <= 4 * REVERSAL_PERIODS;
         overdue += 2) {
        forward_in_sector_2(48);
        hall.overdue_periods = overdue;
        event(1);
        const bool slow = overdue == 4 * REVERSAL_PERIODS;
        TEST_ASSERT_EQUAL_HEX32(angle_q32(slow ? EDGE_1 + (EDGE_2 - EDGE_1) / 2 : EDGE_2),
                                hall.theta_q32);
        TEST_ASSERT_EQUAL_HEX32(angle_q32(EDGE_2), hall.edge_theta_q32);
    }
}

void test_reversal_to_forward_waits_at_the_begin_of_the_sector_entered(void)
{
    hall.overdue_periods = 400;
    hall.direction = -1;
    hall.speed_q32 = -SPEED_q32;
    hall.sectors_timed = 1;
    event(3);
    TEST_ASSERT_EQUAL_INT(1, hall.direction);
    TEST_ASSERT_EQUAL_HEX32(angle_q32(EDGE_3), hall.theta_q32);
    TEST_ASSERT_EQUAL_HEX32(angle_q32(EDGE_3), hall.edge_theta_q32);
    TEST_ASSERT_EQUAL_INT32(-SPEED_q32, hall.edge_speed_q32);
}

void test_first_edge_after_a_standstill_gives_the_direction_only(void)
{
    start_in(2);
    event(3);
    expect_sector(3, EDGE_3, WIDTH_3);
    expected.direction = 1;
    expected.theta_q32 = angle_q32(EDGE_3 + WIDTH_3 / 2);
    expected.overdue_periods = STANDSTILL_PERIODS;
    expect_noted_edge();
    expected.steady_sensors = STATE_OF_SECTOR[3];
    assert_expected_state();
}

/* Back from sector 2 in the last of so many periods: dead reckoning begins. */
static bool reversal_is_impossible(int32_t periods, int32_t overdue_periods, uint8_t sectors_timed)
{
    forward_in_sector_2(periods - 1);
    hall.overdue_periods = overdue_periods;
    hall.sectors_timed = sectors_timed;
    event(1);
    TEST_ASSERT_EQUAL_INT(-1, hall.valid ? hall.direction : -1);
    return !hall.valid;
}

void test_reversal_is_impossible_before_a_fast_edge_is_overdue(void)
{
    const int32_t fast = REVERSAL_PERIODS - 1;
    TEST_ASSERT_TRUE(reversal_is_impossible(fast, fast, HALL_SECTORS));
    TEST_ASSERT_FALSE(reversal_is_impossible(fast + 1, fast, HALL_SECTORS));
    TEST_ASSERT_FALSE(reversal_is_impossible(fast + 1, fast + 1, HALL_SECTORS));
    TEST_ASSERT_TRUE(reversal_is_impossible(20, fast, 1));
    TEST_ASSERT_FALSE(reversal_is_impossible(20, fast, 0));
}

/* In sector 2 in the last of so many periods since an edge of such a speed. */
static bool stop_is_impossible(int32_t periods, int32_t speed_q32, int32_t overdue_periods,
                               uint8_t sectors_timed)
{
    forward_in_sector_2(periods - 1);
    hall.edge_speed_q32 = speed_q32;
    hall.overdue_periods = overdue_periods;
    hall.sectors_timed = sectors_timed;
    event(2);
    return !hall.valid;
}

/* One and a half times the 9 600 of sector 2 are 14 400. */
void test_stop_is_impossible_beyond_one_and_a_half_fast_sectors(void)
{
    const int32_t fast = REVERSAL_PERIODS / 2 - 1;
    TEST_ASSERT_FALSE(stop_is_impossible(144, 100 * 65536, fast, 1));
    TEST_ASSERT_TRUE(stop_is_impossible(145, 100 * 65536, fast, 1));
    TEST_ASSERT_TRUE(stop_is_impossible(14401, -1 * 65536, fast, 1));
    TEST_ASSERT_TRUE(stop_is_impossible(14401, 2 * 65536 - 1, fast, 1)); /* rounded towards zero */
    TEST_ASSERT_FALSE(stop_is_impossible(14400, 2 * 65536 - 1, fast, 1));
    TEST_ASSERT_FALSE(stop_is_impossible(14401, 2 * 65536 - 1, fast + 1, 1));
    TEST_ASSERT_FALSE(stop_is_impossible(14401, 2 * 65536 - 1, fast, 0));
}

void test_angle_inside_the_same_sector_stops_at_its_end_and_returns_when_overdue(void)
{
    hall.overdue_periods = 400;
    hall.periods_since_edge = 399;
    expected = hall;
    event(2);
    expected.theta_q32 += SPEED_q32;
    expected.periods_since_edge = 400;
    expected.steady_sensors = STATE_OF_SECTOR[2];
    assert_expected_state();
    hall.theta_q32 = angle_q32(EDGE_3 - 1);
    expected = hall;
    event(2);
    const uint32_t middle_q32 = angle_q32(EDGE_2 + (EDGE_3 - EDGE_2) / 2);
    expected.theta_q32 -= (angle_q32(EDGE_3 - 1) - middle_q32) / 64;
    expected.periods_since_edge = 401;
    expected.speed_q32 = SPEED_q32 - SPEED_q32 / 64;
    assert_expected_state();
}

void test_periods_since_an_edge_are_counted_to_65535(void)
{
    config.drive.pwm_frequency_Hz = 4 * 70000; /* standstill later than the counter's end */
    hall_init(&hall, &config);
    event(2);
    hall.periods_since_edge = UINT16_MAX - 1;
    event(2);
    TEST_ASSERT_EQUAL_INT32(UINT16_MAX, hall.periods_since_edge);
    event(2);
    TEST_ASSERT_EQUAL_INT32(UINT16_MAX, hall.periods_since_edge);
}

void test_skipped_sector_of_an_unknown_direction_is_a_fault(void)
{
    start_in(2);
    event(4);
    TEST_ASSERT_EQUAL_UINT16(1, hall.faults);
    TEST_ASSERT_FALSE(hall.valid);
}

/* ---- Faults ---- */

/* `expected` begins dead reckoning `periods` after its noted edge. */
static void expect_ride_through(int32_t periods)
{
    expected.faults++;
    expected.valid = false;
    expected.plausible_edges = 0;
    expected.invalid_periods = 0;
    expected.speed_q32 = expected.edge_speed_q32;
    expected.direction = (int8_t)((expected.edge_speed_q32 > 0) - (expected.edge_speed_q32 < 0));
    expected.theta_q32 = expected.edge_theta_q32 + (uint32_t)(periods * expected.edge_speed_q32);
    expected.periods_since_edge = periods;
    expected.overdue_periods *= 2;
    expected.steady_sensors = HALL_NO_READING;
}

/* A skipped sector begins it. */
void test_dead_reckoning_begins_at_the_last_plausible_edge_with_its_speed(void)
{
    static const int32_t SPEEDS_q32[] = {-SPEED_q32, -1, 0, 1, SPEED_q32};
    for (int k = 0; k < 5; k++) {
        forward_in_sector_2(48);
        hall.direction = 0;
        hall.speed_q32 = 5;
        hall.plausible_edges = 4;
        hall.edge_speed_q32 = SPEEDS_q32[k];
        hall.overdue_periods = STANDSTILL_PERIODS / 2;
        expected = hall;
        event(4);
        expect_ride_through(49);
        expect_sector(4, EDGE_4, EDGE_5 - EDGE_4);
        assert_expected_state();
    }
    forward_in_sector_2(48);
    hall.overdue_periods = STANDSTILL_PERIODS / 2 + 1;
    event(4);
    TEST_ASSERT_EQUAL_INT32(STANDSTILL_PERIODS, hall.overdue_periods);
}

void test_64th_impossible_state_in_a_row_starts_dead_reckoning(void)
{
    forward_in_sector_2(10);
    for (int n = 1; n <= 63; n++) {
        sensors_read(n % 2 == 0 ? 0 : 7);
        expected.theta_q32 += SPEED_q32;
        expected.periods_since_edge++;
        expected.invalid_periods = n;
        expected.steady_sensors = HALL_NO_READING;
        assert_expected_state();
    }
    sensors_read(0);
    expect_ride_through(74);
    assert_expected_state();
}

void test_possible_state_restarts_the_count_of_impossible_ones(void)
{
    hall.invalid_periods = 63;
    event(2);
    TEST_ASSERT_EQUAL_INT32(0, hall.invalid_periods);
    hall.invalid_periods = 63;
    event(3);
    TEST_ASSERT_EQUAL_INT32(0, hall.invalid_periods);
}

void test_impossible_state_soon_after_a_ride_through_is_ignored_as_before(void)
{
    forward_in_sector_2(10);
    for (int n = 0; n < HALL_INVALID_PERIODS; n++) {
        sensors_read(0);
    }
    TEST_ASSERT_FALSE(hall.valid);
    hall.plausible_edges = HALL_PLAUSIBLE_EDGES;
    event(2);
    TEST_ASSERT_TRUE(hall.valid);
    for (int n = 1; n < HALL_INVALID_PERIODS; n++) {
        sensors_read(7);
        TEST_ASSERT_TRUE(hall.valid);
    }
    sensors_read(7);
    TEST_ASSERT_FALSE(hall.valid);
    TEST_ASSERT_EQUAL_UINT16(2, hall.faults);
}

void test_impossible_reversal_starts_dead_reckoning_in_the_sector_reported(void)
{
    event(1);
    expect_ride_through(49);
    expect_sector(1, EDGE_1, EDGE_2 - EDGE_1);
    assert_expected_state();
}

void test_impossible_stop_starts_dead_reckoning(void)
{
    forward_in_sector_2(112); /* 113 times 128 is beyond 14 400 */
    hall.overdue_periods = 148;
    expected = hall;
    event(2);
    expect_ride_through(113);
    assert_expected_state();
}

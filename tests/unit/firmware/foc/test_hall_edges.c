/* SPDX-License-Identifier: Apache-2.0 */
/* Plausible hall sensors, from one chosen state to the next: what an edge and an overdue edge
 * change, and nothing else. */
#include "hall.h"

#include "core/reciprocal.h"
#include "hall_state.h"

void setUp(void)
{
    hall_state_up();
}

void tearDown(void) {}

static hall_observed_t observed_at(int32_t turn)
{
    const hall_observed_t out = {.theta_turn = (uint16_t)turn, .known = true};
    return out;
}

void test_initial_state_has_the_periods_of_its_times_and_no_reading(void)
{
    const hall_t none = {0};
    hall_init(&hall, &config);
    expected = none;
    expected.standstill_periods = STANDSTILL_PERIODS;
    expected.reversal_periods = REVERSAL_PERIODS;
    expected.steady_sensors = HALL_NO_READING;
    assert_expected_state();
}

void test_first_possible_state_starts_in_the_middle_of_its_sector(void)
{
    hall_init(&hall, &config);
    expected = hall;
    hall_process_event(&hall, &config, 0, UNKNOWN);
    expected.periods_since_edge = 1;
    assert_expected_state();
    event(3);
    expect_sector(3, EDGE_3, WIDTH_3);
    expected.started = true;
    expected.valid = true;
    expected.theta_q32 = angle_q32(EDGE_3 + WIDTH_3 / 2);
    expected.edge_theta_q32 = expected.theta_q32;
    expected.overdue_periods = STANDSTILL_PERIODS;
    expected.steady_sensors = STATE_OF_SECTOR[3];
    assert_expected_state();
}

/* Sectors 0 and 1 are of an odd width. */
void test_every_sector_begins_at_its_edge_and_has_an_even_span(void)
{
    for (uint8_t sector = 0; sector < HALL_SECTORS; sector++) {
        const int32_t begin_turn = config.rotor.edge_turn[sector];
        const int32_t end_turn = config.rotor.edge_turn[(sector + 1) % HALL_SECTORS];
        const int32_t width_turn = (uint16_t)(end_turn - begin_turn);
        start_in(sector);
        expect_sector(sector, begin_turn, width_turn);
        expected.theta_q32 = angle_q32(begin_turn + width_turn / 2);
        assert_expected_state();
    }
}

void test_period_without_an_event_moves_the_angle_only(void)
{
    hall.steady_sensors = STATE_OF_SECTOR[2];
    expected = hall;
    TEST_ASSERT_TRUE(hall_extrapolate(&hall, STATE_OF_SECTOR[2]));
    expected.theta_q32 += SPEED_q32;
    expected.periods_since_edge++;
    assert_expected_state();
    TEST_ASSERT_FALSE(hall_extrapolate(&hall, STATE_OF_SECTOR[3]));
    assert_expected_state();
}

void test_period_before_the_edge_is_overdue_has_no_event(void)
{
    hall.steady_sensors = STATE_OF_SECTOR[2];
    hall.periods_since_edge = hall.overdue_periods - 1;
    TEST_ASSERT_TRUE(hall_extrapolate(&hall, STATE_OF_SECTOR[2]));
    expected = hall;
    TEST_ASSERT_FALSE(hall_extrapolate(&hall, STATE_OF_SECTOR[2]));
    assert_expected_state();
}

void test_last_angle_of_the_sector_has_no_event_and_the_next_one_has(void)
{
    hall.steady_sensors = STATE_OF_SECTOR[2];
    hall.theta_q32 = hall.begin_q32 + hall.span_q32 - SPEED_q32;
    TEST_ASSERT_TRUE(hall_extrapolate(&hall, STATE_OF_SECTOR[2]));
    TEST_ASSERT_EQUAL_HEX32(hall.begin_q32 + hall.span_q32, hall.theta_q32);
    hall.theta_q32 -= SPEED_q32 - 1;
    TEST_ASSERT_FALSE(hall_extrapolate(&hall, STATE_OF_SECTOR[2]));
}

/* A period without movement in sector 2. */
static uint32_t inside_q32(uint32_t theta_q32)
{
    forward_in_sector_2(48);
    hall.speed_q32 = 0;
    hall.theta_q32 = theta_q32;
    event(2);
    return hall.theta_q32;
}

void test_angle_beyond_the_sector_goes_to_the_closer_border(void)
{
    const uint32_t last_q32 = angle_q32(EDGE_2 + WIDTH_2 - 1);
    const uint32_t opposite_q32 = angle_q32(EDGE_2 + WIDTH_2 / 2 + 32768); /* of the middle */
    const uint32_t end_q32 = hall.begin_q32 + hall.span_q32;
    TEST_ASSERT_EQUAL_HEX32(end_q32, inside_q32(end_q32));
    TEST_ASSERT_EQUAL_HEX32(last_q32, inside_q32(end_q32 + 1U));
    TEST_ASSERT_EQUAL_HEX32(last_q32, inside_q32(opposite_q32 - 1U));
    TEST_ASSERT_EQUAL_HEX32(angle_q32(EDGE_2), inside_q32(opposite_q32));
    TEST_ASSERT_EQUAL_HEX32(angle_q32(EDGE_2), inside_q32(angle_q32(EDGE_2) - 1U));
}

void test_seventh_sector_replaces_the_time_of_its_last_crossing(void)
{
    for (uint8_t timed = 5; timed <= 6; timed++) {
        forward_in_sector_2(79);
        hall.sectors_timed = timed;
        hall.timed_turn = timed == 5 ? 65536 - WIDTH_2 : 65536;
        event(3);
        TEST_ASSERT_EQUAL_UINT8(6, hall.sectors_timed);
        TEST_ASSERT_EQUAL_UINT32(65536, hall.timed_turn);
        TEST_ASSERT_EQUAL_UINT32(timed == 5 ? 512 + 80 : 512 - 75 + 80, hall.timed_periods);
        TEST_ASSERT_EQUAL_UINT16(80, hall.sector_periods[2]);
    }
}

/* The speed after an edge, sector 2 in as many periods as a turn ago. */
static int32_t measured(int8_t direction, uint32_t turn, uint32_t periods)
{
    forward_in_sector_2(74);
    hall.direction = direction;
    hall.timed_turn = turn;
    hall.timed_periods = periods;
    event(direction > 0 ? 3 : 1);
    return hall.speed_q32;
}

void test_times_beyond_16_bits_are_divided_by_four(void)
{
    const int32_t direct = (int32_t)reciprocal_scale(1U << 31, 65535);
    TEST_ASSERT_EQUAL_INT32(2 * direct, measured(1, 65536, 65535));
    TEST_ASSERT_EQUAL_INT32(65536, measured(1, 65536, 65536)); /* a power of two is exact */
    TEST_ASSERT_EQUAL_INT32(2 * (int32_t)reciprocal_scale(1U << 29, 16385),
                            measured(1, 65536, 65543)); /* 65 543/4 rounded down */
    const int32_t least = 2 * (int32_t)reciprocal_scale(1U << 29, 37501);
    TEST_ASSERT_EQUAL_INT32(least,
                            measured(1, 65536, 150006)); /* six times a quarter of a second */
    TEST_ASSERT_EQUAL_INT32(-least, measured(-1, 65536, 150006));
}

void test_measured_speed_is_at_most_a_quarter_turn_per_period(void)
{
    TEST_ASSERT_EQUAL_INT32(16383 << 16, measured(1, 16383, 1));
    TEST_ASSERT_EQUAL_INT32(2 * HALL_FASTEST_Q31, measured(1, 16384, 1));
    TEST_ASSERT_EQUAL_INT32(2 * HALL_FASTEST_Q31, measured(1, 16385, 1));
    TEST_ASSERT_EQUAL_INT32(-2 * HALL_FASTEST_Q31, measured(-1, 16384, 1));
}

/* ---- overdue edges ---- */

void test_an_angle_whose_edge_is_overdue_returns_by_a_64th_to_the_middle_of_the_sector(void)
{
    const uint32_t middle_q32 = angle_q32(EDGE_2 + WIDTH_2 / 2);
    /* The first two are too slow to decay. */
    static const int32_t SPEEDS_q32[] = {0, 63, SPEED_q32};
    for (int k = 0; k < 3; k++) {
        for (int32_t at = 1000; at < WIDTH_2; at += WIDTH_2 - 2000) {
            forward_in_sector_2(190); /* the next period is overdue */
            hall.theta_q32 = angle_q32(EDGE_2 + at);
            hall.speed_q32 = SPEEDS_q32[k];
            expected = hall;
            event(2);
            expected.periods_since_edge++;
            expected.speed_q32 -= SPEEDS_q32[k] / 64;
            const int32_t away_q32 = (int32_t)(middle_q32 - hall.theta_q32);
            TEST_ASSERT_INT32_WITHIN(1 << 16, (int32_t)(middle_q32 - expected.theta_q32) / 64 * 63,
                                     away_q32);
            expected.theta_q32 = hall.theta_q32;
            expected.steady_sensors = STATE_OF_SECTOR[2];
            assert_expected_state();
        }
    }
}

void test_standstill_begins_after_a_quarter_of_a_second(void)
{
    forward_in_sector_2(STANDSTILL_PERIODS - 1);
    event(2);
    TEST_ASSERT_EQUAL_INT32(SPEED_q32 - SPEED_q32 / 64, hall.speed_q32);
    TEST_ASSERT_EQUAL_INT(1, hall.direction);
    forward_in_sector_2(STANDSTILL_PERIODS);
    event(2);
    expected.speed_q32 = 0;
    expected.direction = 0;
    expected.theta_q32 = angle_q32(EDGE_2 + WIDTH_2 / 2);
    expect_noted_edge();
    expected.sectors_timed = 0;
    expected.timed_turn = 0;
    expected.timed_periods = 0;
    expected.overdue_periods = STANDSTILL_PERIODS;
    expected.bounce_periods = 0; /* the next edge may come at any time */
    expected.periods_since_edge = STANDSTILL_PERIODS + 1;
    expected.steady_sensors = STATE_OF_SECTOR[2];
    assert_expected_state();
}

/* ---- edges without an observed angle ---- */

/* The last turn took 512 periods, the speed was 160: of the difference a half, a quarter or an
 * eighth in the angle, all, a quarter or an eighth in the speed v, as the sector takes at least 64,
 * at least 32 or fewer periods. The angle arrives at EDGE_3 - 40 + v and is compared with EDGE_3 +
 * v/2. */
void test_correction_of_an_unobserved_edge_is_weaker_in_short_sectors(void)
{
    static const int32_t CASES[][3] = {
        {31, 156, 4096}, {32, 152, 8192}, {63, 152, 8192}, {64, 128, 16384}};
    for (int k = 0; k < 4; k++) {
        const int32_t took = CASES[k][0];
        const int32_t speed_turn = CASES[k][1];
        forward_in_sector_2(took - 1);
        hall.speed_q32 = 160 * 65536;
        hall.theta_q32 = angle_q32(EDGE_3 - 40);
        hall.timed_periods = (uint32_t)(512 + 75 - took);
        event(3);
        TEST_ASSERT_EQUAL_INT32(speed_turn * 65536, hall.speed_q32);
        const int32_t error = speed_turn / 2 + 40 - speed_turn;
        TEST_ASSERT_EQUAL_HEX32(angle_q32(EDGE_3 - 40 + speed_turn) +
                                    (uint32_t)(error * CASES[k][2] * 2),
                                hall.theta_q32);
    }
}

void test_angle_is_that_of_the_edge_until_a_turn_is_complete(void)
{
    for (int32_t took = 31; took <= 75; took += 44) {
        forward_in_sector_2(took - 1);
        hall.sectors_timed = 4;
        hall.timed_turn = 65536 - WIDTH_2;
        hall.timed_periods = (uint32_t)(512 - took);
        hall.speed_q32 = 160 * 65536;
        event(3);
        TEST_ASSERT_EQUAL_INT32(SPEED_q32, hall.speed_q32);
        TEST_ASSERT_EQUAL_HEX32(angle_q32(EDGE_3 + 64), hall.theta_q32);
    }
}

void test_angle_after_an_unobserved_edge_is_inside_the_sector(void)
{
    forward_in_sector_2(74);
    hall.theta_q32 = angle_q32(EDGE_3 - 3000);
    event(3);
    TEST_ASSERT_EQUAL_HEX32(angle_q32(EDGE_3), hall.theta_q32);
}

/* ---- edges with an observed angle ---- */

/* The angle arrives 100 beyond the edge, which is observed at `seen`, of which `passed` counts: a
 * quarter of the error. The lead grows by an eighth of what does not count. */
static void assert_passed(int32_t speed_q32, int32_t seen, int32_t passed, int32_t learned)
{
    const int32_t direction = speed_q32 > 0 ? 1 : -1;
    const int32_t edge = direction > 0 ? EDGE_3 : EDGE_2;
    const int32_t arrived = edge + 100 * direction;
    const uint32_t lead_q32 = angle_q32(20) + 65535U;
    forward_in_sector_2(39);
    hall.direction = (int8_t)direction;
    hall.speed_q32 = speed_q32;
    hall.theta_q32 = angle_q32(arrived) - (uint32_t)speed_q32;
    hall.observer_lead_q32 = lead_q32;
    event_observed(direction > 0 ? 3 : 1, observed_at(edge + seen + 20));
    TEST_ASSERT_EQUAL_HEX32(angle_q32(arrived) + (uint32_t)((passed - 100 * direction) * 16384),
                            hall.theta_q32);
    TEST_ASSERT_EQUAL_HEX32(lead_q32 + (uint32_t)(learned * 8192), hall.observer_lead_q32);
}

void test_observed_place_of_an_edge_counts_within_the_movement_of_a_period(void)
{
    assert_passed(SPEED_q32, 50, 50, 0);
    assert_passed(SPEED_q32, 128, 128, 0);
    assert_passed(SPEED_q32, 200, 128, 72);
    assert_passed(SPEED_q32, -40, 0, -40);
    assert_passed(-SPEED_q32, -50, -50, 0);
    assert_passed(-SPEED_q32, -200, -128, -72);
    assert_passed(-SPEED_q32, 40, 0, 40);
    assert_passed(2 * HALL_FASTEST_Q31, 20000, 16383, 3617); /* just less than 16 384 */
}

/* From sector 5 forward or from sector 1 backward, 40 periods in a turn of so many. */
static void check_speed(int32_t direction, int32_t speed_q32, uint32_t periods)
{
    forward_in_sector_2(39);
    if (direction > 0) {
        set_sector(&hall, 5, EDGE_5, EDGE_0 - EDGE_5);
    } else {
        set_sector(&hall, 1, EDGE_1, EDGE_2 - EDGE_1);
    }
    hall.periods_since_edge = 39;
    hall.timed_periods = periods + hall.sector_periods[hall.sector] - 40;
    hall.direction = (int8_t)direction;
    hall.speed_q32 = speed_q32;
    hall.theta_q32 = angle_q32(EDGE_0 + 3000);
    event_observed(0, observed_at(0));
}

/* A turn in 512 periods: 128/65 536 a period, and between 511 and 513 within 128^2/65 536^2. */
void test_speed_is_compared_with_the_last_turn_at_the_begin_of_the_first_sector(void)
{
    enum { WITHIN = 128 * 128 };
    static const int32_t APART[][2] = {
        {0, 0}, {WITHIN, WITHIN}, {WITHIN + 1, WITHIN}, {-WITHIN, -WITHIN}, {-WITHIN - 1, -WITHIN}};
    for (int direction = -1; direction <= 1; direction += 2) {
        for (int k = 0; k < 5; k++) {
            const int32_t before_q32 = direction * SPEED_q32 + APART[k][0];
            check_speed(direction, before_q32, 512);
            TEST_ASSERT_EQUAL_INT32(direction * SPEED_q32 + APART[k][1], hall.speed_q32);
            TEST_ASSERT_EQUAL_HEX32(angle_q32(EDGE_0 + 3000) + (uint32_t)before_q32,
                                    hall.theta_q32);
        }
    }
}

void test_tolerance_of_the_speed_is_the_square_of_whole_steps(void)
{
    check_speed(1, 0, 4); /* the largest speed: just less than 16 384 */
    TEST_ASSERT_EQUAL_INT32(2 * HALL_FASTEST_Q31 - 16383 * 16383, hall.speed_q32);
}

/* A quarter of the angle's error, which arrives 28 beyond the edge; of the speed 64 times it, or
 * 128 times it in less than 32 periods. */
void test_observed_edge_corrects_a_quarter_of_the_angle_and_the_speed(void)
{
    static const int32_t CASES[][3] = {{64, 40, 64}, {64, 31, 128}, {3, 40, 64}, {3, 31, 128}};
    for (int k = 0; k < 4; k++) {
        const int32_t error = CASES[k][0] - 28;
        forward_in_sector_2(CASES[k][1] - 1);
        hall.theta_q32 = angle_q32(EDGE_3 - 100);
        event_observed(3, observed_at(EDGE_3 + CASES[k][0]));
        TEST_ASSERT_EQUAL_HEX32(angle_q32(EDGE_3 + 28) + (uint32_t)(error * 16384), hall.theta_q32);
        TEST_ASSERT_EQUAL_INT32(SPEED_q32 + error * CASES[k][2], hall.speed_q32);
    }
}

void test_speed_after_an_observed_edge_is_at_most_a_quarter_turn(void)
{
    for (int direction = -1; direction <= 1; direction += 2) {
        const int32_t edge = direction > 0 ? EDGE_3 : EDGE_2;
        forward_in_sector_2(39);
        hall.direction = (int8_t)direction;
        hall.speed_q32 = direction * 2 * HALL_FASTEST_Q31;
        hall.theta_q32 = angle_q32(edge - direction * 16384);
        event_observed(direction > 0 ? 3 : 1, observed_at(edge + direction * 16383));
        TEST_ASSERT_EQUAL_INT32(direction * 2 * HALL_FASTEST_Q31, hall.speed_q32);
    }
}

/* ---- edges as a whole ---- */

/* Sector 2 in 75 periods as a turn ago. */
void test_edge_forward_is_the_begin_of_the_sector_entered(void)
{
    forward_in_sector_2(74);
    event(3);
    expect_sector(3, EDGE_3, WIDTH_3);
    expected.overdue_periods = 150;
    expected.bounce_periods = 9;
    expected.theta_q32 = angle_q32(EDGE_3 + 32); /* half way from EDGE_3 + 0 to EDGE_3 + 64 */
    expect_noted_edge();
    expected.steady_sensors = STATE_OF_SECTOR[3];
    assert_expected_state();
}

void test_edge_backward_is_the_begin_of_the_sector_left(void)
{
    forward_in_sector_2(74);
    hall.direction = -1;
    hall.speed_q32 = -SPEED_q32;
    hall.theta_q32 = angle_q32(EDGE_2 + 128);
    expected = hall;
    event(1);
    expect_sector(1, EDGE_1, EDGE_2 - EDGE_1);
    expected.overdue_periods = 150;
    expected.bounce_periods = 9;
    expected.theta_q32 = angle_q32(EDGE_2 - 32);
    expect_noted_edge();
    expected.steady_sensors = STATE_OF_SECTOR[1];
    assert_expected_state();
}

void test_edge_is_overdue_after_a_quarter_of_a_second_at_the_latest(void)
{
    forward_in_sector_2(2500);
    event(3);
    TEST_ASSERT_EQUAL_INT32(STANDSTILL_PERIODS, hall.overdue_periods);
    forward_in_sector_2(2498);
    event(3);
    TEST_ASSERT_EQUAL_INT32(STANDSTILL_PERIODS - 2, hall.overdue_periods);
}

/* Sector 2 in so many periods, the one before it in others. */
static void slow_edge(int8_t direction, int32_t periods, int32_t before)
{
    forward_in_sector_2(periods - 1);
    hall.direction = direction;
    hall.speed_q32 = direction * SPEED_q32;
    hall.overdue_periods = q_min(2 * before, STANDSTILL_PERIODS);
    event(direction > 0 ? 3 : 1);
}

/* The middle, or 30 degrees from the edge in a sector wider than 60. */
static int32_t half_turn(int32_t width_turn)
{
    return q_min(width_turn / 2, 5459);
}

/* 8/7 of the time; the one before counts as at most an eighth of a second. In a sector shorter than
 * 30 ms no rotor turns round. */
void test_after_a_slower_or_a_long_sector_the_angle_goes_no_further_than_to_the_middle(void)
{
    static const struct {
        int32_t periods, before;
        bool half;
    } CASES[] = {{STANDSTILL_PERIODS * 4 / 7 + 1, STANDSTILL_PERIODS, true},
                 {STANDSTILL_PERIODS * 4 / 7, STANDSTILL_PERIODS, false},
                 {1000, 1000, false}, /* a constant speed */
                 {1000, 875, false},
                 {1000, 874, true},
                 {2 * REVERSAL_PERIODS, 100, true},
                 {2 * REVERSAL_PERIODS - 1, 100, false}};
    for (int k = 0; k < 7; k++) {
        slow_edge(1, CASES[k].periods, CASES[k].before);
        const uint32_t forward_q32 = hall.begin_q32 + hall.span_q32;
        TEST_ASSERT_EQUAL_HEX32(angle_q32(EDGE_3), hall.begin_q32);
        TEST_ASSERT_UINT32_WITHIN(
            2 << 16, angle_q32(EDGE_3 + (CASES[k].half ? half_turn(WIDTH_3) : WIDTH_3)),
            forward_q32);
        slow_edge(-1, CASES[k].periods, CASES[k].before);
        TEST_ASSERT_UINT32_WITHIN(
            2 << 16, angle_q32(CASES[k].half ? EDGE_2 - half_turn(EDGE_2 - EDGE_1) : EDGE_1),
            hall.begin_q32);
        TEST_ASSERT_UINT32_WITHIN(2 << 16, angle_q32(EDGE_2), hall.begin_q32 + hall.span_q32);
    }
}

void test_a_rotor_that_stops_behind_a_slower_sector_is_taken_to_be_in_the_middle(void)
{
    for (int direction = -1; direction <= 1; direction += 2) {
        slow_edge((int8_t)direction, 1000, 500);
        const int32_t begin = direction > 0 ? EDGE_3 : EDGE_1;
        const int32_t width = direction > 0 ? WIDTH_3 : EDGE_2 - EDGE_1;
        const uint32_t middle_q32 =
            angle_q32(direction > 0 ? begin + half_turn(width) : begin + width - half_turn(width));
        for (int32_t period = 0; period < 1000; period++) {
            event(direction > 0 ? 3 : 1);
            const int32_t beyond_q32 = direction * (int32_t)(hall.theta_q32 - middle_q32);
            TEST_ASSERT_LESS_OR_EQUAL_INT32(2 << 16, beyond_q32);
        }
        TEST_ASSERT_UINT32_WITHIN(4 << 16, middle_q32, hall.theta_q32);
        TEST_ASSERT_NOT_EQUAL_INT32(0, hall.speed_q32); /* it may as well go on */
        for (int32_t period = 1000; period <= STANDSTILL_PERIODS; period++) {
            event(direction > 0 ? 3 : 1);
        }
        TEST_ASSERT_UINT32_WITHIN(4 << 16, middle_q32, hall.theta_q32);
        TEST_ASSERT_EQUAL_INT32(0, hall.speed_q32);
    }
}

/* A sector in 40 periods, with an observed angle and without. */
void test_observed_angle_is_used_in_short_sectors_only(void)
{
    for (int known = 0; known <= 1; known++) {
        hall_observed_t observed = observed_at(EDGE_3 + 64);
        observed.known = known != 0;
        forward_in_sector_2(39);
        hall.theta_q32 = angle_q32(EDGE_3 - 100);
        hall.timed_periods = 512 + 75 - 40;
        event_observed(3, observed);
        /* 36 of error: a quarter of it; with 28 beyond the edge, a quarter towards 64. */
        TEST_ASSERT_EQUAL_HEX32(angle_q32(EDGE_3 + 28 + 9), hall.theta_q32);
        TEST_ASSERT_EQUAL_INT32(SPEED_q32 + (known != 0 ? 36 * 64 : 0), hall.speed_q32);
        TEST_ASSERT_EQUAL_HEX32(hall.theta_q32, hall.edge_theta_q32);
    }
    forward_in_sector_2(63);
    hall.theta_q32 = angle_q32(EDGE_3 - 100);
    hall.timed_periods = 512 + 75 - 64;
    event_observed(3, observed_at(EDGE_3 + 64));
    TEST_ASSERT_EQUAL_INT32(SPEED_q32, hall.speed_q32); /* 64 periods: half of the error */
    TEST_ASSERT_EQUAL_HEX32(angle_q32(EDGE_3 + 28 + 18), hall.theta_q32);
}

void test_angle_after_an_observed_edge_is_inside_the_sector(void)
{
    forward_in_sector_2(39);
    hall.theta_q32 = angle_q32(EDGE_3 - 3000);
    event_observed(3, observed_at(EDGE_3));
    TEST_ASSERT_EQUAL_HEX32(angle_q32(EDGE_3), hall.theta_q32);
}

/* SPDX-License-Identifier: Apache-2.0 */
/* Plausible hall sensors, from one chosen state to the next: what an edge, a reversal, a bounce and
 * an overdue edge change, and nothing else. */
#include "hall.c" /* its functions are private */
#include "hall_state.h"

void setUp(void)
{
    hall_state_up();
}

void tearDown(void) {}

static void event(uint8_t sector, hall_observed_t observed)
{
    hall_process_event(&hall, &config, STATE_OF_SECTOR[sector], observed);
}

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
    event(3, UNKNOWN);
    expect_sector(3, EDGE_3, WIDTH_3);
    expected.started = true;
    expected.valid = true;
    expected.theta_q32 = angle_q32(EDGE_3 + WIDTH_3 / 2);
    expected.edge_theta_q32 = expected.theta_q32;
    expected.overdue_periods = STANDSTILL_PERIODS;
    expected.steady_sensors = STATE_OF_SECTOR[3];
    assert_expected_state();
}

void test_sector_of_an_odd_width_has_an_even_span(void)
{
    enter_sector(&hall, &config, 0);
    expect_sector(0, EDGE_0, 65536 - EDGE_0 + EDGE_1); /* 11 037 */
    assert_expected_state();
    TEST_ASSERT_EQUAL_HEX32(angle_q32(EDGE_0 + 5518), middle_q32(&hall));
    enter_sector(&hall, &config, 5);
    expect_sector(5, EDGE_5, EDGE_0 - EDGE_5);
    assert_expected_state();
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

void test_angle_beyond_the_sector_goes_to_the_closer_border(void)
{
    const uint32_t last_q32 = angle_q32(EDGE_2 + WIDTH_2 - 1);
    hall.theta_q32 = hall.begin_q32 + hall.span_q32;
    clamp_to_sector(&hall);
    TEST_ASSERT_EQUAL_HEX32(hall.begin_q32 + hall.span_q32, hall.theta_q32);
    hall.theta_q32 = hall.begin_q32 + hall.span_q32 + 1U;
    clamp_to_sector(&hall);
    TEST_ASSERT_EQUAL_HEX32(last_q32, hall.theta_q32);
    hall.theta_q32 = angle_q32(EDGE_2 + WIDTH_2 / 2 + 32768) - 1U; /* opposite to the middle */
    clamp_to_sector(&hall);
    TEST_ASSERT_EQUAL_HEX32(last_q32, hall.theta_q32);
    hall.theta_q32 = angle_q32(EDGE_2 + WIDTH_2 / 2 + 32768);
    clamp_to_sector(&hall);
    TEST_ASSERT_EQUAL_HEX32(angle_q32(EDGE_2), hall.theta_q32);
    hall.theta_q32 = angle_q32(EDGE_2) - 1U;
    clamp_to_sector(&hall);
    TEST_ASSERT_EQUAL_HEX32(angle_q32(EDGE_2), hall.theta_q32);
}

void test_seventh_sector_replaces_the_time_of_its_last_crossing(void)
{
    time_sector(&hall, &config, 2, 80);
    expected.timed_periods = 512 - 75 + 80;
    expected.sector_periods[2] = 80;
    assert_expected_state();
    hall.sectors_timed = 5;
    hall.timed_turn = 65536 - WIDTH_3;
    expected = hall;
    time_sector(&hall, &config, 3, 90);
    expected.sectors_timed = 6;
    expected.timed_turn = 65536;
    expected.timed_periods += 90;
    expected.sector_periods[3] = 90;
    assert_expected_state();
}

static int32_t measured(uint32_t turn, uint32_t periods)
{
    hall.timed_turn = turn;
    hall.timed_periods = periods;
    return measured_speed_q32(&hall);
}

void test_times_beyond_16_bits_are_divided_by_four(void)
{
    const int32_t direct = (int32_t)reciprocal_scale(1U << 31, 65535);
    TEST_ASSERT_EQUAL_INT32(2 * direct, measured(65536, 65535));
    TEST_ASSERT_EQUAL_INT32(65536, measured(65536, 65536)); /* a power of two is exact */
    TEST_ASSERT_EQUAL_INT32(2 * (int32_t)reciprocal_scale(1U << 29, 16385),
                            measured(65536, 65543)); /* 65 543/4 rounded down */
    const int32_t least = 2 * (int32_t)reciprocal_scale(1U << 29, 37501);
    TEST_ASSERT_EQUAL_INT32(least, measured(65536, 150006)); /* six times a quarter of a second */
    hall.direction = -1;
    TEST_ASSERT_EQUAL_INT32(-least, measured(65536, 150006));
}

void test_measured_speed_just_below_the_largest_is_not_limited(void)
{
    TEST_ASSERT_EQUAL_INT32(16383 << 16, measured(16383, 1));
    TEST_ASSERT_EQUAL_INT32(2 * HALL_FASTEST_Q31, measured(16384, 1));
    TEST_ASSERT_EQUAL_INT32(2 * HALL_FASTEST_Q31, measured(16385, 1));
}

void test_speed_of_less_than_a_64th_stays_until_standstill(void)
{
    hall.periods_since_edge = hall.overdue_periods + 1;
    hall.speed_q32 = 63;
    expected = hall;
    decay_overdue_speed(&hall);
    assert_expected_state();
    hall.speed_q32 = 0;
    expected = hall;
    decay_overdue_speed(&hall);
    expected.theta_q32 = angle_q32(EDGE_2 + WIDTH_2 / 2);
    assert_expected_state();
}

void test_standstill_begins_after_a_quarter_of_a_second(void)
{
    hall.periods_since_edge = STANDSTILL_PERIODS;
    expected = hall;
    decay_overdue_speed(&hall);
    expected.speed_q32 = SPEED_q32 - SPEED_q32 / 64;
    assert_expected_state();
    hall.periods_since_edge++;
    decay_overdue_speed(&hall);
    TEST_ASSERT_EQUAL_INT32(0, hall.speed_q32);
    TEST_ASSERT_EQUAL_INT(0, hall.direction);
}

void test_correction_of_an_edge_is_weaker_in_short_sectors_of_a_complete_turn(void)
{
    TEST_ASSERT_EQUAL_UINT(3, smoothing_log2(&hall, 31));
    TEST_ASSERT_EQUAL_UINT(2, smoothing_log2(&hall, 32));
    TEST_ASSERT_EQUAL_UINT(2, smoothing_log2(&hall, 63));
    TEST_ASSERT_EQUAL_UINT(0, smoothing_log2(&hall, 64));
    hall.sectors_timed = 5;
    TEST_ASSERT_EQUAL_UINT(0, smoothing_log2(&hall, 31));
}

/* Observed beyond the edge, what counts of it, by which the learned lead grows in 1/8 LSB. */
static void assert_passed(int32_t speed_turn, int32_t seen, int32_t passed, int32_t learned)
{
    const uint32_t lead_q32 = angle_q32(20) + 65535U;
    hall.speed_q32 = speed_turn * 65536;
    hall.observer_lead_q32 = lead_q32;
    TEST_ASSERT_EQUAL_INT32(
        passed, passed_turn(&hall, angle_q32(EDGE_3) + 65535U, observed_at(EDGE_3 + seen + 20)));
    TEST_ASSERT_EQUAL_HEX32(lead_q32 + (uint32_t)(learned * 8192), hall.observer_lead_q32);
}

void test_observed_place_of_an_edge_counts_within_the_movement_of_a_period(void)
{
    assert_passed(128, 50, 50, 0);
    assert_passed(128, 128, 128, 0);
    assert_passed(128, 200, 128, 72);
    assert_passed(128, -40, 0, -40);
    assert_passed(-128, -50, -50, 0);
    assert_passed(-128, -200, -128, -72);
    assert_passed(-128, 40, 0, 40);
    hall.speed_q32 = 2 * HALL_FASTEST_Q31; /* just less than 16 384 */
    TEST_ASSERT_EQUAL_INT32(16383,
                            passed_turn(&hall, angle_q32(EDGE_3), observed_at(EDGE_3 + 20000)));
}

/* A turn in 512 periods: 128/65 536 a period, and between 511 and 513 within 128^2/65 536^2. */
void test_speed_is_compared_with_the_last_turn_at_the_begin_of_the_first_sector(void)
{
    enum { WITHIN = 128 * 128 };
    static const int32_t APART[][2] = {
        {0, 0}, {WITHIN, WITHIN}, {WITHIN + 1, WITHIN}, {-WITHIN, -WITHIN}, {-WITHIN - 1, -WITHIN}};
    for (int direction = -1; direction <= 1; direction += 2) {
        for (int k = 0; k < 5; k++) {
            forward_in_sector_2(48);
            hall.sector = 0;
            hall.direction = (int8_t)direction;
            hall.speed_q32 = direction * SPEED_q32 + APART[k][0];
            expected = hall;
            follow_observed_edge(&hall, hall.begin_q32, observed_at(0), 3);
            expected.theta_q32 += (uint32_t)expected.speed_q32;
            expected.speed_q32 = direction * SPEED_q32 + APART[k][1];
            assert_expected_state();
        }
    }
}

void test_tolerance_of_the_speed_is_the_square_of_whole_steps(void)
{
    hall.sector = 0;
    hall.timed_periods = 4; /* the largest speed: just less than 16 384 */
    hall.speed_q32 = 0;
    follow_observed_edge(&hall, hall.begin_q32, observed_at(0), 3);
    TEST_ASSERT_EQUAL_INT32(2 * HALL_FASTEST_Q31 - 16383 * 16383, hall.speed_q32);
}

/* A quarter of the angle's error, 16 * 2^log2 of it to the speed. The angle arrives 28 beyond the
 * edge. */
static void assert_observed_edge(int32_t seen, unsigned log2, int32_t gain)
{
    forward_in_sector_2(48);
    hall.theta_q32 = angle_q32(EDGE_3 - 100);
    expected = hall;
    follow_observed_edge(&hall, angle_q32(EDGE_3), observed_at(EDGE_3 + seen), log2);
    expected.theta_q32 = angle_q32(EDGE_3 + 28) + (uint32_t)((seen - 28) * 16384);
    expected.speed_q32 = SPEED_q32 + (seen - 28) * gain;
    assert_expected_state();
}

void test_observed_edge_corrects_a_quarter_of_the_angle_and_the_speed(void)
{
    assert_observed_edge(64, 2, 64);
    assert_observed_edge(64, 3, 128);
    assert_observed_edge(3, 2, 64);
    assert_observed_edge(3, 3, 128);
}

void test_speed_after_an_observed_edge_is_at_most_a_quarter_turn(void)
{
    for (int direction = -1; direction <= 1; direction += 2) {
        hall.speed_q32 = direction * 2 * HALL_FASTEST_Q31;
        hall.theta_q32 = angle_q32(EDGE_3 - direction * 16384);
        follow_observed_edge(&hall, angle_q32(EDGE_3), observed_at(EDGE_3 + direction * 16383), 2);
        TEST_ASSERT_EQUAL_INT32(direction * 2 * HALL_FASTEST_Q31, hall.speed_q32);
    }
}

/* The last turn took 512 periods, the speed was 160: it moves by 2^-log2 of the difference. With
 * the new speed v the angle arrives at EDGE_3 - 40 + v and is compared with EDGE_3 + v/2. */
static void assert_unobserved_edge(unsigned log2, int32_t speed_turn, int32_t share_q15)
{
    forward_in_sector_2(48);
    enter_sector(&hall, &config, 3);
    hall.speed_q32 = 160 * 65536;
    hall.theta_q32 = angle_q32(EDGE_3 - 40);
    expected = hall;
    follow_unobserved_edge(&hall, angle_q32(EDGE_3), log2);
    expected.speed_q32 = speed_turn * 65536;
    const int32_t error = speed_turn / 2 + 40 - speed_turn;
    expected.theta_q32 = angle_q32(EDGE_3 - 40 + speed_turn) + (uint32_t)(error * share_q15 * 2);
    assert_expected_state();
}

void test_unobserved_edge_counts_half_a_period_before_the_sample(void)
{
    assert_unobserved_edge(0, 128, 16384);
    assert_unobserved_edge(2, 152, 8192);
    assert_unobserved_edge(3, 156, 4096);
}

void test_angle_is_that_of_the_edge_until_a_turn_is_complete(void)
{
    enter_sector(&hall, &config, 3);
    hall.sectors_timed = 5;
    hall.speed_q32 = 160 * 65536;
    expected = hall;
    follow_unobserved_edge(&hall, angle_q32(EDGE_3), 0);
    expected.speed_q32 = SPEED_q32;
    expected.theta_q32 = angle_q32(EDGE_3 + 64);
    assert_expected_state();
}

void test_angle_after_an_unobserved_edge_is_inside_the_sector(void)
{
    enter_sector(&hall, &config, 3);
    hall.theta_q32 = angle_q32(EDGE_3 - 3000);
    follow_unobserved_edge(&hall, angle_q32(EDGE_3), 0);
    TEST_ASSERT_EQUAL_HEX32(angle_q32(EDGE_3), hall.theta_q32);
}

/* Sector 2 in 75 periods as a turn ago. */
void test_edge_forward_is_the_begin_of_the_sector_entered(void)
{
    forward_in_sector_2(74);
    event(3, UNKNOWN);
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
    event(1, UNKNOWN);
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
    event(3, UNKNOWN);
    TEST_ASSERT_EQUAL_INT32(STANDSTILL_PERIODS, hall.overdue_periods);
    forward_in_sector_2(2498);
    event(3, UNKNOWN);
    TEST_ASSERT_EQUAL_INT32(STANDSTILL_PERIODS - 2, hall.overdue_periods);
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
        event(3, observed);
        /* 36 of error: a quarter of it; with 28 beyond the edge, a quarter towards 64. */
        TEST_ASSERT_EQUAL_HEX32(angle_q32(EDGE_3 + 28 + 9), hall.theta_q32);
        TEST_ASSERT_EQUAL_INT32(SPEED_q32 + (known != 0 ? 36 * 64 : 0), hall.speed_q32);
        TEST_ASSERT_EQUAL_HEX32(hall.theta_q32, hall.edge_theta_q32);
    }
    forward_in_sector_2(63);
    hall.theta_q32 = angle_q32(EDGE_3 - 100);
    hall.timed_periods = 512 + 75 - 64;
    event(3, observed_at(EDGE_3 + 64));
    TEST_ASSERT_EQUAL_INT32(SPEED_q32, hall.speed_q32); /* 64 periods: half of the error */
    TEST_ASSERT_EQUAL_HEX32(angle_q32(EDGE_3 + 28 + 18), hall.theta_q32);
}

void test_angle_after_an_observed_edge_is_inside_the_sector(void)
{
    forward_in_sector_2(39);
    hall.theta_q32 = angle_q32(EDGE_3 - 3000);
    event(3, observed_at(EDGE_3));
    TEST_ASSERT_EQUAL_HEX32(angle_q32(EDGE_3), hall.theta_q32);
}

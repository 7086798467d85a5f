/* SPDX-License-Identifier: Apache-2.0 */
/* Healthy hall sensors: the estimate of a rotor that turns, stops and reverses, and with bouncing
 * sensors. */
#include "hall_rig.h"

void setUp(void)
{
    rig_up();
}

void tearDown(void) {}

void test_first_angle_is_the_middle_of_the_sector(void)
{
    for (int k = 0; k < 6; k++) {
        restart();
        theta_turns = (k + 0.9) / 6.0;
        turn(0.0);
        TEST_ASSERT_TRUE(hall.valid);
        TEST_ASSERT_EQUAL_INT32(0, hall.speed_q32);
        TEST_ASSERT_DOUBLE_WITHIN(1e-4, -0.4 / 6.0, angle_error_turns());
    }
}

void test_speed_error_is_one_period_per_turn_at_constant_speed(void)
{
    /* N = 1/speed periods make a turn; counting them is off by at most one: relative error 1/N (and
     * 8e-5 of the reciprocal). */
    for (int s = 0; s < SPEED_COUNT; s++) {
        restart();
        turn_for((int)(2.5 / fabs(SPEEDS[s])), SPEEDS[s]);
        for (int n = 0; n < 3000; n++) {
            turn(SPEEDS[s]);
            const double tolerance = fabs(SPEEDS[s]) * (fabs(SPEEDS[s]) * 1.01 + 1e-4);
            TEST_ASSERT_DOUBLE_WITHIN(tolerance, SPEEDS[s], speed_turns());
        }
    }
}

void test_angle_error_is_within_two_periods_at_constant_speed(void)
{
    /* An edge is seen up to one period late; until the next edge, a sixth of a turn later, a speed
     * that is wrong by 1/N adds a sixth of a period's movement. */
    for (int s = 0; s < SPEED_COUNT; s++) {
        restart();
        turn_for((int)(3.0 / fabs(SPEEDS[s])), SPEEDS[s]);
        for (int n = 0; n < 3000; n++) {
            turn(SPEEDS[s]);
            TEST_ASSERT_DOUBLE_WITHIN(2.0 * fabs(SPEEDS[s]) + 1e-4, 0.0, angle_error_turns());
            assert_inside_sector();
        }
    }
}

void test_mean_angle_error_is_zero_at_constant_speed(void)
{
    /* An edge lies half a period before the sample that shows it, on average; not to allow for it
     * would be 0.5 here. */
    for (int s = 0; s < SPEED_COUNT; s++) {
        restart();
        const double speed = SPEEDS[s] * 1.00137; /* edges at ever other places between samples */
        turn_for((int)(4.0 / fabs(speed)), speed);
        double sum = 0.0;
        const int count = (int)(12.0 / fabs(speed));
        for (int n = 0; n < count; n++) {
            turn(speed);
            sum += angle_error_turns();
        }
        TEST_ASSERT_DOUBLE_WITHIN(0.25, 0.0, sum / count / speed);
    }
}

/* Speeds at which a sector takes nearly a whole number of periods, both ways: the edges fall on
 * nearly the same place between two samples for a long time. */
static const double BEATS[] = {1.0 / 84.0 + 2e-7, 1.0 / 90.0 - 3e-7, 1.0 / 120.0 + 1e-7,
                               -1.0 / 84.0 - 2e-7, -1.0 / 204.0 + 1e-7};
enum { BEAT_COUNT = sizeof BEATS / sizeof BEATS[0], TURNS_TO_SETTLE = 600 };

/* Largest error in periods' movements at these speeds. */
static double largest_error(double speed, bool observed, double observed_error_turns)
{
    restart();
    double largest = 0.0;
    const int count = (int)(2 * TURNS_TO_SETTLE / fabs(speed));
    for (int n = 0; n < count; n++) {
        if (observed) {
            turn_observed(speed, observed_error_turns);
        } else {
            turn(speed);
        }
        const double error = fabs(angle_error_turns() / speed);
        largest = n >= count / 2 && error > largest ? error : largest;
        assert_inside_sector();
    }
    TEST_ASSERT_TRUE(hall.valid);
    return largest;
}

void test_observed_angle_removes_the_beat_of_edges_and_samples(void)
{
    for (int s = 0; s < BEAT_COUNT; s++) {
        TEST_ASSERT_TRUE(largest_error(BEATS[s], false, 0.0) > 0.4);
        /* The place is known to 1/65 536 turn; the end of a sector still shows a sample late. */
        TEST_ASSERT_TRUE(largest_error(BEATS[s], true, 0.0) < 0.1);
    }
}

void test_lead_of_the_observed_angle_is_learned_within_a_beat(void)
{
    const double leads[] = {0.05, -0.02};
    for (int k = 0; k < 2; k++) {
        TEST_ASSERT_TRUE(largest_error(0.0117, true, leads[k]) < 0.2);
        TEST_ASSERT_TRUE(largest_error(-0.0093, true, leads[k]) < 0.2);
    }
}

void test_wrong_observed_angle_leaves_what_the_edges_allow(void)
{
    for (int s = 0; s < SPEED_COUNT; s++) {
        restart();
        uint32_t random = 1;
        for (int n = 0; n < 20000; n++) {
            random = random * 1664525U + 1013904223U;
            turn_observed(SPEEDS[s], (random >> 8) / 16777216.0);
            if (n > 3.0 / fabs(SPEEDS[s])) {
                TEST_ASSERT_DOUBLE_WITHIN(2.0 * fabs(SPEEDS[s]) + 1e-4, 0.0, angle_error_turns());
                assert_inside_sector();
            }
        }
    }
}

static void misplace_sensors(void)
{
    /* Up to 5 degrees electrical, different for each edge. */
    static const double WRONG_DEG[6] = {5.0, -3.0, 4.0, -5.0, 2.0, -4.0};
    for (int k = 0; k < 6; k++) {
        edge_turns[k] =
            k / 6.0 + (k == 0 ? 1.0 : WRONG_DEG[k]) / 360.0; /* edge 0 stays above zero */
    }
}

void test_calibrated_misplaced_sensors_have_the_errors_of_ideal_ones(void)
{
    misplace_sensors();
    for (int k = 0; k < 6; k++) {
        config.rotor.edge_turn[k] = (int32_t)lround(edge_turns[k] * 65536.0);
    }
    for (int s = 0; s < SPEED_COUNT; s++) {
        restart();
        turn_for((int)(3.0 / fabs(SPEEDS[s])), SPEEDS[s]);
        for (int n = 0; n < 3000; n++) {
            turn(SPEEDS[s]);
            TEST_ASSERT_DOUBLE_WITHIN(2.0 * fabs(SPEEDS[s]) + 1e-4, 0.0, angle_error_turns());
        }
    }
}

void test_uncalibrated_misplaced_sensors_do_not_disturb_the_speed(void)
{
    misplace_sensors(); /* the configuration still says 60 degrees each */
    for (int s = 0; s < SPEED_COUNT; s++) {
        restart();
        turn_for((int)(2.5 / fabs(SPEEDS[s])), SPEEDS[s]);
        for (int n = 0; n < 3000; n++) {
            turn(SPEEDS[s]);
            /* Six sectors make a turn wherever the sensors sit. */
            TEST_ASSERT_DOUBLE_WITHIN(fabs(SPEEDS[s]) * (fabs(SPEEDS[s]) * 1.01 + 1e-4), SPEEDS[s],
                                      speed_turns());
        }
    }
}

void test_angle_stays_in_the_reported_sector_while_the_speed_changes(void)
{
    for (int n = 0; n < 60000; n++) {
        turn(0.012 * sin(n * 2.0 * 3.14159265358979323846 / 30000.0)); /* two reversals */
        assert_inside_sector();
        TEST_ASSERT_TRUE(hall.valid);
        TEST_ASSERT_EQUAL_UINT16(0, hall.faults);
    }
}

/* At a speed at which a rotor can turn round within a sector: 0.0005 turns a period are 10
 * electrical turns a second. */
void test_speed_has_the_new_sign_two_edges_after_a_reversal(void)
{
    turn_for(40000, 0.0005);
    const int sector_before = true_sector();
    turn_for((int)(2.0 / 6.0 / 0.0005) + 40, -0.0005); /* beyond the second edge */
    TEST_ASSERT_NOT_EQUAL(sector_before, true_sector());
    TEST_ASSERT_TRUE(hall.speed_q32 < 0);
    TEST_ASSERT_TRUE(hall.valid);
    /* One sector is timed so far, 333 periods: one period of uncertainty. */
    TEST_ASSERT_DOUBLE_WITHIN(0.0005 / 300.0, -0.0005, speed_turns());
}

void test_speed_is_zero_for_a_rotor_oscillating_about_an_edge(void)
{
    theta_turns = 1.0 / 6.0;
    turn(0.0);
    for (int n = 0; n < 20000; n++) {
        theta_turns = 1.0 / 6.0 + 0.01 * sin(n * 0.02); /* both sectors in turn, never across one */
        turn(0.0);
        TEST_ASSERT_EQUAL_INT32(0, hall.speed_q32);
        TEST_ASSERT_TRUE(hall.valid);
        assert_inside_sector();
    }
}

void test_speed_decays_without_edges_and_is_zero_after_250_ms(void)
{
    turn_for(40000, 0.0005);
    double before = fabs(speed_turns());
    for (int n = 0; n < config.drive.pwm_frequency_Hz / HALL_STANDSTILL_PER_S + 2; n++) {
        turn(0.0);
        TEST_ASSERT_TRUE(fabs(speed_turns()) <= before);
        before = fabs(speed_turns());
        assert_inside_sector();
    }
    TEST_ASSERT_EQUAL_INT32(0, hall.speed_q32);
    /* The middle of the sector: at most half a sector wrong wherever the rotor stopped. */
    TEST_ASSERT_DOUBLE_WITHIN(1.0 / 12.0 + 1e-4, 0.0, angle_error_turns());
}

void test_speed_decays_within_a_few_sectors_after_a_stop(void)
{
    /* A sector took 333 periods. Twice that later the speed decays by 1/64 a period: 1 % is left
     * after 64 ln 100 = 295. */
    turn_for(40000, 0.0005);
    turn_for(2 * 334 + 334 + 300, 0.0);
    TEST_ASSERT_TRUE(fabs(speed_turns()) < 0.01 * 0.0005 + 1e-7);
    TEST_ASSERT_TRUE(hall.valid);
}

/* Sensor states of one edge that bounces `times` times before it stays, one state a period. */
static void bounce(int times, double speed_turns_per_period)
{
    const int sector = true_sector();
    while (true_sector() == sector) {
        turn(speed_turns_per_period);
    }
    for (int n = 0; n < times; n++) {
        theta_turns += speed_turns_per_period;
        period(STATE_OF_SECTOR[sector]);
        turn(speed_turns_per_period);
    }
}

void test_bounce_between_two_valid_states_has_no_effect(void)
{
    for (int s = 0; s < SPEED_COUNT; s++) {
        restart();
        turn_for((int)(3.0 / fabs(SPEEDS[s])), SPEEDS[s]);
        /* An eighth of a sector's time is 1/48 turn; a bounce takes two periods each time it comes
         * back. */
        const int times = (int)(1.0 / 48.0 / fabs(SPEEDS[s]) / 2.0) - 1;
        for (int edge = 0; edge < 12; edge++) {
            bounce(times > 3 ? 3 : (times > 0 ? times : 0), SPEEDS[s]);
            TEST_ASSERT_DOUBLE_WITHIN(fabs(SPEEDS[s]) * (fabs(SPEEDS[s]) * 1.01 + 1e-4), SPEEDS[s],
                                      speed_turns());
            TEST_ASSERT_DOUBLE_WITHIN(2.0 * fabs(SPEEDS[s]) + 1e-4, 0.0, angle_error_turns());
            TEST_ASSERT_TRUE(hall.valid);
            TEST_ASSERT_EQUAL_UINT16(0, hall.faults);
        }
    }
}

/* At 50 kHz a turn whose sectors take just less than the quarter of a second that is standing has
 * more periods than 16 bits. */
void test_speed_is_correct_for_a_turn_of_more_than_65536_periods(void)
{
    const int sector_periods = 11500;
    config.drive.pwm_frequency_Hz = 50000;
    restart();
    const double speed = 1.0 / (6.0 * sector_periods);
    for (double sign = -1.0; sign <= 1.0; sign += 2.0) {
        restart();
        turn_for(15 * sector_periods, sign * speed);
        TEST_ASSERT_DOUBLE_WITHIN(0.005 * speed, sign * speed, speed_turns());
    }
}

/* Sensors of the three inputs, each on for half a turn, in places 120 degrees apart either way
 * round, each input inverted or not; sensor A rises at the edge of sector 0. */
void test_every_wiring_gives_the_angle_that_the_default_one_gives(void)
{
    for (unsigned lines = 0; lines < 16U; lines++) {
        config.rotor.hall_lines = (int32_t)lines;
        restart();
        const double place_turns[3] = {0.0, (lines & 8U) != 0 ? 2.0 / 3.0 : 1.0 / 3.0,
                                       (lines & 8U) != 0 ? 1.0 / 3.0 : 2.0 / 3.0};
        const double speed = 0.005;
        for (int n = 0; n < 2000; n++) {
            theta_turns += speed;
            unsigned sensors = lines & 7U;
            for (unsigned x = 0; x < 3; x++) {
                const double past = theta_turns - place_turns[x];
                sensors ^= past - floor(past) < 0.5 ? 1U << x : 0U;
            }
            period((uint8_t)sensors);
            TEST_ASSERT_TRUE(hall.valid);
        }
        TEST_ASSERT_EQUAL_UINT16(0, hall.faults);
        TEST_ASSERT_DOUBLE_WITHIN(2.0 * speed, 0.0, angle_error_turns());
        TEST_ASSERT_DOUBLE_WITHIN(speed * (speed * 1.01 + 1e-4), speed, speed_turns());
    }
}

void test_only_the_three_sensor_bits_are_read(void)
{
    turn(0.0);
    const uint32_t theta_q32 = hall.theta_q32;
    period((uint8_t)(STATE_OF_SECTOR[true_sector()] | 0xF8U));
    TEST_ASSERT_EQUAL_UINT32(theta_q32, hall.theta_q32);
    TEST_ASSERT_TRUE(hall.valid);
}

void test_no_counter_wraps_during_hours_without_an_edge(void)
{
    turn_for(200000, 0.0);
    TEST_ASSERT_EQUAL_INT32(0, hall.speed_q32);
    turn_for(4000, 0.005);
    TEST_ASSERT_DOUBLE_WITHIN(0.005 * 0.006, 0.005, speed_turns());
    for (int n = 0; n < 200000; n++) {
        period(7);
    }
    TEST_ASSERT_FALSE(hall.valid);
}

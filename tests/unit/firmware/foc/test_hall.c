/* Hall sensors: a rotor that turns as told, three sensors on it, and what the estimate makes of them. */
#include <math.h>
#include <stdlib.h>

#include "core/angle.h"
#include "foc/hall.h"
#include "unity.h"

extern const config_t CONFIG_LU2013;

/* Forward order of the sensor states (bits C B A): sector k lies between edge k and the next. */
static const uint8_t STATE_OF_SECTOR[6] = {5, 1, 3, 2, 6, 4};

static config_t config;
static hall_t hall;
static double theta_turns;   /* true electrical angle */
static double edge_turns[6]; /* where the sensors really switch */

static void restart(void)
{
    hall_init(&hall, &config);
    theta_turns = 0.25;
}

void setUp(void)
{
    config = CONFIG_LU2013;
    config.drive.pwm_frequency_Hz = 20000;
    config.rotor.sensor = CONFIG_ROTOR_HALL;
    for (int k = 0; k < 6; k++) {
        edge_turns[k] = k / 6.0;
        config.rotor.edge_turn[k] = (int32_t)lround(edge_turns[k] * 65536.0);
    }
    restart();
}

void tearDown(void) {}

static int true_sector(void)
{
    const double at = theta_turns - floor(theta_turns);
    int sector = 5; /* before the first edge: the last sector's rest */
    for (int k = 0; k < 6; k++) {
        if (at >= edge_turns[k]) {
            sector = k;
        }
    }
    return sector;
}

/* How far the estimate lies ahead of the truth, turns. */
static double angle_error_turns(void)
{
    const double estimate = hall.theta_q32 / 4294967296.0;
    const double error = estimate - theta_turns;
    return error - floor(error + 0.5);
}

static double speed_turns(void)
{
    return hall.speed_q32 / 4294967296.0;
}

static void turn(double speed_turns_per_period)
{
    theta_turns += speed_turns_per_period;
    hall_step(&hall, &config, STATE_OF_SECTOR[true_sector()]);
}

static void turn_for(int periods, double speed_turns_per_period)
{
    for (int n = 0; n < periods; n++) {
        turn(speed_turns_per_period);
    }
}

/* The estimate must lie inside the sector that the sensors report; half an LSB for the border itself. */
static void assert_inside_sector(void)
{
    const uint16_t estimate = (uint16_t)(hall.theta_q32 >> 16);
    const uint16_t start = (uint16_t)config.rotor.edge_turn[true_sector()];
    const uint16_t width = (uint16_t)((uint16_t)config.rotor.edge_turn[(true_sector() + 1) % 6] - start);
    TEST_ASSERT_TRUE((uint16_t)(estimate - start) <= width);
}

/* Electrical speeds of the paper's motor (23 pole pairs) from 60 to 640 r/min at 20 kHz, both ways. */
static const double SPEEDS[] = {0.00115,  0.0023,  0.005,  0.00863,  0.01227,
                                -0.00115, -0.0023, -0.005, -0.00863, -0.01227};
enum { SPEED_COUNT = sizeof(SPEEDS) / sizeof(SPEEDS[0]) };

void test_the_first_state_puts_the_angle_into_the_middle_of_its_sector(void)
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

void test_at_constant_speed_the_speed_is_known_to_one_period_in_a_turn(void)
{
    /* N = 1/speed periods make a turn; counting them is off by at most one: relative error 1/N (and 8e-5 of the reciprocal). */
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

void test_at_constant_speed_the_angle_follows_within_two_periods_worth_of_movement(void)
{
    /* An edge is seen up to one period late; until the next edge, a sixth of a turn later, a speed that is wrong by 1/N
     * adds a sixth of a period's movement. */
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

static void misplace_sensors(void)
{
    /* Up to 5 degrees electrical, different for each edge. */
    static const double WRONG_DEG[6] = {5.0, -3.0, 4.0, -5.0, 2.0, -4.0};
    for (int k = 0; k < 6; k++) {
        edge_turns[k] = k / 6.0 + (k == 0 ? 1.0 : WRONG_DEG[k]) / 360.0; /* edge 0 stays above zero */
    }
}

void test_calibrated_misplaced_sensors_are_as_good_as_well_placed_ones(void)
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

void test_misplaced_sensors_that_nobody_calibrated_do_not_disturb_the_speed(void)
{
    misplace_sensors(); /* the configuration still says 60 degrees each */
    for (int s = 0; s < SPEED_COUNT; s++) {
        restart();
        turn_for((int)(2.5 / fabs(SPEEDS[s])), SPEEDS[s]);
        for (int n = 0; n < 3000; n++) {
            turn(SPEEDS[s]);
            /* Six sectors make a turn wherever the sensors sit. */
            TEST_ASSERT_DOUBLE_WITHIN(fabs(SPEEDS[s]) * (fabs(SPEEDS[s]) * 1.01 + 1e-4), SPEEDS[s], speed_turns());
        }
    }
}

void test_the_estimate_never_leaves_the_reported_sector_while_the_speed_changes(void)
{
    for (int n = 0; n < 60000; n++) {
        turn(0.012 * sin(n * 2.0 * 3.14159265358979323846 / 30000.0)); /* two reversals */
        assert_inside_sector();
        TEST_ASSERT_TRUE(hall.valid);
        TEST_ASSERT_EQUAL_UINT16(0, hall.lost_edges);
    }
}

/* At a speed at which a rotor can turn round within a sector: 0.0005 turns a period are 10 electrical turns a second. */
void test_after_a_reversal_the_speed_has_the_new_sign_after_two_edges(void)
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

void test_a_rotor_that_swings_about_an_edge_never_has_a_speed(void)
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

void test_without_edges_the_speed_dies_away_and_a_quarter_of_a_second_is_standstill(void)
{
    turn_for(4000, 0.005);
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

void test_a_rotor_that_stops_is_not_believed_to_turn_for_longer_than_a_few_sectors(void)
{
    /* A sector took 33 periods. Twice that later the speed decays by 1/64 a period: 1 % is left after 64 ln 100 = 295. */
    turn_for(4000, 0.005);
    turn_for(2 * 34 + 34 + 300, 0.0);
    TEST_ASSERT_TRUE(fabs(speed_turns()) < 0.01 * 0.005 + 1e-7);
}

void test_an_impossible_state_is_ridden_through_like_a_bounce(void)
{
    turn_for(4000, 0.005);
    for (int n = 0; n < HALL_INVALID_PERIODS - 1; n++) {
        theta_turns += 0.005;
        hall_step(&hall, &config, n % 2 == 0 ? 0 : 7);
        TEST_ASSERT_TRUE(hall.valid);
        TEST_ASSERT_DOUBLE_WITHIN(0.02, 0.0, angle_error_turns()); /* extrapolated with a speed known to 0.5 % */
    }
}

/* Whatever a doubt began with: six edges in order end it, not fewer, and the angle has not got lost meanwhile. */
static void heals_after_six_edges(double speed)
{
    TEST_ASSERT_FALSE(hall.valid);
    int edges = 0;
    int sector = true_sector();
    while (!hall.valid && edges < 20) {
        turn(speed);
        edges += true_sector() != sector ? 1 : 0;
        sector = true_sector();
    }
    TEST_ASSERT_INT_WITHIN(1, 6, edges); /* the way back from a false sector may look like one */
    TEST_ASSERT_TRUE(edges <= 6);
    turn_for((int)(1.0 / fabs(speed)), speed);
    TEST_ASSERT_TRUE(hall.valid);
    TEST_ASSERT_DOUBLE_WITHIN(2.0 * fabs(speed) + 1e-4, 0.0, angle_error_turns());
}

void test_an_impossible_state_that_lasts_is_believed_and_a_turn_in_order_heals_it(void)
{
    for (int state = 0; state <= 7; state += 7) {
        restart();
        turn_for(4000, 0.005);
        for (int n = 0; n < HALL_INVALID_PERIODS; n++) {
            TEST_ASSERT_TRUE(hall.valid);
            theta_turns += 0.005;
            hall_step(&hall, &config, (uint8_t)state);
        }
        TEST_ASSERT_EQUAL_UINT16(1, hall.lost_edges);
        /* Dead reckoning: 64 periods with a speed known to 0.5 %, and a period of the last edge. */
        TEST_ASSERT_DOUBLE_WITHIN(0.01, 0.0, angle_error_turns());
        heals_after_six_edges(0.005);
    }
}

void test_a_standstill_with_a_possible_state_heals_a_doubt_and_one_with_an_impossible_state_does_not(void)
{
    turn_for(4000, 0.005);
    for (int n = 0; n < 20000; n++) {
        hall_step(&hall, &config, 7);
    }
    TEST_ASSERT_FALSE(hall.valid);
    TEST_ASSERT_EQUAL_INT32(0, hall.speed_q32);
    turn_for(config.drive.pwm_frequency_Hz / HALL_STANDSTILL_PER_S + 2, 0.0);
    TEST_ASSERT_TRUE(hall.valid);
    assert_inside_sector();
}

void test_before_the_first_good_state_the_angle_is_not_valid(void)
{
    hall_step(&hall, &config, 0);
    TEST_ASSERT_FALSE(hall.valid);
    hall_step(&hall, &config, 7);
    TEST_ASSERT_FALSE(hall.valid);
    turn(0.0);
    TEST_ASSERT_TRUE(hall.valid);
}

void test_a_skipped_sector_is_counted_and_a_turn_in_order_heals_it(void)
{
    for (int back = -1; back <= 1; back += 2) {
        for (int jump = 2; jump <= 4; jump++) {
            restart();
            turn_for(4000, back * 0.005);
            hall_step(&hall, &config, STATE_OF_SECTOR[(true_sector() + jump) % 6]); /* a spark, one period long */
            TEST_ASSERT_EQUAL_UINT16(1, hall.lost_edges);
            theta_turns += back * 0.005;
            TEST_ASSERT_DOUBLE_WITHIN(0.02, 0.0, angle_error_turns());
            heals_after_six_edges(back * 0.005);
        }
    }
}

void test_a_reversal_that_no_rotor_can_make_is_a_doubt_and_not_followed(void)
{
    turn_for(4000, 0.005); /* a sector in 33 periods */
    const int sector = true_sector();
    while (true_sector() == sector) {
        turn(0.005);
    }
    turn_for(10, 0.005); /* past the time of a bounce */
    theta_turns += 0.005;
    hall_step(&hall, &config, STATE_OF_SECTOR[sector]);
    TEST_ASSERT_EQUAL_UINT16(1, hall.lost_edges);
    TEST_ASSERT_DOUBLE_WITHIN(0.02, 0.0, angle_error_turns());
    TEST_ASSERT_DOUBLE_WITHIN(0.005 * 0.01, 0.005, speed_turns());
    heals_after_six_edges(0.005);
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
        hall_step(&hall, &config, STATE_OF_SECTOR[sector]);
        turn(speed_turns_per_period);
    }
}

void test_a_bounce_between_two_good_states_changes_nothing(void)
{
    for (int s = 0; s < SPEED_COUNT; s++) {
        restart();
        turn_for((int)(3.0 / fabs(SPEEDS[s])), SPEEDS[s]);
        /* An eighth of a sector's time is 1/48 turn; a bounce takes two periods each time it comes back. */
        const int times = (int)(1.0 / 48.0 / fabs(SPEEDS[s]) / 2.0) - 1;
        for (int edge = 0; edge < 12; edge++) {
            bounce(times > 3 ? 3 : (times > 0 ? times : 0), SPEEDS[s]);
            TEST_ASSERT_DOUBLE_WITHIN(fabs(SPEEDS[s]) * (fabs(SPEEDS[s]) * 1.01 + 1e-4), SPEEDS[s], speed_turns());
            TEST_ASSERT_DOUBLE_WITHIN(2.0 * fabs(SPEEDS[s]) + 1e-4, 0.0, angle_error_turns());
            TEST_ASSERT_TRUE(hall.valid);
            TEST_ASSERT_EQUAL_UINT16(0, hall.lost_edges);
        }
    }
}

/* From when it fails until half a second later: the angle never gets lost, so that the torque can leave in its ramp. */
void test_with_a_stuck_sensor_the_angle_goes_on_within_sixty_degrees_and_is_never_believed_again(void)
{
    for (int sensor = 0; sensor < 3; sensor++) {
        for (int stuck = 0; stuck <= 1; stuck++) {
            for (int s = 0; s < SPEED_COUNT; s++) {
                for (int phase = 0; phase < 12; phase++) {
                    restart();
                    theta_turns = phase / 12.0;
                    turn_for((int)(2.0 / fabs(SPEEDS[s])), SPEEDS[s]);
                    double worst = 0.0;
                    for (int n = 0; n < 10000; n++) {
                        theta_turns += SPEEDS[s];
                        const unsigned healthy = STATE_OF_SECTOR[true_sector()];
                        const unsigned bit = 1U << sensor;
                        hall_step(&hall, &config, (uint8_t)(stuck != 0 ? (healthy | bit) : (healthy & ~bit)));
                        const bool late = n * fabs(SPEEDS[s]) > 1.0;
                        TEST_ASSERT_FALSE(late && hall.valid);
                        worst = fmax(worst, fabs(angle_error_turns()));
                        if (late) {
                            /* A sector's time is known to a period, 6 v of it, which counts for a quarter and adds up over
                             * four dark sectors, v; a period for each edge, halves of both from the turns before. */
                            TEST_ASSERT_DOUBLE_WITHIN(6.0 * fabs(SPEEDS[s]) + 0.003, 0.0, angle_error_turns());
                        }
                    }
                    TEST_ASSERT_TRUE(worst < 0.36); /* until it is noticed: two sectors */
                }
            }
        }
    }
}

void test_a_stuck_sensor_is_noticed_within_one_electrical_turn(void)
{
    for (int sensor = 0; sensor < 3; sensor++) {
        for (int stuck = 0; stuck <= 1; stuck++) {
            for (int s = 0; s < SPEED_COUNT; s++) {
                for (int phase = 0; phase < 12; phase++) { /* where in the turn it fails */
                    restart();
                    theta_turns = phase / 12.0;
                    turn_for((int)(2.0 / fabs(SPEEDS[s])), SPEEDS[s]);
                    bool noticed = false;
                    for (double gone = 0.0; gone < 1.0 && !noticed; gone += fabs(SPEEDS[s])) {
                        theta_turns += SPEEDS[s];
                        const unsigned healthy = STATE_OF_SECTOR[true_sector()];
                        const unsigned bit = 1U << sensor;
                        hall_step(&hall, &config, (uint8_t)(stuck != 0 ? (healthy | bit) : (healthy & ~bit)));
                        noticed = hall.lost_edges > 0 || !hall.valid;
                    }
                    TEST_ASSERT_TRUE(noticed);
                }
            }
        }
    }
}

void test_only_the_three_sensor_bits_are_read(void)
{
    turn(0.0);
    const uint32_t theta_q32 = hall.theta_q32;
    hall_step(&hall, &config, (uint8_t)(STATE_OF_SECTOR[true_sector()] | 0xF8U));
    TEST_ASSERT_EQUAL_UINT32(theta_q32, hall.theta_q32);
    TEST_ASSERT_TRUE(hall.valid);
}

void test_a_wait_of_hours_wraps_no_counter(void)
{
    turn_for(200000, 0.0);
    TEST_ASSERT_EQUAL_INT32(0, hall.speed_q32);
    turn_for(4000, 0.005);
    TEST_ASSERT_DOUBLE_WITHIN(0.005 * 0.006, 0.005, speed_turns());
    for (int n = 0; n < 200000; n++) {
        hall_step(&hall, &config, 7);
    }
    TEST_ASSERT_FALSE(hall.valid);
}

/* SPDX-License-Identifier: Apache-2.0 */
/* Hall fault ride-through: contradicting sensors are detected, and dead reckoning continues the
 * angle so that the torque can fall in a ramp. */
#include "hall_rig.h"

void setUp(void)
{
    rig_up();
}

void tearDown(void) {}

void test_short_impossible_state_is_ignored_like_a_bounce(void)
{
    turn_for(4000, 0.005);
    for (int n = 0; n < HALL_INVALID_PERIODS - 1; n++) {
        theta_turns += 0.005;
        period(n % 2 == 0 ? 0 : 7);
        TEST_ASSERT_TRUE(hall.valid);
        TEST_ASSERT_DOUBLE_WITHIN(
            0.02, 0.0, angle_error_turns()); /* extrapolated with a speed known to 0.5 % */
    }
}

/* Six edges in order end a ride-through, with the correct angle. */
static void assert_healed_after_six_edges(double speed)
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

void test_lasting_impossible_state_is_a_fault_that_heals_after_a_turn_in_order(void)
{
    for (int state = 0; state <= 7; state += 7) {
        restart();
        turn_for(4000, 0.005);
        for (int n = 0; n < HALL_INVALID_PERIODS; n++) {
            TEST_ASSERT_TRUE(hall.valid);
            theta_turns += 0.005;
            period((uint8_t)state);
        }
        TEST_ASSERT_EQUAL_UINT16(1, hall.faults);
        /* Dead reckoning: 64 periods with a speed known to 0.5 %, and a period of the last edge. */
        TEST_ASSERT_DOUBLE_WITHIN(0.01, 0.0, angle_error_turns());
        assert_healed_after_six_edges(0.005);
    }
}

/* An impossible state during a ride-through restarts the count of edges. */
void test_impossible_state_during_ride_through_restarts_the_count_of_edges(void)
{
    turn_for(4000, 0.005);
    for (int n = 0; n < HALL_INVALID_PERIODS; n++) {
        theta_turns += 0.005;
        period(7);
    }
    while (hall.plausible_edges < HALL_PLAUSIBLE_EDGES - 1) {
        turn(0.005);
        TEST_ASSERT_FALSE(hall.valid);
    }
    theta_turns += 0.005;
    period(7);
    assert_healed_after_six_edges(0.005);
}

void test_bouncing_edge_during_ride_through_counts_once(void)
{
    turn_for(4000, 0.005);
    for (int n = 0; n < HALL_INVALID_PERIODS; n++) {
        theta_turns += 0.005;
        period(7);
    }
    TEST_ASSERT_FALSE(hall.valid);
    int edges = 0;
    while (!hall.valid && edges < 20) {
        const int left = true_sector();
        turn(0.005);
        if (true_sector() != left && !hall.valid) {
            edges++;
            theta_turns +=
                0.005; /* back for one period, of the four that are an eighth of a sector's time */
            period(STATE_OF_SECTOR[left]);
        }
    }
    TEST_ASSERT_INT_WITHIN(1, 6,
                           edges + 1); /* the last edge ends the ride-through before it bounces */
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 0.0, angle_error_turns());
}

/* 40 Nm fall to zero at 400 Nm/s in 0.1 s, 2000 periods. The speed is known to one period in a turn
 * of 200, so the angle of ten turns to 0.05. With a constant angle the remaining torque would
 * change its sign and drive the wheel. */
void test_dead_reckoning_lasts_for_the_torque_ramp_after_loss_of_all_sensors(void)
{
    for (int state = 0; state <= 7; state += 7) {
        restart();
        turn_for(4000, 0.005);
        for (int n = 0; n < 2000; n++) {
            theta_turns += 0.005;
            period((uint8_t)state);
            TEST_ASSERT_DOUBLE_WITHIN(0.06, 0.0, angle_error_turns());
        }
        TEST_ASSERT_FALSE(hall.valid);
    }
}

void test_standstill_heals_a_fault_only_with_a_valid_state(void)
{
    turn_for(4000, 0.005);
    for (int n = 0; n < 20000; n++) {
        period(7);
    }
    TEST_ASSERT_FALSE(hall.valid);
    TEST_ASSERT_EQUAL_INT32(0, hall.speed_q32);
    turn_for(config.drive.pwm_frequency_Hz / HALL_STANDSTILL_PER_S + 2, 0.0);
    TEST_ASSERT_TRUE(hall.valid);
    assert_inside_sector();
}

/* One line bounces, so that no sequence of edges gives a speed: a wheel that turns all the same. */
void test_edges_of_a_rotor_that_counts_as_standing_are_counted(void)
{
    turn_for(4000, 0.005);
    for (int n = 0; n < 20000; n++) {
        period(7);
    }
    TEST_ASSERT_EQUAL_INT32(0, hall.speed_q32);
    const uint16_t before = hall.faults;
    for (int edge = 0; edge < 10; edge++) {
        for (int n = 0; n < 100; n++) {
            period(STATE_OF_SECTOR[edge * 2 % 6]);
        }
    }
    TEST_ASSERT_FALSE(hall.valid);
    TEST_ASSERT_EQUAL_INT32(0, hall.speed_q32);
    TEST_ASSERT_UINT16_WITHIN(1, before + 10, hall.faults);
}

void test_angle_is_invalid_before_the_first_valid_state(void)
{
    period(0);
    TEST_ASSERT_FALSE(hall.valid);
    period(7);
    TEST_ASSERT_FALSE(hall.valid);
    turn(0.0);
    TEST_ASSERT_TRUE(hall.valid);
}

void test_skipped_sector_is_counted_and_heals_after_a_turn_in_order(void)
{
    for (int back = -1; back <= 1; back += 2) {
        for (int jump = 2; jump <= 4; jump++) {
            restart();
            turn_for(4000, back * 0.005);
            period(STATE_OF_SECTOR[(true_sector() + jump) % 6]); /* a disturbance of one period */
            TEST_ASSERT_EQUAL_UINT16(1, hall.faults);
            theta_turns += back * 0.005;
            TEST_ASSERT_DOUBLE_WITHIN(0.02, 0.0, angle_error_turns());
            assert_healed_after_six_edges(back * 0.005);
        }
    }
}

void test_impossible_reversal_starts_ride_through(void)
{
    turn_for(4000, 0.005); /* a sector in 33 periods */
    const int sector = true_sector();
    while (true_sector() == sector) {
        turn(0.005);
    }
    turn_for(10, 0.005); /* past the time of a bounce */
    theta_turns += 0.005;
    period(STATE_OF_SECTOR[sector]);
    TEST_ASSERT_EQUAL_UINT16(1, hall.faults);
    TEST_ASSERT_DOUBLE_WITHIN(0.02, 0.0, angle_error_turns());
    TEST_ASSERT_DOUBLE_WITHIN(0.005 * 0.01, 0.005, speed_turns());
    assert_healed_after_six_edges(0.005);
}

/* A sector in 100 periods is overdue after 200 of them, 10 ms; then the rotor may have stopped, and
 * an edge backwards is its reversal. */
void test_a_reversal_after_an_overdue_edge_is_no_fault(void)
{
    for (int late = 0; late < 2; late++) {
        restart();
        turn_for(4000, 1.0 / 600.0);
        const int sector = true_sector();
        while (true_sector() == sector) {
            turn(1.0 / 600.0);
        }
        const double edge_turns_seen = theta_turns;
        turn_for(late ? 210 : 150, 0.0); /* it rests just past the edge */
        theta_turns = edge_turns_seen - 2.0 / 600.0;
        turn(0.0);
        TEST_ASSERT_EQUAL_INT(sector, true_sector());
        TEST_ASSERT_EQUAL_UINT16(late ? 0 : 1, hall.faults);
    }
}

/* For half a second after the failure the angle error stays bounded, so that the torque can fall in
 * a ramp. */
void test_stuck_sensor_keeps_a_bounded_angle_error_and_never_heals(void)
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
                        period((uint8_t)(stuck != 0 ? (healthy | bit) : (healthy & ~bit)));
                        const bool late = n * fabs(SPEEDS[s]) > 1.0;
                        TEST_ASSERT_FALSE(late && hall.valid);
                        worst = fmax(worst, fabs(angle_error_turns()));
                        if (late) {
                            /* At first the edge caused by the failure may have been accepted: a
                             * sector. Eight turns later, a sector's time is known to a period, 6 v
                             * of it, which counts for a quarter and adds up over four dark sectors,
                             * v; a period for each edge, halves of both from turns before. */
                            const double most =
                                n * fabs(SPEEDS[s]) < 8.0 ? 0.18 : 6.0 * fabs(SPEEDS[s]) + 0.006;
                            TEST_ASSERT_DOUBLE_WITHIN(most, 0.0, angle_error_turns());
                        }
                    }
                    TEST_ASSERT_TRUE(worst < 0.36); /* until it is detected: two sectors */
                }
            }
        }
    }
}

void test_stuck_sensor_is_detected_within_one_electrical_turn(void)
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
                        period((uint8_t)(stuck != 0 ? (healthy | bit) : (healthy & ~bit)));
                        noticed = hall.faults > 0 || !hall.valid;
                    }
                    TEST_ASSERT_TRUE(noticed);
                }
            }
        }
    }
}

/* No edge for one and a half sectors of 1/6 turn at the last speed: 50 periods of 0.005 turns. */
void test_impossible_stop_is_detected_half_a_sector_beyond_the_sector(void)
{
    turn_for(4000, 0.005);
    int32_t since_edge = hall.periods_since_edge;
    for (int n = 0; n < 200 && hall.valid; n++) {
        turn(0.0);
        since_edge = hall.periods_since_edge;
    }
    TEST_ASSERT_FALSE(hall.valid);
    TEST_ASSERT_INT32_WITHIN(1, 51, since_edge);
}

/* From 100 turns a second to zero within two sectors: dead sensors. */
void test_impossible_stop_starts_ride_through_and_heals_at_standstill(void)
{
    turn_for(4000, 0.005);
    turn_for(2 * 34 + 34, 0.0);
    TEST_ASSERT_FALSE(hall.valid);
    TEST_ASSERT_EQUAL_UINT16(1, hall.faults);
    /* Overdue after four sectors now; then 1/64 a period: 1 % is left after 295 periods. */
    turn_for(2 * 34 + 300, 0.0);
    TEST_ASSERT_TRUE(fabs(speed_turns()) < 0.01 * 0.005 + 1e-7);
    turn_for(config.drive.pwm_frequency_Hz / HALL_STANDSTILL_PER_S + 2, 0.0);
    TEST_ASSERT_TRUE(hall.valid);
    TEST_ASSERT_EQUAL_INT32(0, hall.speed_q32);
    assert_inside_sector();
}

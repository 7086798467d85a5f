/* SPDX-License-Identifier: Apache-2.0 */
/* Incremental encoder: a simulated shaft, its counts and its index, and the estimate from them. */
#include <math.h>

#include "encoder.h"
#include "unity.h"

extern const config_t CONFIG_LU2013;

static config_t config;
static encoder_t encoder;
static double shaft_turns; /* true mechanical angle; the index lies at whole numbers */
static int lost_counts;    /* that the counter has missed so far */

enum { COUNTER_START = 60000 }; /* of the 16-bit counter: it soon wraps */

static void restart(void)
{
    encoder_init(&encoder, &config);
    shaft_turns = -0.37;
    lost_counts = 0;
}

static void configure(int32_t counts, int32_t reversed)
{
    config.rotor.encoder_counts = counts;
    config.rotor.encoder_reversed = reversed;
    restart();
}

void setUp(void)
{
    config = CONFIG_LU2013;
    config.drive.pwm_frequency_Hz = 20000;
    config.rotor.sensor = CONFIG_ROTOR_ENCODER;
    config.rotor.encoder_index_turn = 12345;
    config.rotor.encoder_index_tolerance_counts = 4;
    configure(4096, 0);
}

void tearDown(void) {}

static uint16_t counter_at(double turns)
{
    const int64_t counts = (int64_t)floor(turns * config.rotor.encoder_counts) - lost_counts;
    return (uint16_t)(COUNTER_START + (config.rotor.encoder_reversed != 0 ? -counts : counts));
}

/* One period at a mechanical speed. The index is a line one count long. */
static void turn(double turns_a_period)
{
    const double before = shaft_turns;
    shaft_turns += turns_a_period;
    encoder_input_t in = {.count = counter_at(shaft_turns)};
    const double front = floor(turns_a_period >= 0.0 ? shaft_turns : before);
    if (front > before || (turns_a_period < 0.0 && front > shaft_turns)) {
        in.index = true;
        in.index_count = counter_at(front + 1e-9);
    }
    encoder_step(&encoder, &config, &in);
}

static void turn_for(double turns, double turns_a_period)
{
    for (int n = (int)ceil(turns / fabs(turns_a_period)); n > 0; n--) {
        turn(turns_a_period);
    }
}

/* Error of the estimate, electrical turns, positive ahead of the true angle. */
static double angle_error_turns(void)
{
    const double truth =
        shaft_turns * config.motor.pole_pairs + config.rotor.encoder_index_turn / 65536.0;
    const double error = encoder.theta_turn / 65536.0 - truth;
    return error - floor(error + 0.5);
}

static double count_turns(void)
{
    return (double)config.motor.pole_pairs / config.rotor.encoder_counts;
}

static const double SPEEDS[] = {2e-5, 1e-4, 5e-4, -2e-5, -5e-4}; /* mechanical, 24 to 600 r/min */
enum { SPEED_COUNT = sizeof(SPEEDS) / sizeof(SPEEDS[0]) };

void test_angle_is_invalid_before_the_first_index(void)
{
    for (int s = 0; s < SPEED_COUNT; s++) {
        restart();
        const double to_index = SPEEDS[s] > 0.0 ? 0.37 : 0.63;
        turn_for(to_index - 0.01, SPEEDS[s]);
        TEST_ASSERT_FALSE(encoder.valid);
        turn_for(0.02, SPEEDS[s]);
        TEST_ASSERT_TRUE(encoder.valid);
        TEST_ASSERT_EQUAL_UINT16(0, encoder.faults);
        TEST_ASSERT_DOUBLE_WITHIN(1.6 * count_turns(), 0.0, angle_error_turns());
    }
}

void test_angle_at_standstill_is_the_middle_of_the_count(void)
{
    configure(1000, 0); /* 23 pole pairs: a count is 8 degrees electrical */
    turn_for(0.5, 1e-4);
    for (int n = 0; n < 4000; n++) {
        turn(0.0);
    }
    const double middle = (floor(shaft_turns * 1000.0) + 0.5) / 1000.0 * config.motor.pole_pairs;
    const double error =
        encoder.theta_turn / 65536.0 - config.rotor.encoder_index_turn / 65536.0 - middle;
    TEST_ASSERT_DOUBLE_WITHIN(0.02 * count_turns(), 0.0, error - floor(error + 0.5));
}

void test_first_index_corrects_the_angle_and_not_the_speed(void)
{
    configure(65536, 0);
    shaft_turns =
        -0.38; /* the index moves the angle by 23 * 0.38 turns: a quarter short of whole ones */
    turn_for(0.37, 5e-4);
    while (!encoder.valid) {
        turn(5e-4);
    }
    for (int n = 0; n < 50; n++) {
        const double speed = encoder.tracker.speed_q32 / 4294967296.0;
        TEST_ASSERT_DOUBLE_WITHIN(0.02 * 5e-4 * config.motor.pole_pairs,
                                  5e-4 * config.motor.pole_pairs, speed);
        turn(5e-4);
    }
}

/* Numbers of counts that are no power of two, counters that wrap within a turn, both directions. */
void test_angle_error_is_at_most_one_and_a_half_counts_without_drift(void)
{
    static const int32_t COUNTS[] = {1000, 4096, 10000, 65536};
    for (int c = 0; c < 4; c++) {
        for (int reversed = 0; reversed <= 1; reversed++) {
            for (int s = 0; s < SPEED_COUNT; s++) {
                configure(COUNTS[c], reversed);
                turn_for(2.0, SPEEDS[s]);
                for (int n = 0; n < 60000; n++) {
                    turn(SPEEDS[s]);
                    TEST_ASSERT_TRUE(encoder.valid);
                    /* One count beside the middle of the one that is shown, half a count either
                     * side of that middle. */
                    TEST_ASSERT_DOUBLE_WITHIN(1.5 * count_turns() + 3.0 / 65536.0, 0.0,
                                              angle_error_turns());
                }
                TEST_ASSERT_EQUAL_UINT16(0, encoder.faults);
            }
        }
    }
}

void test_tracking_loop_interpolates_between_counts_at_constant_speed(void)
{
    for (int s = 0; s < SPEED_COUNT; s++) {
        restart();
        turn_for(2.5, SPEEDS[s]);
        double worst = 0.0;
        for (int n = 0; n < 20000; n++) {
            turn(SPEEDS[s]);
            worst = fmax(worst, fabs(angle_error_turns()));
            /* The error is a saw-tooth of one count, at these speeds 25 periods long at most (the
             * beat of counts and samples at 2.048 counts a period takes 21). Added up in the
             * integrator: k_i * 25 / 8 of a count. */
            const double speed = encoder.tracker.speed_q32 / 4294967296.0 / config.motor.pole_pairs;
            const double k_i = config.rotor.pll_integral_q24 / 16777216.0;
            TEST_ASSERT_DOUBLE_WITHIN(k_i * 25.0 / 8.0 / config.rotor.encoder_counts + 1e-9,
                                      SPEEDS[s], speed);
        }
        TEST_ASSERT_TRUE(worst < 1.5 * count_turns());
    }
}

void test_angle_error_during_acceleration_is_bounded_in_counts(void)
{
    turn_for(2.0, 2e-4);
    /* A locking wheel: 240 r/min to nothing in 25 ms. The loop of 50 Hz alone would lie a / w^2 =
     * 0.37 electrical turns beside the truth: 0.0046 turns a period in 500 of them is 9.2e-6, over
     * (2 pi 50 / 20 000)^2 = 2.47e-4. */
    for (double speed = 2e-4; speed > 0.0; speed -= 4e-7) {
        turn(speed);
        TEST_ASSERT_DOUBLE_WITHIN(1.6 * count_turns(), 0.0, angle_error_turns());
    }
}

void test_reversals_over_the_index_are_no_fault(void)
{
    turn_for(1.37, 1e-4);
    for (int n = 0; n < 20000; n++) {
        const double next = 1.0 + 0.003 * sin(n * 0.01);
        turn(next - shaft_turns);
        TEST_ASSERT_TRUE(encoder.valid);
    }
    TEST_ASSERT_EQUAL_UINT16(0, encoder.faults);
}

void test_lost_or_extra_counts_invalidate_the_angle_until_two_index_pulses_agree(void)
{
    for (int sign = -1; sign <= 1; sign += 2) {
        restart();
        turn_for(1.5, 1e-4);
        lost_counts = sign * 15;
        turn_for(0.1, 1e-4);
        lost_counts = sign * 30; /* 61 degrees electrical in all */
        turn_for(0.1, 1e-4);
        TEST_ASSERT_TRUE(encoder.valid); /* not detected before the index */
        turn_for(0.8, 1e-4);
        TEST_ASSERT_EQUAL_UINT16(1, encoder.faults);
        TEST_ASSERT_FALSE(encoder.valid);
        turn_for(1.0, 1e-4); /* the next pulse confirms the new reference */
        TEST_ASSERT_EQUAL_UINT16(1, encoder.faults);
        TEST_ASSERT_TRUE(encoder.valid);
        TEST_ASSERT_DOUBLE_WITHIN(1.6 * count_turns(), 0.0, angle_error_turns());
    }
}

void test_single_lost_counts_add_up_to_a_fault(void)
{
    turn_for(1.5, 1e-4);
    int turns = 0;
    while (encoder.faults == 0 && turns < 20) {
        lost_counts++;
        turn_for(1.0, 1e-4);
        turns++;
    }
    /* Tolerated up to 4 counts, 8 degrees electrical; the fifth is too many. */
    TEST_ASSERT_EQUAL_INT(5, turns);
}

void test_false_index_pulse_invalidates_the_angle_until_two_pulses_agree(void)
{
    turn_for(1.5, 1e-4);
    const uint16_t here = counter_at(shaft_turns);
    const encoder_input_t spark = {
        .count = here, .index_count = (uint16_t)(here - 100U), .index = true};
    encoder_step(&encoder, &config, &spark);
    TEST_ASSERT_FALSE(encoder.valid);
    TEST_ASSERT_EQUAL_UINT16(1, encoder.faults);
    turn_for(1.0, 1e-4); /* correct, but contradicts the false pulse */
    TEST_ASSERT_FALSE(encoder.valid);
    TEST_ASSERT_EQUAL_UINT16(2, encoder.faults);
    turn_for(1.0, 1e-4);
    TEST_ASSERT_TRUE(encoder.valid);
    TEST_ASSERT_DOUBLE_WITHIN(1.6 * count_turns(), 0.0, angle_error_turns());
}

void test_missing_index_is_a_warning_per_turn_and_the_angle_stays_valid(void)
{
    for (int sign = -1; sign <= 1; sign += 2) {
        restart();
        turn_for(1.5, sign * 1e-4);
        for (int n = 0; n < 30000; n++) {
            shaft_turns += sign * 1e-4;
            const encoder_input_t in = {.count = counter_at(shaft_turns)};
            encoder_step(&encoder, &config, &in);
            TEST_ASSERT_TRUE(encoder.valid);
            TEST_ASSERT_DOUBLE_WITHIN(1.6 * count_turns(), 0.0, angle_error_turns());
        }
        TEST_ASSERT_EQUAL_UINT16(3, encoder.faults);
    }
}

/* An eighth of an electrical turn and a count: with 4096 counts and 23 pole pairs, 23 counts. */
void test_jump_of_an_eighth_of_an_electrical_turn_in_a_period_is_a_fault(void)
{
    for (int beyond = 0; beyond <= 1; beyond++) {
        restart();
        turn_for(1.5, 1e-4);
        encoder_input_t in = {.count = (uint16_t)(counter_at(shaft_turns) + 23 + beyond)};
        encoder_step(&encoder, &config, &in);
        TEST_ASSERT_EQUAL_INT(beyond == 0, encoder.valid);
        TEST_ASSERT_EQUAL_UINT16(beyond, encoder.faults);
    }
}

/* After an index that contradicted the counts one that agrees makes the angle good again, from
 * whichever side it is met: at the same place, a turn forwards, or a turn backwards. */
void test_next_agreeing_index_makes_the_angle_valid_again(void)
{
    static const int32_t AWAY[] = {0, 4096, -4096};
    for (int a = 0; a < 3; a++) {
        restart();
        turn_for(1.5, 1e-4);
        const uint16_t here = counter_at(shaft_turns);
        encoder_input_t in = {.count = here, .index_count = here, .index = true};
        encoder_step(&encoder, &config, &in);
        TEST_ASSERT_FALSE(encoder.valid);
        in.index = false;
        for (int n = 1; n <= 256; n++) {
            in.count = (uint16_t)(here + AWAY[a] * n / 256);
            encoder_step(&encoder, &config, &in);
            TEST_ASSERT_FALSE(encoder.valid);
        }
        in.index_count = in.count;
        in.index = true;
        encoder_step(&encoder, &config, &in);
        TEST_ASSERT_TRUE(encoder.valid);
        TEST_ASSERT_EQUAL_UINT16(1, encoder.faults);
        TEST_ASSERT_EQUAL_INT32(0, encoder.position_counts);
    }
}

/* Between two counts the tracked angle goes on: the raw count is wrong by 1/sqrt 12 of a count
 * (root of the mean square). The loop leaves a beat of at most a tenth of that; half as much is
 * asked for. */
void test_tracked_angle_is_more_accurate_than_the_count(void)
{
    configure(1000, 0);
    turn_for(2.0, 7.3e-5);
    double sum = 0.0;
    enum { LOOKS = 20000 };
    for (int n = 0; n < LOOKS; n++) {
        turn(7.3e-5);
        sum += angle_error_turns() * angle_error_turns();
    }
    TEST_ASSERT_TRUE(sqrt(sum / LOOKS) < 0.5 / sqrt(12.0) * count_turns());
}

/* An angle to let the torque go with, and a speed that does not vanish: the counts go on from where
 * the rotor is. */
void test_angle_continues_with_the_last_speed_after_an_impossible_jump(void)
{
    turn_for(1.5, 1e-4);
    const int32_t speed_q32 = encoder.tracker.speed_q32;
    lost_counts = 2000;
    turn(1e-4);
    TEST_ASSERT_FALSE(encoder.valid);
    TEST_ASSERT_EQUAL_UINT16(1, encoder.faults);
    TEST_ASSERT_EQUAL_INT32(speed_q32, encoder.tracker.speed_q32);
    for (int n = 0; n < 4500; n++) { /* 1.5 turns came before: the index is half a turn away */
        turn(1e-4);
        TEST_ASSERT_FALSE(encoder.valid);
        TEST_ASSERT_DOUBLE_WITHIN(3.0 * count_turns(), 0.0, angle_error_turns());
    }
    turn_for(0.6, 1e-4);
    TEST_ASSERT_TRUE(encoder.valid);
    TEST_ASSERT_EQUAL_UINT16(1, encoder.faults);
    TEST_ASSERT_DOUBLE_WITHIN(1.6 * count_turns(), 0.0, angle_error_turns());
}

void test_without_a_count_the_speed_decays_and_the_angle_stays_valid(void)
{
    turn_for(1.5, 1e-4);
    const encoder_input_t still = {.count = counter_at(shaft_turns)};
    for (int n = 0; n < 70000; n++) {
        encoder_step(&encoder, &config, &still);
    }
    TEST_ASSERT_TRUE(encoder.valid);
    TEST_ASSERT_INT32_WITHIN(100, 0, encoder.tracker.speed_q32);
}

void test_dither_between_two_counts_gives_less_than_1_rpm(void)
{
    turn_for(1.5, 1e-4);
    double largest = 0.0;
    const uint16_t here = counter_at(shaft_turns);
    for (int n = 0; n < 40000; n++) {
        const encoder_input_t in = {.count = (uint16_t)(here + (n / 7) % 2)};
        encoder_step(&encoder, &config, &in);
        largest = n > 10000 ? fmax(largest, fabs((double)encoder.tracker.speed_q32)) : 0.0;
    }
    /* One count to and fro in 14 periods: k_i * 7 periods * half a count, 1e-3 counts a period, is
     * 0.3 r/min. */
    TEST_ASSERT_TRUE(largest / 4294967296.0 < 1e-3 * count_turns());
    TEST_ASSERT_TRUE(encoder.valid);
}

/* SPDX-License-Identifier: Apache-2.0 */
/* A reading that is gone in the next period: whatever it shows and whenever it comes, the estimate
 * goes on as if it had not been. One that lasts is a fault as before, a period later. */
#include <math.h>

#include "hall_rig.h"
#include "unity.h"

enum { DISTURBED_EVERY = 97, TURNS_BEFORE = 8 };

static hall_t before, plain, plain_before;
static double speed_turns_per_period;

void setUp(void)
{
    rig_up();
    speed_turns_per_period = 0.0;
    hall_init(&before, &config);
    plain = hall;
    plain_before = before;
}

void tearDown(void) {}

/* As rotor_step() does it. */
static bool read_sensors(hall_t *at, hall_t *at_before, uint8_t sensors)
{
    const hall_observed_t unknown = {.known = false};
    return hall_extrapolate(at, sensors) ||
           hall_process_reading(at, at_before, &config, sensors, unknown);
}

static uint8_t move(void)
{
    theta_turns += speed_turns_per_period;
    return STATE_OF_SECTOR[true_sector()];
}

static void turn_undisturbed(int periods)
{
    for (int n = 0; n < periods; n++) {
        (void)read_sensors(&hall, &before, move());
    }
    plain = hall;
    plain_before = before;
}

static double apart_turns(void)
{
    return fabs((int32_t)(hall.theta_q32 - plain.theta_q32) / 4294967296.0);
}

/* At a true edge a reading of the sector before it delays the edge by two periods, so that what the
 * edge corrects differs by no more than their movement. */
static void disturb_for_a_while(int periods)
{
    for (int n = 1; n < periods; n++) {
        const uint8_t sensors = move();
        const bool disturbed = n % DISTURBED_EVERY == 0;
        const uint8_t wrong = (uint8_t)((sensors + 1 + n / DISTURBED_EVERY % 7) % 8);
        (void)read_sensors(&plain, &plain_before, sensors);
        (void)read_sensors(&hall, &before, disturbed ? wrong : sensors);
        if (!disturbed && (n - 1) % DISTURBED_EVERY != 0) {
            TEST_ASSERT_TRUE(hall.valid);
            TEST_ASSERT_EQUAL_UINT16(0, hall.faults);
            TEST_ASSERT_TRUE(apart_turns() <= 3.0 * fabs(speed_turns_per_period) + 1e-4);
        }
    }
}

/* From a sector in 100 ms to one in six periods, either way. */
void test_a_reading_of_one_period_changes_neither_angle_nor_speed(void)
{
    static const double EACH_WAY[] = {1.0 / 12000.0, 1.0 / 1500.0, 1.0 / 300.0, 1.0 / 60.0,
                                      1.0 / 36.5};
    for (int k = 0; k < 10; k++) {
        setUp();
        speed_turns_per_period = EACH_WAY[k / 2] * (k % 2 == 0 ? 1.0 : -1.0);
        turn_undisturbed((int)(TURNS_BEFORE / EACH_WAY[k / 2]));
        TEST_ASSERT_TRUE(hall.valid);
        disturb_for_a_while(20000);
    }
}

void test_a_reading_of_one_period_of_a_standing_rotor_moves_nothing(void)
{
    turn_undisturbed(10000);
    const uint32_t theta_q32 = hall.theta_q32;
    for (uint8_t wrong = 0; wrong < 8; wrong++) {
        (void)read_sensors(&hall, &before, wrong);
        (void)read_sensors(&hall, &before, move());
        TEST_ASSERT_EQUAL_HEX32(theta_q32, hall.theta_q32);
        TEST_ASSERT_EQUAL_INT32(0, hall.speed_q32);
        TEST_ASSERT_TRUE(hall.valid);
        TEST_ASSERT_EQUAL_UINT16(0, hall.faults);
        turn_undisturbed(10);
    }
}

/* Two sectors back at once, for two periods and longer. */
void test_a_skipped_sector_that_stays_is_a_fault_in_the_second_period(void)
{
    speed_turns_per_period = 1.0 / 300.0;
    turn_undisturbed(3000);
    const uint8_t skipped = STATE_OF_SECTOR[(true_sector() + 3) % 6];
    TEST_ASSERT_FALSE(read_sensors(&hall, &before, skipped));
    TEST_ASSERT_TRUE(before.valid);
    TEST_ASSERT_TRUE(read_sensors(&hall, &before, skipped));
    TEST_ASSERT_FALSE(hall.valid);
    TEST_ASSERT_EQUAL_UINT16(1, hall.faults);
    TEST_ASSERT_TRUE(read_sensors(&hall, &before, move()));
    TEST_ASSERT_EQUAL_UINT16(1, hall.faults);
}

/* After half of the last sector's time, and after nearly all of it. */
void test_an_edge_that_is_far_too_early_is_confirmed_first(void)
{
    for (int early = 0; early <= 1; early++) {
        setUp();
        speed_turns_per_period = 1.0 / 600.0;
        turn_undisturbed(6000);
        while (hall.periods_since_edge != (early == 1 ? 50 : 90)) {
            (void)read_sensors(&hall, &before, move());
        }
        theta_turns += early == 1 ? 0.5 / 6.0 : 0.1 / 6.0;
        TEST_ASSERT_EQUAL_INT(early == 0, read_sensors(&hall, &before, move()));
        TEST_ASSERT_TRUE(read_sensors(&hall, &before, move()));
        TEST_ASSERT_TRUE(hall.valid);
    }
}

/* At a sector in 0.2 s, where a rotor may turn round. */
void test_a_reversal_counts_from_its_second_period_on(void)
{
    speed_turns_per_period = 1.0 / 24000.0;
    turn_undisturbed(48000);
    const int32_t speed_q32 = hall.speed_q32;
    TEST_ASSERT_GREATER_THAN_INT32(0, speed_q32);
    while (hall.periods_since_edge != 1) {
        (void)read_sensors(&hall, &before, move());
    }
    turn_undisturbed(3900);
    theta_turns -= 1.0 / 6.0;
    speed_turns_per_period = 0.0;
    TEST_ASSERT_FALSE(read_sensors(&hall, &before, move()));
    TEST_ASSERT_TRUE(read_sensors(&hall, &before, move()));
    TEST_ASSERT_EQUAL_INT(-1, hall.direction);
    TEST_ASSERT_TRUE(hall.valid);
}

/* A sector in each period, the fastest: no edge is a disturbance. */
void test_edges_in_every_period_are_all_counted(void)
{
    speed_turns_per_period = 1.0 / 6.0;
    turn_undisturbed(100);
    TEST_ASSERT_TRUE(hall.valid);
    TEST_ASSERT_EQUAL_UINT16(0, hall.faults);
    TEST_ASSERT_DOUBLE_WITHIN(0.02, 1.0 / 6.0, speed_turns());
}

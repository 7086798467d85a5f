/* SPDX-License-Identifier: Apache-2.0 */
/* Sectors of the hall sensors: geometry, the time they took, the angle inside them. */
#include <math.h>

#include "hall.c" /* the sector functions are private */
#include "random_values.h"
#include "unity.h"

extern const config_t CONFIG_LU2013;

static config_t config;
static hall_t hall;

void setUp(void)
{
    config = CONFIG_LU2013;
    /* Up to five degrees beside their places, and the first sector not at zero. */
    static const int32_t EDGE_TURN[6] = {64900, 10400, 22500, 32100, 44400, 53700};
    for (int k = 0; k < 6; k++) {
        config.rotor.edge_turn[k] = EDGE_TURN[k];
    }
    hall_init(&hall, &config);
}

void tearDown(void) {}

void test_six_sector_steps_are_a_turn(void)
{
    uint32_t turn = 0;
    for (uint8_t sector = 0; sector < 6; sector++) {
        for (uint8_t k = 0; k < 6; k++) {
            const int32_t expected = k == 1 ? 1 : (k == 5 ? -1 : 0);
            TEST_ASSERT_EQUAL_INT32(expected, sector_step(sector, (uint8_t)((sector + k) % 6)));
        }
        TEST_ASSERT_EQUAL_HEX32(sector_start_q32(&config, sector) +
                                    ((uint32_t)sector_width_turn(&config, sector) << 16),
                                sector_start_q32(&config, (uint8_t)((sector + 1) % 6)));
        turn += sector_width_turn(&config, sector);
    }
    TEST_ASSERT_EQUAL_UINT32(65536, turn);
}

void test_an_angle_is_limited_to_the_sector_and_moved_no_further_than_to_its_border(void)
{
    for (uint8_t sector = 0; sector < 6; sector++) {
        enter_sector(&hall, &config, sector);
        const uint16_t start = (uint16_t)(sector_start_q32(&config, sector) >> 16);
        const uint16_t width = sector_width_turn(&config, sector);
        for (uint32_t at = 0; at < 65536U; at += 13U) {
            hall.theta_q32 = at << 16;
            clamp_to_sector(&hall);
            const uint16_t inside = (uint16_t)((hall.theta_q32 >> 16) - start);
            const uint16_t was = (uint16_t)(at - start);
            TEST_ASSERT_LESS_OR_EQUAL(width, inside);
            if (was < width - 1) {
                TEST_ASSERT_EQUAL_UINT16(was, inside);
            } else { /* the closer border */
                const bool beyond_the_end = was - width < 65536 - was;
                TEST_ASSERT_INT_WITHIN(2, beyond_the_end ? width : 0, inside);
            }
        }
    }
}

void test_the_speed_is_the_turn_of_the_last_six_sectors_over_their_time(void)
{
    random_t random = random_seeded(2013);
    for (int trial = 0; trial < 200; trial++) {
        hall_init(&hall, &config);
        hall.direction = random_chance(&random, 0.5) ? 1 : -1;
        const int32_t longest =
            random_chance(&random, 0.5) ? 25000 : 60; /* a quarter of a second at most, or quick */
        double took[40];
        double width[40];
        uint8_t sector = (uint8_t)random_between(&random, 0, 5);
        for (int n = 0; n < 40; n++) {
            took[n] = random_between(&random, longest / 4, longest);
            width[n] = sector_width_turn(&config, sector);
            time_sector(&hall, &config, sector, (int32_t)took[n]);
            double turn = 0.0;
            double periods = 0.0;
            for (int k = n; k >= 0 && k > n - 6; k--) {
                turn += width[k] / 65536.0;
                periods += took[k];
            }
            /* The reciprocal's 8e-5, a quarter of the periods' rounding when they exceed 16 bits,
             * and one LSB. */
            const double exact = hall.direction * turn / periods * 4294967296.0;
            TEST_ASSERT_DOUBLE_WITHIN(
                fabs(exact) * (8e-5 + (periods > 65535.0 ? 4.0 / 65536.0 : 0.0)) + 2.0, exact,
                measured_speed_q32(&hall));
            sector = (uint8_t)((sector + (hall.direction > 0 ? 1 : 5)) % 6);
        }
    }
}

void test_speed_decays_by_a_64th_per_period_of_an_overdue_edge_and_is_zero_after_250_ms(void)
{
    enter_sector(&hall, &config, 2);
    hall.speed_q32 = 6400000;
    hall.overdue_periods = 100;
    hall.periods_since_edge = 100;
    decay_overdue_speed(&hall);
    TEST_ASSERT_EQUAL_INT32(6400000, hall.speed_q32);
    hall.periods_since_edge = 101;
    decay_overdue_speed(&hall);
    TEST_ASSERT_EQUAL_INT32(6300000, hall.speed_q32);
    hall.periods_since_edge = hall.standstill_periods + 1;
    hall.direction = 1;
    decay_overdue_speed(&hall);
    TEST_ASSERT_EQUAL_INT32(0, hall.speed_q32);
    TEST_ASSERT_EQUAL_INT(0, hall.direction);
    TEST_ASSERT_EQUAL_HEX32(middle_q32(&hall), hall.theta_q32);
}

void test_standstill_clears_the_sector_times(void)
{
    enter_sector(&hall, &config, 4);
    time_sector(&hall, &config, 3, 100);
    hall.speed_q32 = hall.edge_speed_q32 = 1000000;
    hall.direction = -1;
    hall.overdue_periods = 200;
    hall.bounce_periods = 12;
    reset_movement(&hall);
    TEST_ASSERT_EQUAL_INT32(0, hall.speed_q32);
    TEST_ASSERT_EQUAL_INT32(0, hall.edge_speed_q32);
    TEST_ASSERT_EQUAL_INT(0, hall.direction);
    TEST_ASSERT_EQUAL_INT32(0, hall.bounce_periods); /* the next edge may come at any time */
    TEST_ASSERT_EQUAL_INT32(hall.standstill_periods, hall.overdue_periods);
    TEST_ASSERT_EQUAL_UINT8(0, hall.sectors_timed);
    TEST_ASSERT_EQUAL_UINT32(0, hall.timed_turn + hall.timed_periods);
    TEST_ASSERT_EQUAL_HEX32(middle_q32(&hall), hall.theta_q32);
    TEST_ASSERT_EQUAL_UINT32(hall.theta_q32, hall.edge_theta_q32);
}

void test_measured_speed_is_at_most_a_quarter_turn_per_period(void)
{
    hall.timed_turn = 16384; /* the widest sector that a configuration may have */
    hall.timed_periods = 1;
    hall.direction = -1;
    TEST_ASSERT_EQUAL_INT32(-((1 << 30) - 2), measured_speed_q32(&hall));
}

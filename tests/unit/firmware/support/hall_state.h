/* SPDX-License-Identifier: Apache-2.0 */
/*
 * hall_state.h: the hall estimate from one chosen state to the next, field by field.
 *
 * Sectors at uneven places, one of them of an odd width. A turn of angle_turn is 65 536.
 */
#ifndef HALL_STATE_H
#define HALL_STATE_H

#include "hall.h"
#include "unity.h"

extern const config_t CONFIG_LU2013;

enum {
    STANDSTILL_PERIODS = 5000, /* 1/4 s at 20 kHz */
    REVERSAL_PERIODS = 298,    /* 20 000/67 */
    SPEED_q32 = 128 << 16,     /* 128/65 536 turns a period: a turn takes 512 */
    /* Where each sector begins, and how wide sector 2 and 3 are. */
    EDGE_0 = 64900,
    EDGE_1 = 10401,
    EDGE_2 = 22500,
    EDGE_3 = 32100,
    EDGE_4 = 44400,
    EDGE_5 = 53700,
    WIDTH_2 = EDGE_3 - EDGE_2,
    WIDTH_3 = EDGE_4 - EDGE_3
};

static const uint8_t STATE_OF_SECTOR[HALL_SECTORS] = {5, 1, 3, 2, 6, 4};
static const hall_observed_t UNKNOWN = {.known = false};

static config_t config;
static hall_t hall, expected;

static inline uint32_t angle_q32(int32_t turn)
{
    return (uint32_t)turn << 16;
}

/* `at` enters a sector. */
static inline void set_sector(hall_t *at, uint8_t sector, int32_t begin_turn, int32_t width_turn)
{
    at->sector = sector;
    at->begin_q32 = angle_q32(begin_turn);
    /* An even number of LSB, and the last of them whole. */
    at->span_q32 = angle_q32(width_turn / 2 * 2) + 65535U;
    at->periods_since_edge = 0;
}

/* Forward through sector 2 for `periods`, a whole turn timed: 512 periods. */
static inline void forward_in_sector_2(int32_t periods)
{
    const hall_t moving = {
        .theta_q32 = angle_q32(EDGE_2 + 128 * periods),
        .speed_q32 = SPEED_q32,
        .direction = 1,
        .standstill_periods = STANDSTILL_PERIODS,
        .reversal_periods = REVERSAL_PERIODS,
        .overdue_periods = 190,
        .bounce_periods = 11,
        .edge_theta_q32 = angle_q32(EDGE_2),
        .edge_speed_q32 = SPEED_q32,
        .sectors_timed = HALL_SECTORS,
        .timed_turn = 65536,
        .timed_periods = 512,
        .sector_periods = {86, 95, 75, 96, 73, 87},
        .steady_sensors = HALL_NO_READING,
        .started = true,
        .valid = true,
    };
    hall = moving;
    set_sector(&hall, 2, EDGE_2, WIDTH_2);
    hall.periods_since_edge = periods;
    expected = hall;
}

/* The same with one sensor contradicting: dead reckoning. */
static inline void ride_through_sector_2(int32_t periods)
{
    forward_in_sector_2(periods);
    hall.valid = false;
    hall.faults = 1;
    expected = hall;
}

static inline void hall_state_up(void)
{
    static const int32_t EDGES[HALL_SECTORS] = {EDGE_0, EDGE_1, EDGE_2, EDGE_3, EDGE_4, EDGE_5};
    config = CONFIG_LU2013;
    config.drive.pwm_frequency_Hz = 20000;
    config.rotor.sensor = CONFIG_ROTOR_HALL;
    for (int k = 0; k < HALL_SECTORS; k++) {
        config.rotor.edge_turn[k] = EDGES[k];
    }
    forward_in_sector_2(48);
}

/* A period in which the sensors read a state, or report a sector. */
static inline void sensors_read(uint8_t sensors)
{
    hall_process_event(&hall, &config, sensors, UNKNOWN);
}

static inline void event(uint8_t sector)
{
    sensors_read(STATE_OF_SECTOR[sector]);
}

static inline void event_observed(uint8_t sector, hall_observed_t observed)
{
    hall_process_event(&hall, &config, STATE_OF_SECTOR[sector], observed);
}

/* The first state ever. */
static inline void start_in(uint8_t sector)
{
    hall_init(&hall, &config);
    event(sector);
    expected = hall;
}

/* `expected` enters a sector. */
static inline void expect_sector(uint8_t sector, int32_t begin_turn, int32_t width_turn)
{
    set_sector(&expected, sector, begin_turn, width_turn);
}

/* `expected` notes this angle and speed as those of a plausible edge. */
static inline void expect_noted_edge(void)
{
    expected.edge_theta_q32 = expected.theta_q32;
    expected.edge_speed_q32 = expected.speed_q32;
}

/* Every field. */
static inline void assert_expected_state(void)
{
    TEST_ASSERT_EQUAL_UINT8_MESSAGE(expected.sector, hall.sector, "sector");
    TEST_ASSERT_EQUAL_INT8_MESSAGE(expected.direction, hall.direction, "direction");
    TEST_ASSERT_EQUAL_INT32_MESSAGE(expected.speed_q32, hall.speed_q32, "speed");
    TEST_ASSERT_EQUAL_HEX32_MESSAGE(expected.theta_q32, hall.theta_q32, "theta");
    TEST_ASSERT_EQUAL_INT32_MESSAGE(expected.periods_since_edge, hall.periods_since_edge, "since");
    TEST_ASSERT_EQUAL_INT32_MESSAGE(expected.overdue_periods, hall.overdue_periods, "overdue");
    TEST_ASSERT_EQUAL_HEX32_MESSAGE(expected.begin_q32, hall.begin_q32, "begin");
    TEST_ASSERT_EQUAL_HEX32_MESSAGE(expected.span_q32, hall.span_q32, "span");
    TEST_ASSERT_EQUAL_INT32_MESSAGE(expected.bounce_periods, hall.bounce_periods, "bounce");
    TEST_ASSERT_EQUAL_INT32_MESSAGE(expected.standstill_periods, hall.standstill_periods, "rest");
    TEST_ASSERT_EQUAL_INT32_MESSAGE(expected.reversal_periods, hall.reversal_periods, "reversal");
    TEST_ASSERT_EQUAL_INT32_MESSAGE(expected.invalid_periods, hall.invalid_periods, "invalid");
    TEST_ASSERT_EQUAL_UINT16_ARRAY_MESSAGE(expected.sector_periods, hall.sector_periods,
                                           HALL_SECTORS, "sector periods");
    TEST_ASSERT_EQUAL_UINT32_MESSAGE(expected.timed_turn, hall.timed_turn, "timed turn");
    TEST_ASSERT_EQUAL_UINT32_MESSAGE(expected.timed_periods, hall.timed_periods, "timed periods");
    TEST_ASSERT_EQUAL_HEX32_MESSAGE(expected.edge_theta_q32, hall.edge_theta_q32, "edge theta");
    TEST_ASSERT_EQUAL_INT32_MESSAGE(expected.edge_speed_q32, hall.edge_speed_q32, "edge speed");
    TEST_ASSERT_EQUAL_HEX32_MESSAGE(expected.observer_lead_q32, hall.observer_lead_q32, "lead");
    TEST_ASSERT_EQUAL_UINT16_MESSAGE(expected.faults, hall.faults, "faults");
    TEST_ASSERT_EQUAL_UINT8_MESSAGE(expected.steady_sensors, hall.steady_sensors, "steady");
    TEST_ASSERT_EQUAL_UINT8_MESSAGE(expected.sectors_timed, hall.sectors_timed, "timed");
    TEST_ASSERT_EQUAL_UINT8_MESSAGE(expected.plausible_edges, hall.plausible_edges, "plausible");
    TEST_ASSERT_EQUAL_INT_MESSAGE(expected.started, hall.started, "started");
    TEST_ASSERT_EQUAL_INT_MESSAGE(expected.valid, hall.valid, "valid");
}

#endif

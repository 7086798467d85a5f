/* SPDX-License-Identifier: Apache-2.0 */
/*
 * hall_sector.h: what both halves of the hall estimate know of sectors (hall.c: sensors in order;
 * hall_doubt.c: sensors that contradict themselves). Their geometry from the configured edges, the
 * time they took, and the angle inside them.
 */
#ifndef FOC_HALL_SECTOR_H
#define FOC_HALL_SECTOR_H

#include "core/angle.h"
#include "core/q15.h"
#include "core/reciprocal.h"
#include "foc/hall.h"

enum { HALL_SECTORS = CONFIG_HALL_EDGES, HALL_NO_SECTOR = 7 };

static inline uint8_t hall_next_sector(uint8_t sector)
{
    return sector == HALL_SECTORS - 1 ? 0 : (uint8_t)(sector + 1U);
}

static inline uint8_t hall_previous_sector(uint8_t sector)
{
    return sector == 0 ? HALL_SECTORS - 1 : (uint8_t)(sector - 1U);
}

static inline uint16_t hall_sector_start(const config_t *config, uint8_t sector)
{
    return (uint16_t)config->rotor.edge_turn[sector];
}

static inline uint16_t hall_sector_width(const config_t *config, uint8_t sector)
{
    return (uint16_t)(hall_sector_start(config, hall_next_sector(sector)) -
                      hall_sector_start(config, sector));
}

/* The sensors say another sector than before. */
static inline void hall_enter_sector(hall_t *hall, const config_t *config, uint8_t sector)
{
    const uint16_t half = (uint16_t)(hall_sector_width(config, sector) / 2U);
    hall->sector = sector;
    hall->half_width_turn = (int16_t)half;
    hall->middle_turn = (uint16_t)(hall_sector_start(config, sector) + half);
    hall->begin_turn = hall_sector_start(config, sector);
    hall->span_turn = (uint16_t)(2U * half);
    hall->periods_since_edge = 0;
}

/* Nothing is known of the movement: the middle of the sector. */
static inline void hall_settle(hall_t *hall)
{
    hall->speed_q32 = 0;
    hall->sectors_timed = 0;
    hall->timed_turn = 0;
    hall->timed_periods = 0;
    hall->direction = 0;
    hall->theta_q32 = (uint32_t)hall->middle_turn << 16;
    hall->overdue_periods = hall->standstill_periods;
    hall->bounce_periods = 0;
    hall->edge_theta_q32 = hall->theta_q32;
    hall->edge_speed_q32 = 0;
}

/* A sector was crossed from end to end. A full turn of them is kept: the sixth before this one was
 * the same sector. */
static inline void hall_time_sector(hall_t *hall, uint8_t sector, uint16_t width_turn,
                                    uint16_t periods)
{
    if (hall->sectors_timed < HALL_SECTORS) {
        hall->sectors_timed++;
        hall->timed_turn += width_turn;
    } else {
        hall->timed_periods -= hall->sector_periods[sector];
    }
    hall->timed_periods += periods;
    hall->sector_periods[sector] = periods;
}

/* Speed over the sectors timed so far. */
static inline int32_t hall_measured_speed_q32(const hall_t *hall)
{
    const uint32_t turn = hall->timed_turn;
    const uint32_t periods = hall->timed_periods;
    /* turn <= 65 536. Six sectors of up to a quarter of a second may exceed the reciprocal's 16
     * bits: quarter both then. */
    const bool slow = periods > UINT16_MAX;
    const uint32_t divisor = slow ? periods / 4U : periods;
    const uint32_t dividend_q15 = slow ? turn << 13 : turn << 15;
    const uint32_t speed_q31 =
        reciprocal_scale(dividend_q15, (uint16_t)q_min((int32_t)divisor, UINT16_MAX));
    const int32_t speed_q32 = q_min((int32_t)(speed_q31 & INT32_MAX), INT32_MAX / 2) * 2;
    return hall->direction > 0 ? speed_q32 : -speed_q32;
}

/* The angle inside the sector that the sensors report. */
static inline void hall_hold_inside(hall_t *hall)
{
    const int32_t beyond = angle_difference((uint16_t)(hall->theta_q32 >> 16), hall->middle_turn);
    if (beyond > hall->half_width_turn) {
        hall->theta_q32 = (uint32_t)(uint16_t)(hall->middle_turn + hall->half_width_turn - 1) << 16;
    } else if (beyond < -hall->half_width_turn) {
        hall->theta_q32 = (uint32_t)(uint16_t)(hall->middle_turn - hall->half_width_turn) << 16;
    }
}

/* When the next edge is overdue the speed dies away, and in the end the rotor counts as standing.
 */
static inline void hall_wait_for_edge(hall_t *hall)
{
    if (hall->periods_since_edge > hall->overdue_periods) {
        hall->speed_q32 -= hall->speed_q32 / (1 << HALL_DECAY_LOG2);
        if (hall->speed_q32 == 0) {
            hall->theta_q32 = (uint32_t)hall->middle_turn << 16;
        }
        if (hall->periods_since_edge > hall->standstill_periods) {
            hall_settle(hall);
        }
    }
}

#endif

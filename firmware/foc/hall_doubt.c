/* SPDX-License-Identifier: Apache-2.0 */
#include "foc/hall_doubt.h"

#include "foc/hall_sector.h"

/* Whatever was held back since the last edge in order was perhaps no slower rotor but a
 * dead sensor: the angle goes on from there as if that edge had been the last thing heard. */
void hall_begin_doubt(hall_t *hall)
{
    hall->lost_edges++;
    hall->doubt = true;
    hall->edges_in_order = 0;
    hall->speed_q32 = hall->edge_speed_q32;
    hall->direction = (int8_t)(hall->speed_q32 > 0 ? 1 : (hall->speed_q32 < 0 ? -1 : 0));
    hall->theta_q32 =
        hall->edge_theta_q32 + (uint32_t)hall->edge_speed_q32 * (uint32_t)hall->periods_since_edge;
    /* A dead sensor stretches sectors to twice their time. */
    hall->overdue_periods =
        q_min(hall->overdue_periods * HALL_OVERDUE_FACTOR, hall->standstill_periods);
}

/* A neighbouring sector in the direction of the rotation, while in doubt. */
static void follow_edge_in_doubt(hall_t *hall, const config_t *config, uint8_t sector)
{
    const uint8_t left = hall->sector;
    const uint16_t edge_turn = hall_sector_start(config, hall->direction > 0 ? sector : left);
    hall->edges_in_order++;
    if (hall->edges_in_order > 1) {
        hall->sectors_timed =
            0; /* both ends of the sector just left were edges in order: its time alone counts */
        hall->timed_turn = 0;
        hall->timed_periods = 0;
        hall_time_sector(hall, left, hall_sector_width(config, left),
                         (uint16_t)hall->periods_since_edge);
        hall->bounce_periods = hall->periods_since_edge / HALL_BOUNCE_DIVISOR;
        hall->overdue_periods =
            q_min(hall->periods_since_edge * HALL_OVERDUE_FACTOR * HALL_OVERDUE_FACTOR,
                  hall->standstill_periods);
        /* One sector is known to a period of its time only, so it counts for a quarter. */
        hall->speed_q32 =
            q_saturate64((INT64_C(3) * hall->speed_q32 + hall_measured_speed_q32(hall)) / 4);
    }
    const int32_t wrong_turn = angle_difference(edge_turn, (uint16_t)(hall->theta_q32 >> 16));
    if (q_abs(wrong_turn) < HALL_NEAR_EDGE_TURN || hall->edges_in_order > 1) {
        hall->theta_q32 += (uint32_t)(wrong_turn * 32768);
    }
}

bool hall_reckon(hall_t *hall, const config_t *config, uint8_t sector)
{
    hall->theta_q32 += (uint32_t)hall->speed_q32;
    if (sector == HALL_NO_SECTOR) {
        hall->edges_in_order = 0;
    } else if (sector != hall->sector) {
        const int32_t step = sector == hall_next_sector(hall->sector)
                                 ? 1
                                 : (sector == hall_previous_sector(hall->sector) ? -1 : 0);
        if (step != 0 && step != hall->direction &&
            hall->periods_since_edge <= hall->bounce_periods) {
            return false; /* a bounce */
        }
        if (step != 0 && step == hall->direction) {
            follow_edge_in_doubt(hall, config, sector);
        } else {
            hall->edges_in_order = 0;
            if (hall->direction == 0) {
                hall->direction = (int8_t)step;
            }
        }
        hall_enter_sector(hall, config, sector);
    }
    const bool standing = hall->periods_since_edge > hall->standstill_periods;
    /* No edge can come out of an impossible state: that none does says nothing. */
    if (sector != HALL_NO_SECTOR || standing) {
        hall_wait_for_edge(hall);
    }
    return sector != HALL_NO_SECTOR && (standing || hall->edges_in_order >= HALL_TRUSTED_EDGES);
}

void hall_end_doubt(hall_t *hall)
{
    hall->doubt = false;
    hall_hold_inside(hall);
    hall->overdue_periods /= HALL_OVERDUE_FACTOR;
    hall->edge_theta_q32 = hall->theta_q32;
    hall->edge_speed_q32 = hall->speed_q32;
}

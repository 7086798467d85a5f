/* SPDX-License-Identifier: Apache-2.0 */
#include "foc/hall.h"

#include "foc/hall_doubt.h"
#include "foc/hall_sector.h"

/* Sensors 120 degrees apart, forward order 101, 001, 011, 010, 110, 100 (bits C B A). */
static const uint8_t SECTOR_OF_SENSORS[8] = {HALL_NO_SECTOR, 1, 3, 2, 5, 0, 4, HALL_NO_SECTOR};

void hall_init(hall_t *hall, const config_t *config)
{
    const hall_t zero = {0};
    *hall = zero;
    hall->standstill_periods = config->drive.pwm_frequency_Hz / HALL_STANDSTILL_PER_S;
    hall->turn_round_periods = config->drive.pwm_frequency_Hz / HALL_TURN_ROUND_DIVISOR;
    hall->steady_sensors = HALL_NEVER;
}

/* How far an edge moves angle and speed, as a power of two: 8 or 4 of them halve a quick rotor's
 * error, one that of a slow one. An edge is seen up to a period late, which at high speed is
 * degrees, and a turn's time known to a period: taken at their word they would shake the angle and
 * the EMF that is fed forward. At low speed a period is nothing and the last turn long ago. */
static unsigned smoothing_log2(const hall_t *hall, int32_t sector_periods)
{
    if (hall->sectors_timed < HALL_SECTORS || sector_periods >= 2 * HALL_QUICK_PERIODS) {
        return 0;
    }
    return sector_periods < HALL_QUICK_PERIODS ? 3 : 2;
}

/* The first edge after a standstill, or one that comes back. Of the latter nobody knows yet whether
 * the rotor turned round or a sensor died: until a sector's time more has passed the angle stays at
 * the edge, which is wrong by half of what the middle of the sector would be if it was the sensor.
 */
static void turn_round(hall_t *hall, int8_t direction, uint16_t edge_turn)
{
    const bool moved = hall->sectors_timed > 0;
    const int32_t overdue_periods = hall->overdue_periods;
    const int32_t speed_q32 = hall->speed_q32;
    hall_settle(hall);
    hall->direction = direction;
    if (moved) {
        hall->theta_q32 = (uint32_t)edge_turn << 16;
        hall->overdue_periods = overdue_periods;
        hall->edge_theta_q32 =
            hall->theta_q32; /* should it turn out to be a doubt: as if nothing had turned round */
        hall->edge_speed_q32 = speed_q32;
    }
}

static void cross_edge(hall_t *hall, const config_t *config, uint8_t sector, int8_t direction)
{
    const uint8_t left = hall->sector;
    const int32_t took_periods = hall->periods_since_edge;
    const uint16_t edge_turn = hall_sector_start(config, direction > 0 ? sector : left);
    const bool crossed =
        direction == hall->direction; /* the sector just left was crossed from end to end */
    hall->direction = direction;
    hall_enter_sector(hall, config, sector);
    if (!crossed) {
        turn_round(hall, direction, edge_turn);
        return;
    }
    hall_time_sector(hall, left, hall_sector_width(config, left), (uint16_t)took_periods);
    hall->overdue_periods = q_min(took_periods * HALL_OVERDUE_FACTOR, hall->standstill_periods);
    hall->bounce_periods = took_periods / HALL_BOUNCE_DIVISOR;
    const unsigned edges_log2 = smoothing_log2(hall, took_periods);
    const int64_t wrong_q32 = (int64_t)hall_measured_speed_q32(hall) - hall->speed_q32;
    hall->speed_q32 = q_saturate64(hall->speed_q32 + (wrong_q32 >> edges_log2));
    /* The edge lay on average half a period before this sample. */
    const uint32_t now_q32 = ((uint32_t)edge_turn << 16) + (uint32_t)(hall->speed_q32 / 2);
    if (hall->sectors_timed < HALL_SECTORS) {
        hall->theta_q32 = now_q32;
    } else {
        hall->theta_q32 +=
            (uint32_t)hall->speed_q32; /* this period's movement, before the comparison */
        const int32_t wrong_turn =
            angle_difference((uint16_t)(now_q32 >> 16), (uint16_t)(hall->theta_q32 >> 16));
        hall->theta_q32 += (uint32_t)(wrong_turn * (edges_log2 > 0 ? 65536 >> edges_log2 : 32768));
        hall_hold_inside(hall);
    }
    hall->edge_theta_q32 = hall->theta_q32;
    hall->edge_speed_q32 = hall->speed_q32;
}

/* One more period inside the same sector. */
static void extrapolate(hall_t *hall)
{
    hall->theta_q32 += (uint32_t)hall->speed_q32;
    hall_hold_inside(hall);
    hall_wait_for_edge(hall);
}

/* The sensors say a neighbouring sector: an edge, the bounce of the last one, or a reversal that
 * cannot be. */
static void step_to(hall_t *hall, const config_t *config, uint8_t sector, int8_t direction)
{
    const bool back = direction == -hall->direction;
    const bool too_quick = hall->sectors_timed > 0 &&
                           hall->overdue_periods < hall->turn_round_periods &&
                           hall->periods_since_edge <= hall->overdue_periods;
    if (direction != hall->direction && hall->periods_since_edge <= hall->bounce_periods) {
        extrapolate(hall);
    } else if (back && too_quick) {
        hall_begin_doubt(hall);
        hall_enter_sector(hall, config, sector);
    } else {
        cross_edge(hall, config, sector, direction);
    }
}

/* Half a sector beyond its end by dead reckoning, and no edge: no rotor can have slowed down so
 * much since the last one. */
static bool stopped_too_quickly(const hall_t *hall)
{
    const int32_t gone_turn = q_abs(hall->edge_speed_q32 / 65536) * hall->periods_since_edge;
    return hall->sectors_timed > 0 && hall->overdue_periods < hall->turn_round_periods / 2 &&
           gone_turn > hall->span_turn * 3 / 2;
}

static void look_in_order(hall_t *hall, const config_t *config, uint8_t sector)
{
    hall->invalid_periods =
        sector == HALL_NO_SECTOR ? q_min(hall->invalid_periods + 1, UINT16_MAX) : 0;
    if (sector == HALL_NO_SECTOR) {
        hall->theta_q32 += (uint32_t)hall->speed_q32;
        if (hall->invalid_periods >= HALL_INVALID_PERIODS) {
            hall_begin_doubt(hall);
        }
    } else if (sector == hall->sector) {
        if (stopped_too_quickly(hall)) {
            hall_begin_doubt(hall);
        } else {
            extrapolate(hall);
        }
    } else if (sector == hall_next_sector(hall->sector)) {
        step_to(hall, config, sector, 1);
    } else if (sector == hall_previous_sector(hall->sector)) {
        step_to(hall, config, sector, -1);
    } else {
        hall_begin_doubt(hall);
        hall_enter_sector(hall, config, sector);
    }
}

void hall_look(hall_t *hall, const config_t *config, uint8_t sensors)
{
    const uint8_t sector = SECTOR_OF_SENSORS[sensors & 7U];
    hall->periods_since_edge = q_min(hall->periods_since_edge + 1, UINT16_MAX);
    if (!hall->started) {
        if (sector != HALL_NO_SECTOR) {
            hall->started = true;
            hall_enter_sector(hall, config, sector);
            hall_settle(hall);
        }
    } else if (!hall->doubt) {
        look_in_order(hall, config, sector);
    } else if (hall_reckon(hall, config, sector)) {
        hall_end_doubt(hall);
    }
    hall->valid = hall->started && !hall->doubt;
    /* A bounce, an impossible state and a doubt are looked at again in every period. */
    hall->steady_sensors = hall->valid && sector == hall->sector ? sensors : (uint8_t)HALL_NEVER;
}
